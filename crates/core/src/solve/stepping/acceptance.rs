//! What an increment in equilibrium tells: whether to keep it, and how large the next may be.

use wythe_contact::InterfaceHistory;

use super::history_row::drives;
use super::peak_control::{AT_REST, Passage};
use super::run::{CUT, Run};
use super::step_run::{IncrementRequest, StepRun};
use crate::model::scene::Procedure;
use crate::solve::increment::newton::IMBALANCE;
use crate::solve::increment::outcome::{Refusal, Report};
use crate::state::Method;

/// Largest growth of an increment.
pub(in crate::solve) const GROW: f64 = 1.5;
/// Solves above which an increment does not grow.
const MANY: usize = 10;
/// Part of the elastic energy that a snap sets free.
const RELEASE: f64 = 0.2;
/// Least damage of a first increment that may hide a peak [-].
const BREAKS: f64 = 0.005;
/// Stiffness over that of the try before, if that has passed a peak [-].
const STIFFER: f64 = 1.05;
/// Part of all work done that an increment may leave unaccounted for: half of that which a run may.
const LOST: f64 = 5e-3;
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
        let (held, new, parted) = self.touches_changed();
        before += held + parted;
        after += held + new;
        changed += new + parted;
        changed as f64 > IMPACT * before.max(after) as f64
    }

    /// Touches of general contact that press at both ends of the increment that the trial ends, at its end
    /// only, at its start only.
    fn touches_changed(&self) -> (usize, usize, usize) {
        let presses = |history: &InterfaceHistory| history.traction[0] < 0.0;
        let (mut held, mut new) = (0, 0);
        for one in &self.trial.touches {
            if presses(&one.touch.history) {
                let old = presses(&one.old);
                held += usize::from(old);
                new += usize::from(!old);
            }
        }
        let touches = self.state.touches.iter();
        let before = touches.filter(|touch| presses(&touch.history)).count();
        (held, new, before - held.min(before))
    }

    /// Whether to try the increment that the trial ends again, smaller, because bodies meet or part in
    /// it; or, where it is small, by backward Euler, if HHT has made energy of the blow.
    pub(in crate::solve) fn try_as_shock(
        &self,
        step_run: &mut StepRun,
        request: IncrementRequest,
    ) -> bool {
        let dynamic = request.method == Method::Dynamic;
        let carried =
            request.method == Method::QuasiStatic && step_run.step.procedure == Procedure::Auto;
        if !(dynamic || carried) {
            return false;
        }
        let (_, met, parted) = self.touches_changed();
        if !self.is_shock() {
            // A few of many that meet are no blow to all, but HHT makes energy of them, too.
            return met + parted > 0 && self.makes_energy(step_run, dynamic);
        }
        let smallest = step_run
            .fallback
            .floor()
            .max(step_run.step.increments.min / CUT);
        if request.increment.size > smallest {
            return step_run.schedule.cut(request.increment, CUT).is_ok();
        }
        self.makes_energy(step_run, dynamic)
    }

    /// Whether HHT has made energy of the increment that the trial ends, and backward Euler is yet to be
    /// tried.
    fn makes_energy(&self, step_run: &mut StepRun, dynamic: bool) -> bool {
        let (system, state, trial) = (&self.system, &self.state, &self.trial);
        let taken = step_run.newton.numerical_dissipation(system, state, trial);
        let makes_energy = dynamic && taken < -GAIN * state.energies.kinetic;
        let motion = step_run.newton.motion();
        motion.is_some_and(|motion| makes_energy && motion.take_shock())
    }

    /// What is wrong with an equilibrium far from the last one that the trial ends in, if it is.
    pub(in crate::solve) fn jump(
        &self,
        step_run: &StepRun,
        request: IncrementRequest,
    ) -> Option<Refusal> {
        match request.method {
            Method::Static if self.is_snap(step_run) => Some(Refusal::Snap),
            Method::Dissipation if self.is_leap(step_run) => Some(Refusal::Leap),
            _ => self.energy_lost(step_run, request).map(Refusal::Energy),
        }
    }

    /// Part of all work done that the increment that the trial ends does not account for, if that is much and a shorter
    /// increment or another method may do better.
    fn energy_lost(&self, step_run: &StepRun, request: IncrementRequest) -> Option<f64> {
        let jumps = request.method == Method::Static && step_run.step.procedure == Procedure::Auto;
        let size = request.increment.size;
        let possible = CUT * size >= step_run.step.increments.min;
        let shorter = possible && !step_run.fallback.is_small(size);
        let watched = match request.method {
            Method::Static => shorter || (jumps && !step_run.fallback.is_last()),
            Method::Direct => shorter,
            // Inertia has an answer to every increment, however short.
            Method::QuasiStatic => possible,
            // Paths have a measure of their own, blows a scheme, and extrapolated solids an error that is reported.
            _ => false,
        };
        if !watched {
            return None;
        }
        let (state, trial) = (&self.state, &self.trial);
        let taken = step_run.newton.taken(&self.system, state, trial);
        let work = self
            .energy_watch
            .work()
            .max(state.energies.taken() + taken.net);
        let lost = taken.leak.abs() / work;
        (lost > LOST).then_some(lost)
    }

    /// Whether to try the increment that the trial ends again, shorter, because it has passed over a peak unseen. One that
    /// has jumped is refused for that.
    pub(in crate::solve) fn go_back_to_peak(
        &self,
        step_run: &mut StepRun,
        request: IncrementRequest,
        report: Report,
    ) -> bool {
        let size = self.passed_peak(step_run, request, report);
        match size.filter(|_| self.jump(step_run, request).is_none()) {
            Some(size) => {
                step_run.schedule.resume(size);
                true
            }
            None => false,
        }
    }

    /// Size of another try of the increment that the trial ends, if that has passed over a peak unseen.
    fn passed_peak(
        &self,
        step_run: &mut StepRun,
        request: IncrementRequest,
        report: Report,
    ) -> Option<f64> {
        let part = step_run.step.increments.peak;
        if request.method.follows_path() || request.method.has_inertia() || part >= 1.0 {
            return None;
        }
        let passage = self.passage(step_run, request, report)?;
        if let (Some(start), None) = (step_run.peak.begins_at(), passage.linear) {
            let again = self.breaks_at_once(step_run, [start, passage.force], passage.size);
            let size = CUT * passage.size;
            return (again && size >= step_run.step.increments.min).then_some(size);
        }
        let end = request.increment.end();
        let size = step_run.peak.passed(end, passage.force, part).or_else(|| {
            let dt = request.increment.size * step_run.step.duration;
            let (system, trial) = (&self.system, &self.trial);
            let work = || system.work_between(self.model, &self.state, trial, dt);
            step_run
                .peak
                .hides(&passage, part, &mut step_run.tried, work)
        });
        size.filter(|size| *size >= step_run.step.increments.min)
    }

    /// Whether a first increment of unknown stiffness, from no force to one, may hide a peak: something is damaged
    /// in it, and a shorter try was stiffer than the one before, or there was none.
    fn breaks_at_once(&self, step_run: &mut StepRun, [start, end]: [f64; 2], size: f64) -> bool {
        if start.abs() > AT_REST * end.abs() || !self.is_damaged() {
            return false;
        }
        let secant = (end - start).abs() / size;
        let before = step_run.tried.replace(secant);
        before.is_none_or(|before| secant > STIFFER * before)
    }

    /// Whether the increment that the trial ends damages a joint or a solid.
    fn is_damaged(&self) -> bool {
        let (state, trial) = (&self.state, &self.trial);
        let mut joints = state.interface.iter().zip(&trial.interface);
        let mut solids = state.material.iter().zip(&trial.material);
        joints.any(|(old, new)| new.damage - old.damage > BREAKS)
            || solids.any(|(old, new)| {
                new.tensile_damage - old.tensile_damage > BREAKS
                    || new.compressive_damage - old.compressive_damage > BREAKS
            })
    }

    /// The increment that the trial ends, as a peak is looked for within it; none where nothing is driven or steered.
    fn passage(
        &self,
        step_run: &StepRun,
        request: IncrementRequest,
        report: Report,
    ) -> Option<Passage> {
        let size = request.increment.size;
        let passage = if step_run.control.is_some() {
            let work = step_run
                .newton
                .work_of_loads(&self.system, &self.state, &self.trial.x);
            Passage {
                size,
                force: report.load_factor,
                by_work: 1.0 / work,
                linear: None,
            }
        } else if drives(step_run.step) {
            let way = self.driven_way(step_run);
            let rise = self.linear_rise(step_run);
            Passage {
                size,
                force: 1e-3 * self.driving_force(step_run),
                by_work: 1e-3 / way,
                linear: rise.map(|rise| 1e-3 * rise / size),
            }
        } else {
            return None;
        };
        passage.by_work.is_finite().then_some(passage)
    }

    /// Whether the increment that the trial ends has found an equilibrium far away, beyond a snap-back,
    /// and the path there can be followed instead: much of the elastic energy is gone.
    fn is_snap(&self, step_run: &StepRun) -> bool {
        if !step_run.fallback.prefers_paths() {
            return false;
        }
        let (system, trial) = (&self.system, &self.trial);
        let springs = system.spring_forces(trial);
        let stored = system.elastic_energy(trial, &springs);
        let before = self.state.energies.elastic;
        let released = stored < (1.0 - RELEASE) * before;
        // What goes back to what loads and drives is set free by nothing.
        released && stored < (1.0 - RELEASE) * before + self.work_done(step_run, &springs).min(0.0)
    }

    /// Work done on the bodies in the increment that the trial ends, by the trapezoidal rule [N mm].
    fn work_done(&self, step_run: &StepRun, springs: &[[f64; 3]]) -> f64 {
        let (state, trial) = (&self.state, &self.trial);
        let forces = state.force.iter().zip(&trial.force);
        let ways = step_run.newton.q().iter().zip(&state.q);
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
    fn is_leap(&self, step_run: &StepRun) -> bool {
        let (q, last) = (step_run.newton.q(), &self.state.q);
        let dq: Vec<f64> = q.iter().zip(last).map(|(q, s)| q - s).collect();
        step_run.path_measure.is_left_by(&dq)
    }
}

/// How much larger the next increment may be; extrapolated solids are not pursued below `floor`.
pub(in crate::solve) fn growth(request: IncrementRequest, report: Report, floor: f64) -> f64 {
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
    by_iterations.min(by_error.max((floor / request.increment.size).min(1.0)))
}

/// How much larger an increment with inertia may be than the last one, in which the kinetic energy
/// grew by `hurry`: backward Euler in large increments holds upright what should fall.
pub(in crate::solve) fn resolving(hurry: f64) -> f64 {
    if hurry > 2.0 {
        0.7
    } else if hurry > 1.2 {
        1.0
    } else {
        GROW
    }
}
