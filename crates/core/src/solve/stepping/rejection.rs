//! Answer to a rejected increment: a smaller one, another method, or the end of the run.

use super::explain;
use super::fallback::Answer;
use super::run::{CUT, Run, RunError};
use super::step_run::{IncrementRequest, StepRun};
use crate::model::scene::Procedure;
use crate::solve::Recorder;
use crate::solve::increment::convergence::{IMBALANCE, LOOSENED, LOOSENED_FOR};
use crate::solve::increment::outcome::Rejection;
use crate::state::{Method, Status};
use wythe_contact::{InterfaceLaw, JointLaw};

/// First increment along a path, as a part of the rejected increment.
const GUESS: f64 = 0.1;

impl Run<'_> {
    /// Checks that the joint laws of users gave finite results in the last iterate.
    ///
    /// # Errors
    /// [`RunError::JointLaw`] for the first contact point with a number that is not finite.
    pub(super) fn check_custom_laws(&self) -> Result<(), RunError> {
        let laws = &self.model.contact.laws;
        if !laws
            .iter()
            .any(|law| matches!(law, InterfaceLaw::Custom(_)))
        {
            return Ok(());
        }
        for (point, history) in self.trial.joints.history.iter().enumerate() {
            let mut numbers = history.traction.iter().chain(&history.slots);
            if numbers.all(|n| n.is_finite()) && history.damage.is_finite() {
                continue;
            }
            let law = self.system.contact.law(self.model, point).name();
            let [slip_1, slip_2] = history.slip;
            let gap = [self.state.interface[point].opening, slip_1, slip_2];
            return Err(RunError::JointLaw { law, point, gap });
        }
        Ok(())
    }

    /// Loosens the tolerance of a single force for some increments of the first method, if the last resort failed for no
    /// other reason; false if it did not, or if it is loosened already.
    fn loosens(&mut self, step_run: &mut StepRun, rejection: &Rejection) -> bool {
        let Rejection::Iterations {
            residual,
            root_mean_square,
            ..
        } = *rejection
        else {
            return false;
        };
        let most = LOOSENED * step_run.step.tolerance.residual;
        let seeks = step_run.step.procedure == Procedure::Auto;
        if !seeks
            || step_run.newton.scales.loosened > 0
            || residual > most
            || root_mean_square > IMBALANCE
        {
            return false;
        }
        step_run.newton.scales.loosened = LOOSENED_FOR;
        step_run.fallback.begin_again();
        self.adopt(step_run);
        step_run.schedule.resume(step_run.fallback.floor());
        true
    }

    /// Chooses the next attempt after a rejection; false if none is left.
    pub(in crate::solve) fn reject(
        &mut self,
        step_run: &mut StepRun,
        request: IncrementRequest,
        rejection: &Rejection,
        recorder: &mut dyn Recorder,
    ) -> bool {
        let on_path = request.method.follows_path();
        let method = step_run.fallback.method();
        if method.follows_path() && step_run.path.measure.leads(method) && !on_path {
            // The rest of the step was tried in one increment; the path continues instead.
            step_run.path.end_rejected = true;
            return true;
        }
        let spent = if on_path {
            *rejection == Rejection::Back || !step_run.path.measure.cut(CUT)
        } else {
            false
        };
        let size = request.increment.size;
        if *rejection == Rejection::Snap {
            step_run.snap.beyond = Some(request.increment.end());
        }
        if step_run.fallback.is_last() && step_run.snap.beyond.take().is_some() {
            // The jump beyond the snap fails too: use the largest increments.
            step_run.schedule.resume(step_run.step.increments.max);
            return true;
        }
        let least = step_run.least();
        let mut answer = step_run.fallback.rejected(rejection, size, least, spent);
        if method.follows_path() && !on_path && step_run.fallback.is_small(size) {
            // Without dissipation so far, no path is known. Learn it from the rejected increment.
            if self.guess(step_run, method, size) {
                return true;
            }
        }
        if answer == Answer::Cut
            && !on_path
            && step_run.schedule.cut(request.increment, CUT).is_err()
        {
            answer = step_run.fallback.rejected(rejection, size, least, true);
        }
        match answer {
            Answer::Cut => {}
            Answer::NextMethod => {
                let rested = !method.has_inertia();
                self.change_method(step_run, request, rejection, recorder);
                let moves = rested && step_run.fallback.method().has_inertia();
                if moves && self.leans(step_run, recorder) {
                    return false;
                }
            }
            Answer::GiveUp if self.loosens(step_run, rejection) => return true,
            Answer::GiveUp if self.leans(step_run, recorder) => return false,
            Answer::GiveUp => self.give_up(step_run, request, rejection),
        }
        answer != Answer::GiveUp
    }

    /// Whether the last equilibrium of a part under growing loads is not one of the whole: this moves aside at a smaller
    /// load than that which breaks the part.
    fn leans(&mut self, step_run: &StepRun, recorder: &mut dyn Recorder) -> bool {
        !step_run.step.prescribes() && !self.is_symmetric(step_run.index, recorder)
    }

    /// Continues with the next method of the step that applies.
    fn change_method(
        &mut self,
        step_run: &mut StepRun,
        request: IncrementRequest,
        rejection: &Rejection,
        recorder: &mut dyn Recorder,
    ) {
        let size = request.increment.size;
        let why = explain::why(self.model, &self.part, step_run.step, rejection);
        let why = format!("{}: {why}", request.method.name());
        loop {
            let load = step_run.sense() * step_run.load;
            step_run.fallback.take_next(rejection, load);
            let next = step_run.fallback.method();
            // Constant loads have no path.
            let stays = step_run.branch.of.slope() == 0.0;
            if !next.follows_path()
                || (!stays && step_run.path.measure.leads(next))
                || (!stays && self.guess(step_run, next, size))
            {
                break;
            }
        }
        self.adopt(step_run);
        let floor = step_run.fallback.floor();
        match step_run.fallback.method() {
            Method::QuasiStatic => {
                self.begin_inertia(step_run, size.min(floor));
                if matches!(rejection, Rejection::Linear { dof: Some(_), .. }) {
                    self.disturb(step_run);
                }
            }
            // The equations are linear, so the trouble that cut the increment does not affect them.
            Method::Implex => step_run.schedule.resume(size.max(floor)),
            // No method follows the path: jump over it, to the equilibrium found beyond or else by the largest
            // increment.
            Method::Static if step_run.fallback.is_last() => {
                let beyond = step_run.snap.beyond.map(|at| at - step_run.schedule.done());
                let jump = beyond.unwrap_or(step_run.step.increments.max);
                step_run.schedule.resume(jump);
            }
            method if method.follows_path() => step_run.path.measure.mend(),
            _ => {}
        }
        self.note(step_run, &why, recorder);
    }

    /// Lets inertia carry the bodies from the present equilibrium, by increments of this size at first.
    pub(in crate::solve) fn begin_inertia(&mut self, step_run: &mut StepRun, size: f64) {
        self.depart(step_run, step_run.load);
        let steers = step_run.step.control.is_some();
        self.carry_momentum(if steers { 0.0 } else { step_run.sense() });
        self.state.last = None;
        step_run.schedule.resume(size);
    }

    /// Ends the run for lack of equilibrium.
    fn give_up(&mut self, step_run: &StepRun, request: IncrementRequest, rejection: &Rejection) {
        self.summary.iterations += step_run.attempts.solves;
        self.tally(&step_run.newton);
        if self.falls_to_the_end(step_run) {
            return;
        }
        self.summary.status = Status::NotConverged;
        let (message, lost) =
            explain::explain(self.model, &self.part, step_run, request, rejection);
        (self.summary.message, self.summary.lost) = (message, Some(lost));
    }

    /// Measures the path by the rejected increment for lack of a better one; false if it did not dissipate.
    pub(in crate::solve) fn guess(
        &mut self,
        step_run: &mut StepRun,
        method: Method,
        size: f64,
    ) -> bool {
        let q = step_run.newton.q();
        let dq: Vec<f64> = q.iter().zip(&self.state.q).map(|(q, s)| q - s).collect();
        let (system, trial) = (&self.system, &self.trial);
        step_run
            .path
            .measure
            .learn(method, system, trial, &dq, (size, 0.0), GUESS)
    }

    /// Counts a rejected or repeated increment.
    pub(in crate::solve) fn cut_back(&mut self, step_run: &mut StepRun) {
        step_run.attempts.cutbacks += 1;
        step_run.repeat = false;
        self.summary.cutbacks += 1;
    }
}
