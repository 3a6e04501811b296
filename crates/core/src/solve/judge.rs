//! What an increment in equilibrium tells: whether to keep it, and how large the next may be.

use wythe_contact::InterfaceHistory;

use super::course::{Course, Leg};
use super::drive::{CUT, Run};
use super::method::Method;
use super::newton::IMBALANCE;
use super::outcome::{Refusal, Report};
use crate::model::scene::Procedure;

/// Largest growth of an increment.
const GROW: f64 = 1.5;
/// Solves above which an increment does not grow.
const MANY: usize = 10;
/// Part of the elastic energy that a snap sets free.
const RELEASE: f64 = 0.2;
/// Part of the kinetic energy that a blow may give.
const GAIN: f64 = 0.01;
/// Part of the pressed contact points that begin or cease to press in an impact.
const IMPACT: f64 = 0.2;

impl Run<'_> {
    /// Whether bodies met or parted in the increment that the trial ends.
    fn is_shock(&self) -> bool {
        let presses = |history: &InterfaceHistory| history.traction[0] < 0.0;
        let (mut before, mut after, mut changed) = (0, 0, 0);
        for (old, new) in self.state.interface.iter().zip(&self.trial.interface) {
            let (old, new) = (presses(old), presses(new));
            before += usize::from(old);
            after += usize::from(new);
            changed += usize::from(old != new);
        }
        changed as f64 > IMPACT * before.max(after) as f64
    }

    /// Whether to try the increment that the trial ends again, smaller, because bodies meet or part in
    /// it; or, where it is small, by backward Euler, if HHT has made energy of the blow.
    pub(super) fn try_as_shock(&self, course: &mut Course, leg: Leg) -> bool {
        let dynamic = leg.method == Method::Dynamic;
        let carried = leg.method == Method::QuasiStatic && course.step.procedure == Procedure::Auto;
        if !(dynamic || carried) || !self.is_shock() {
            return false;
        }
        let smallest = course.ladder.floor().max(course.step.increments.min / CUT);
        if leg.increment.size > smallest {
            return course.schedule.cut(leg.increment, CUT).is_ok();
        }
        let (system, state, trial) = (&self.system, &self.state, &self.trial);
        let taken = course.newton.numerical_dissipation(system, state, trial);
        let makes_energy = dynamic && taken < -GAIN * state.energies.kinetic;
        let motion = course.newton.motion();
        motion.is_some_and(|motion| makes_energy && motion.take_shock())
    }

    /// What is wrong with an equilibrium far from the last one that the trial ends in, if it is.
    pub(super) fn jump(&self, course: &Course, leg: Leg) -> Option<Refusal> {
        match leg.method {
            Method::Static if self.is_snap(course) => Some(Refusal::Snap),
            Method::Dissipation if self.is_leap(course) => Some(Refusal::Leap),
            _ => None,
        }
    }

    /// Whether the increment that the trial ends has found an equilibrium far away, beyond a snap-back,
    /// and the path there can be followed instead: much of the elastic energy is gone.
    fn is_snap(&self, course: &Course) -> bool {
        if !course.ladder.prefers_paths() {
            return false;
        }
        let (system, trial) = (&self.system, &self.trial);
        let springs = system.spring_forces(trial);
        let stored = system.elastic_energy(trial, &springs);
        let before = self.state.energies.elastic;
        let released = stored < (1.0 - RELEASE) * before;
        // What goes back to what loads and drives is set free by nothing.
        released && stored < (1.0 - RELEASE) * before + self.work_done(course, &springs).min(0.0)
    }

    /// Work done on the bodies in the increment that the trial ends, by the trapezoidal rule [N mm].
    fn work_done(&self, course: &Course, springs: &[[f64; 3]]) -> f64 {
        let (state, trial) = (&self.state, &self.trial);
        let forces = state.force.iter().zip(&trial.force);
        let ways = course.newton.q().iter().zip(&state.q);
        let work =
            |((f0, f1), (q, start)): ((&f64, &f64), (&f64, &f64))| 0.5 * (f0 + f1) * (q - start);
        let mut sum: f64 = forces.zip(ways).map(work).sum();
        for (s, force) in springs.iter().enumerate() {
            for i in 0..3 {
                let way = trial.spring_ends[s][i] - state.spring_ends[s][i];
                sum += 0.5 * (state.spring_forces[s][i] + force[i]) * way;
            }
        }
        sum
    }

    /// Whether the increment that the trial ends has left the path that it should follow.
    fn is_leap(&self, course: &Course) -> bool {
        let (q, last) = (course.newton.q(), &self.state.q);
        let dq: Vec<f64> = q.iter().zip(last).map(|(q, s)| q - s).collect();
        course.trail.is_left_by(&dq)
    }
}

/// How much larger the next increment may be; extrapolated solids are not pursued below `floor`.
pub(super) fn growth(leg: Leg, report: Report, floor: f64) -> f64 {
    let by_iterations = if report.iterations > 2 * MANY {
        0.7
    } else if report.iterations > MANY {
        1.0
    } else {
        GROW
    };
    // The extrapolation leaves an imbalance of first order in the increment.
    let by_error = (IMBALANCE / report.extrapolation_error.max(f64::MIN_POSITIVE))
        .sqrt()
        .clamp(0.3, GROW);
    // Where a unit snaps no increment is small enough: there the error is reported, not pursued.
    by_iterations.min(by_error.max((floor / leg.increment.size).min(1.0)))
}

/// How much larger an increment with inertia may be than the last one, in which the kinetic energy
/// grew by `hurry`: backward Euler in large increments holds upright what should fall.
pub(super) fn resolving(hurry: f64) -> f64 {
    if hurry > 2.0 {
        0.7
    } else if hurry > 1.2 {
        1.0
    } else {
        GROW
    }
}
