//! The interface through which a run delivers its increments.

use super::Checkpoint;
use crate::model::Model;
use crate::state::{Frame, HistoryRow, State};

/// Receives each converged increment on the thread that solves, as soon as it is committed.
pub trait Recorder: Send {
    /// Receives a committed increment. `frame` is given at output increments. Return `Ok(false)` to stop the run here
    /// ([`crate::state::Status::Interrupted`]).
    ///
    /// # Errors
    /// Input/output failures, which end the run.
    fn take(
        &mut self,
        model: &Model,
        row: &HistoryRow,
        frame: Option<&Frame>,
    ) -> std::io::Result<bool>;

    /// Whether the fields of the increment that [`Recorder::take`] has just received without a frame are wanted by
    /// [`Recorder::keep`]. The default is no.
    fn wants_fields(&self) -> bool {
        false
    }

    /// Receives the fields of the last increment, which has no frame, if [`Recorder::wants_fields`]. The default does
    /// nothing.
    fn keep(&mut self, _model: &Model, _fields: Frame) {}

    /// Receives the full state of a committed increment, before [`Recorder::take`]: histories of all points, contact
    /// pairs and energies. If only a half of the scene is solved, the state is that of the half. The default does
    /// nothing.
    fn observe(&mut self, _state: &State) {}

    /// Called after [`Recorder::take`], when the next increment can start. `make` creates a checkpoint from which
    /// [`crate::solve::resume`] continues. `last` is true if no increment follows, because the steps are done or the
    /// recorder asked to stop. The default does nothing.
    ///
    /// # Errors
    /// Input/output failures, which end the run.
    fn checkpoint(&mut self, _last: bool, _make: &dyn Fn() -> Checkpoint) -> std::io::Result<()> {
        Ok(())
    }

    /// Called where the procedure changes, with the reason. The default does nothing.
    fn note(&mut self, _text: &str) {}

    /// Called after each linear solve of an increment that begins at `time` [s]. `iterations` counts its solves,
    /// those of rejected attempts included. The terminal shows it. The default does nothing.
    fn progress(&mut self, _step: usize, _time: f64, _iterations: usize) {}
}
