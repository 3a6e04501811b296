//! Snaps of a step: whether a rejected increment is relaxed.

use serde::{Deserialize, Serialize};

use super::acceptance::GROW;
use super::run::{Run, RunError};
use super::step_run::{IncrementRequest, StepRun};
use crate::model::scene::Procedure;
use crate::solve::Recorder;
use crate::solve::increment::outcome::{Rejection, Report};
use crate::state::Method;

/// Size over that of a failed relaxation, below which another one is tried.
const RELAX_AGAIN: f64 = 0.2;

/// Largest n of the 2ⁿ troubles in which no relaxation is tried after n + 1 that failed.
const MOST_LOST: u32 = 5;

/// Whether a body has come loose: the matrix is singular or not positive definite there.
fn is_loose(rejection: &Rejection) -> bool {
    matches!(rejection, Rejection::Linear { dof: Some(_), .. })
}

/// Relaxations of a step. One that fails takes some hundred solves, so those that fail in a row are tried ever less
/// often, as paths are (docs/theory/procedures.md, Algorithm).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(in crate::solve) struct Relaxations {
    /// Number of increments in a row that were relaxed.
    in_a_row: usize,
    /// Number of relaxations that failed since the last one that did not.
    lost: u32,
    /// Number of troubles in which no relaxation is tried.
    passed_over: usize,
}

impl Relaxations {
    /// Ends an increment that `method` solved.
    pub(in crate::solve) fn end_increment(&mut self, method: Method) {
        self.in_a_row = match method {
            Method::Relaxation => self.in_a_row + 1,
            _ => 0,
        };
    }

    /// Whether this trouble is passed over.
    fn passes_over(&mut self) -> bool {
        let passes = self.passed_over > 0;
        self.passed_over = self.passed_over.saturating_sub(1);
        passes
    }

    /// Counts a relaxation that found an equilibrium, or that failed.
    fn learn(&mut self, found: bool) {
        if found {
            (self.lost, self.passed_over) = (0, 0);
        } else {
            self.passed_over = 1 << self.lost;
            self.lost = (self.lost + 1).min(MOST_LOST);
        }
    }
}

impl<'m> Run<'m> {
    /// Relaxes the structure over a snap, or chooses the next attempt after a rejection; false if the run ends.
    pub(super) fn relax_or_reject(
        &mut self,
        step_run: &mut StepRun<'m>,
        request: IncrementRequest,
        rejection: &Rejection,
        recorder: &mut dyn Recorder,
    ) -> Result<bool, RunError> {
        step_run.attempts.rejections += 1;
        self.check_custom_laws()?;
        let size = request.increment.size;
        let unsolved = !matches!(rejection, Rejection::Snap | Rejection::Linear { .. });
        if unsolved && step_run.fallback.may_snap() && step_run.step.procedure == Procedure::Auto {
            self.bound_damage(step_run);
        }
        if self.may_relax(step_run, request, rejection) {
            if step_run.snap.relaxations.passes_over() {
                step_run.snap.relaxes_below = 0.0;
            } else {
                let relaxed = self.relax(step_run, request, is_loose(rejection), recorder);
                step_run.snap.relaxations.learn(relaxed.is_some());
                match relaxed {
                    Some(found) => return self.accept_relaxed(step_run, request, found, recorder),
                    None => step_run.snap.relaxes_below = RELAX_AGAIN * size,
                }
            }
        }
        Ok(self.reject(step_run, request, rejection, recorder))
    }

    /// Whether the increment that ends at the trial jumps over a snap whose path could not be followed, so that a
    /// relaxation should cross it instead. The straight line of the jump would count all the energy that it releases as
    /// dissipation of the joints. Counts a relaxation that is passed over.
    pub(super) fn jumps_over(&self, step_run: &mut StepRun<'m>, request: IncrementRequest) -> bool {
        request.method == Method::Static
            && step_run.step.procedure == Procedure::Auto
            && step_run.fallback.is_last()
            && self.releases(step_run)
            && !step_run.snap.relaxations.passes_over()
    }

    /// Relaxes the structure over a snap; if that fails, the increment is tried once more.
    pub(super) fn cross_snap(
        &mut self,
        step_run: &mut StepRun<'m>,
        request: IncrementRequest,
        recorder: &mut dyn Recorder,
    ) -> Result<bool, RunError> {
        let relaxed = self.relax(step_run, request, false, recorder);
        step_run.snap.relaxations.learn(relaxed.is_some());
        match relaxed {
            Some(found) => self.accept_relaxed(step_run, request, found, recorder),
            None => Ok(true),
        }
    }

    /// Whether a relaxation may help where an increment was rejected.
    fn may_relax(
        &self,
        step_run: &StepRun<'m>,
        request: IncrementRequest,
        rejection: &Rejection,
    ) -> bool {
        let (loose, size) = (is_loose(rejection), request.increment.size);
        // The first increment of a step is cut until the structure is elastic in it, and others until they hide no peak.
        let may_hide = step_run.is_fresh() || step_run.step.prescribes();
        let is_resolved = !may_hide || size <= step_run.least().before_motion;
        let applies = match step_run.step.procedure {
            // A unit that comes loose in a wall finds its next support within the joint. Dry stones that nothing
            // presses yet are all loose, and bodies in general contact fly.
            Procedure::Auto if loose => {
                let in_a_wall = self.state.increments > 0 && self.model.contact.general.is_none();
                in_a_wall && is_resolved && step_run.fallback.would_move(size)
            }
            Procedure::Auto => is_resolved && step_run.fallback.may_snap(),
            Procedure::DisplacementControl => !loose,
            _ => false,
        };
        let stuck = match rejection {
            // The path of a clear snap-back is followed where that is possible.
            Rejection::Snap => !step_run.fallback.prefers_paths(),
            Rejection::Linear { .. } => loose,
            _ => step_run.attempts.rejections > 1 || step_run.fallback.is_small(size),
        };
        // Relaxations in a row advance too slowly: with them, walls 13, 27 and 35 of the zoo took up to three times
        // as many solves.
        let first = step_run.snap.relaxations.in_a_row == 0;
        applies && stuck && first && size < step_run.snap.relaxes_below
    }

    /// Commits the end of a relaxation that started at `request`.
    pub(super) fn accept_relaxed(
        &mut self,
        step_run: &mut StepRun<'m>,
        request: IncrementRequest,
        (last, report): (IncrementRequest, Report),
        recorder: &mut dyn Recorder,
    ) -> Result<bool, RunError> {
        step_run.snap.resumes_at = Some(GROW * request.increment.size);
        let go_on = self.accept(step_run, last, report, recorder)?;
        step_run.newton.dashpots = None;
        Ok(go_on)
    }
}
