//! What receives the increments of a run.

use super::Checkpoint;
use crate::model::Model;
use crate::state::{Frame, HistoryRow, State};

/// Receives each converged increment as it comes, on the thread that solves.
pub trait Recorder: Send {
    /// Called once an increment is committed. `frame` is given at output increments. Returning
    /// `Ok(false)` asks the run to stop there ([`crate::state::Status::Interrupted`]).
    ///
    /// # Errors
    /// Input/output failures, which end the run.
    fn take(
        &mut self,
        model: &Model,
        row: &HistoryRow,
        frame: Option<&Frame>,
    ) -> std::io::Result<bool>;

    /// Called once an increment is committed, before [`Recorder::take`], with all that the run knows:
    /// histories of every point, pairs of contact, energies; of a scene of which one half is solved, those of the half.
    /// Default: nothing.
    fn observe(&mut self, _state: &State) {}

    /// Called after [`Recorder::take`], once everything is ready for the next increment: `make` gives
    /// what [`crate::solve::resume`] goes on from. `last` if no increment follows: the steps are done,
    /// or the recorder asked to stop. Default: nothing.
    ///
    /// # Errors
    /// Input/output failures, which end the run.
    fn checkpoint(&mut self, _last: bool, _make: &dyn Fn() -> Checkpoint) -> std::io::Result<()> {
        Ok(())
    }

    /// Called where the procedure changes, with the reason. Default: nothing.
    fn note(&mut self, _text: &str) {}

    /// Called after each linear solve of an increment that begins at `time` [s], with their number,
    /// those of refused attempts among them. For the terminal; default: nothing.
    fn progress(&mut self, _step: usize, _time: f64, _iterations: usize) {}
}
