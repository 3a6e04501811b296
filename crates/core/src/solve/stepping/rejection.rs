//! What follows a refused increment: a shorter one, another method, or the end.

use super::explain;
use super::fallback::Answer;
use super::run::{CUT, Run};
use super::step_run::{Course, Leg};
use crate::results::{Recorder, Status};
use crate::solve::increment::outcome::Refusal;
use crate::solve::method::Method;

/// Of an increment that was refused, the part that is tried first along the path.
const GUESS: f64 = 0.1;

impl Run<'_> {
    /// Chooses what to try after a refusal; false if nothing is left.
    pub(in crate::solve) fn refuse(
        &mut self,
        course: &mut Course,
        leg: Leg,
        refusal: &Refusal,
        recorder: &mut dyn Recorder,
    ) -> bool {
        let on_path = leg.method.follows_path();
        let method = course.ladder.method();
        if method.follows_path() && course.trail.leads(method) && !on_path {
            // The rest of the step in one: the path goes on instead.
            course.end_refused = true;
            return true;
        }
        let spent = if on_path {
            !course.trail.cut(CUT)
        } else {
            false
        };
        let size = leg.increment.size;
        if *refusal == Refusal::Snap {
            course.beyond = Some(leg.increment.end());
        }
        if course.ladder.is_last() && course.beyond.take().is_some() {
            // Not even there: over it in increments as large as may be.
            course.schedule.resume(course.step.increments.max);
            return true;
        }
        let mut answer = course.ladder.refused(refusal, size, spent);
        if method.follows_path() && !on_path && course.ladder.is_small(size) {
            // Nothing has dissipated yet, and nothing is found before something does.
            if self.guess(course, method, size) {
                return true;
            }
        }
        if answer == Answer::Cut && !on_path && course.schedule.cut(leg.increment, CUT).is_err() {
            answer = course.ladder.refused(refusal, size, true);
        }
        match answer {
            Answer::Cut => true,
            Answer::Climb => {
                let why = format!(
                    "{}: {}",
                    leg.method.name(),
                    explain::why(self.model, &self.part, course.step, refusal)
                );
                loop {
                    course.ladder.climb(refusal, course.sense() * course.load);
                    let next = course.ladder.method();
                    // Where loads stay there is no path of theirs.
                    let stays = course.branch.slope() == 0.0;
                    if !next.follows_path()
                        || (!stays && course.trail.leads(next))
                        || (!stays && self.guess(course, next, size))
                    {
                        break;
                    }
                }
                self.adopt(course);
                match course.ladder.method() {
                    Method::QuasiStatic => {
                        self.depart(course.index, course.load);
                        self.carry_momentum(course.sense());
                        self.state.last = None;
                        course.schedule.resume(size.min(course.ladder.floor()));
                    }
                    // Its equations are linear: whatever cut the increment is not their trouble.
                    Method::Implex => course.schedule.resume(size.max(course.ladder.floor())),
                    // Nothing leads through: it is jumped over, as it was found or else from as far as may be.
                    Method::Static if course.ladder.is_last() => {
                        let beyond = course.beyond.map(|at| at - course.schedule.done());
                        let jump = beyond.unwrap_or(course.step.increments.max);
                        course.schedule.resume(jump);
                    }
                    method if method.follows_path() => course.trail.mend(),
                    _ => {}
                }
                self.note(course, &why, recorder);
                true
            }
            Answer::GiveUp => {
                self.summary.iterations += course.solves;
                self.tally(&course.newton);
                self.summary.status = Status::NotConverged;
                let done = match course.step.amplitude {
                    None => course.load,
                    Some(_) => course.schedule.done(),
                };
                let told =
                    explain::explain(self.model, &self.part, course.index, leg, done, refusal);
                (self.summary.message, self.summary.lost) = (told.0, Some(told.1));
                false
            }
        }
    }

    /// Measures the path by the increment that was refused, for want of a better one; false if nothing
    /// dissipated in it.
    pub(in crate::solve) fn guess(
        &mut self,
        course: &mut Course,
        method: Method,
        size: f64,
    ) -> bool {
        let q = course.newton.q();
        let dq: Vec<f64> = q.iter().zip(&self.state.q).map(|(q, s)| q - s).collect();
        let (system, trial) = (&self.system, &self.trial);
        course
            .trail
            .learn(method, system, trial, &dq, (size, 0.0), GUESS)
    }

    /// Counts a refused or repeated increment.
    pub(in crate::solve) fn cut_back(&mut self, course: &mut Course) {
        course.cutbacks += 1;
        course.repeat = false;
        self.summary.cutbacks += 1;
    }
}
