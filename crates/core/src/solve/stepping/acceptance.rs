//! Acceptance of an increment in equilibrium, and size of the next one (docs/theory/procedures.md, Algorithm).

use wythe_contact::{InterfaceHistory, JointLaw};

use super::peak_control::{AT_REST, Passage};
use super::run::{CUT, Run};
use super::step_run::{IncrementRequest, StepRun};
use crate::model::scene::Procedure;
use crate::solve::increment::newton::IMBALANCE;
use crate::solve::increment::outcome::{Rejection, Report};
use crate::state::Method;

/// Largest growth of an increment.
pub(in crate::solve) const GROW: f64 = 1.5;
/// Solves above which the increment size does not grow.
const MANY: usize = 10;
/// Part of the elastic energy that a snap releases, at least.
const RELEASE: f64 = 0.2;
/// Least rise of damage in a first increment that may hide a peak [-].
const BREAKS: f64 = 0.005;
/// Least stiffness over that of the longer attempt before, if that one passed a peak [-].
const STIFFER: f64 = 1.05;
/// Largest part of all work done that an increment may leave unaccounted for: half of the bound for a run.
pub(super) const LOST: f64 = 5e-3;
/// Part of a branch of the amplitude by which a path may slide back beyond its start.
const BACK: f64 = 0.02;
/// Largest energy gain in an impact, as a part of the change of the kinetic energy or of the elastic energy, whichever is
/// more. The kinetic energy itself depends on what moves elsewhere.
const GAIN: f64 = 0.01;
/// The same as a part of the kinetic energy: the rounding of its change.
const ROUNDING: f64 = 1e-6;
/// Part of the pressed contact points that must meet or part in an impact.
const IMPACT: f64 = 0.2;
/// Part of the limit of friction from which a point slid at the start of an increment.
const SLID: f64 = 0.99;
/// Change of the friction of such a point, as a part of itself, by which it brakes or slides back.
const BRAKES: f64 = 0.5;

impl Run<'_> {
    /// Whether bodies met or parted in the increment that ends at the trial.
    fn is_shock(&self) -> bool {
        let presses = |history: &InterfaceHistory| history.traction[0] < 0.0;
        let (mut before, mut after, mut changed) = (0, 0, 0);
        for (old, new) in self.state.interface.iter().zip(&self.trial.joints.history) {
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

    /// Whether bodies that slid at the start of the increment that ends at the trial brake or slide back: friction jumps
    /// within it.
    fn brakes(&self) -> bool {
        let jumps = |law: &dyn JointLaw, old: &InterfaceHistory, new: &InterfaceHistory| {
            let [was, is] = [old, new].map(|history| &history.traction);
            let change = (is[1] - was[1]).hypot(is[2] - was[2]);
            change > BRAKES * was[1].hypot(was[2]) && law.utilisation(was, old) >= SLID
        };
        let presses = |history: &InterfaceHistory| history.traction[0] < 0.0;
        let (mut pressed, mut braking) = (0, 0);
        let points = self.state.interface.iter().zip(&self.trial.joints.history);
        for (p, (old, new)) in points.enumerate() {
            if presses(old) && presses(new) {
                let law = self.system.contact.law(self.model, p);
                pressed += 1;
                braking += usize::from(jumps(law, old, new));
            }
        }
        if let Some(general) = &self.model.contact.general {
            for touch in &self.trial.general.touches {
                let (old, new) = (&touch.old, &touch.touch.history);
                if presses(old) && presses(new) {
                    pressed += 1;
                    let [a, b] = touch.touch.facets;
                    braking += usize::from(jumps(&general.law(a, b), old, new));
                }
            }
        }
        braking as f64 > IMPACT * pressed as f64
    }

    /// Numbers of touches of general contact that press at both ends of the increment that ends at the trial, at its
    /// end only, and at its start only.
    fn touches_changed(&self) -> (usize, usize, usize) {
        let presses = |history: &InterfaceHistory| history.traction[0] < 0.0;
        let (mut held, mut new) = (0, 0);
        for one in &self.trial.general.touches {
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

    /// Whether to repeat the increment that ends at the trial, because bodies meet, part or brake in it. It is repeated
    /// with a smaller size or, if it is already small and HHT gained energy in the impact, with backward Euler.
    pub(in crate::solve) fn try_as_shock(
        &self,
        step_run: &mut StepRun,
        request: IncrementRequest,
    ) -> bool {
        let dynamic = request.method == Method::Dynamic;
        let carried =
            request.method == Method::QuasiStatic && step_run.step.procedure.seeks_equilibrium();
        if !(dynamic || carried) {
            return false;
        }
        let floor = step_run.fallback.floor();
        let smallest = floor.max(step_run.step.increments.min / CUT);
        let (_, met, parted) = self.touches_changed();
        if dynamic && request.increment.size > smallest && self.brakes() {
            return step_run.schedule.cut(request.increment, CUT).is_ok();
        }
        if !self.is_shock() {
            // Few of many points meet: this is no impact of the whole, but HHT may still gain energy.
            return met + parted > 0 && self.makes_energy(step_run, dynamic);
        }
        if request.increment.size > smallest {
            return step_run.schedule.cut(request.increment, CUT).is_ok();
        }
        self.makes_energy(step_run, dynamic)
    }

    /// Whether HHT gained energy in the increment that ends at the trial and backward Euler has not been tried yet.
    fn makes_energy(&self, step_run: &mut StepRun, dynamic: bool) -> bool {
        let (system, state, trial) = (&self.system, &self.state, &self.trial);
        let taken = step_run.newton.numerical_dissipation(system, state, trial);
        let motion = step_run.newton.motion();
        let before = state.energies.kinetic;
        let after = motion
            .as_ref()
            .map_or(before, |motion| motion.kinetic_energy(&system.mass));
        let exchanged = (after - before).abs().max(state.energies.elastic);
        let most = GAIN * exchanged + ROUNDING * before;
        let makes_energy = dynamic && taken < -most;
        motion.is_some_and(|motion| makes_energy && motion.take_shock())
    }

    /// Reason to reject the equilibrium at the trial because it is a jump, if it is one.
    pub(in crate::solve) fn jump(
        &self,
        step_run: &StepRun,
        request: IncrementRequest,
    ) -> Option<Rejection> {
        match request.method {
            Method::Static if self.is_snap(step_run) => Some(Rejection::Snap),
            method if method.follows_path() && undoes_drive(step_run) => Some(Rejection::Back),
            Method::Dissipation if self.is_leap(step_run) => Some(Rejection::Leap),
            _ => self.energy_lost(step_run, request).map(Rejection::Energy),
        }
    }

    /// Part of all work done that the increment that ends at the trial leaves unaccounted for or makes, if it is too large and
    /// a smaller increment or another method may do better.
    fn energy_lost(&self, step_run: &StepRun, request: IncrementRequest) -> Option<f64> {
        let jumps = request.method == Method::Static && step_run.step.procedure == Procedure::Auto;
        let size = request.increment.size;
        let possible = CUT * size >= step_run.step.increments.min;
        let shorter = possible && !step_run.fallback.is_small(size);
        let watched = match request.method {
            Method::Static => shorter || (jumps && !step_run.fallback.is_last()),
            Method::Direct => shorter,
            // With inertia every increment, however small, has a solution.
            Method::QuasiStatic => possible,
            // Paths have their own measure, dynamics its scheme, and extrapolated solids report an error of their
            // own.
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
        // Backward Euler only takes energy. What makes some has come to another equilibrium, far away.
        let made = match request.method {
            Method::QuasiStatic if step_run.step.procedure.seeks_equilibrium() => {
                let newton = &step_run.newton;
                -newton.numerical_dissipation(&self.system, state, trial)
            }
            _ => 0.0,
        };
        let lost = taken.open.abs().max(made) / work;
        (lost > LOST).then_some(lost)
    }

    /// Whether to repeat the increment that ends at the trial with a smaller size, because it passed a peak. If it
    /// has jumped, it is rejected for that reason instead.
    pub(in crate::solve) fn repeat_for_peak(
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

    /// Size for the repetition of the increment that ends at the trial, if it passed a peak.
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
        step_run.peak.note_way(&passage);
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
                .hides(&passage, part, &mut step_run.attempts.tried, work)
        });
        size.filter(|size| *size >= step_run.step.increments.min)
    }

    /// Whether a first increment of unknown stiffness, which starts without force, may hide a peak: it damages
    /// something, and it is the first attempt or stiffer than the longer attempt before.
    fn breaks_at_once(&self, step_run: &mut StepRun, [start, end]: [f64; 2], size: f64) -> bool {
        if start.abs() > AT_REST * end.abs() || !self.is_damaged() {
            return false;
        }
        let secant = (end - start).abs() / size;
        let before = step_run.attempts.tried.replace(secant);
        before.is_none_or(|before| secant > STIFFER * before)
    }

    /// Whether the increment that ends at the trial damages a joint or a solid.
    fn is_damaged(&self) -> bool {
        let (state, trial) = (&self.state, &self.trial);
        let mut joints = state.interface.iter().zip(&trial.joints.history);
        let mut solids = state.material.iter().zip(&trial.solids.history);
        joints.any(|(old, new)| new.damage - old.damage > BREAKS)
            || solids.any(|(old, new)| {
                new.tensile_damage - old.tensile_damage > BREAKS
                    || new.compressive_damage - old.compressive_damage > BREAKS
            })
    }

    /// Data of the increment that ends at the trial for the search of a hidden peak; none without drive or steering.
    pub(super) fn passage(
        &self,
        step_run: &StepRun,
        request: IncrementRequest,
        report: Report,
    ) -> Option<Passage> {
        let size = request.increment.size;
        let passage = if step_run.path.control.is_some() {
            let work = step_run
                .newton
                .work_of_loads(&self.system, &self.state, &self.trial.x);
            Passage {
                size,
                force: report.load_factor,
                by_work: 1.0 / work,
                linear: None,
                sense: (step_run.load + report.load_factor).signum(),
            }
        } else if step_run.step.drives() {
            let way = self.driven_way(step_run);
            let rise = self.linear_rise(step_run);
            Passage {
                size,
                force: 1e-3 * self.driving_force(step_run),
                by_work: 1e-3 / way,
                linear: rise.map(|rise| 1e-3 * rise / size),
                sense: way.signum(),
            }
        } else {
            return None;
        };
        passage.by_work.is_finite().then_some(passage)
    }

    /// Whether the increment that ends at the trial jumped over a snap-back whose path can be followed instead: much
    /// of the elastic energy was released (docs/theory/procedures.md, eq. 8).
    fn is_snap(&self, step_run: &StepRun) -> bool {
        step_run.fallback.prefers_paths() && self.releases(step_run)
    }

    /// Whether much of the elastic energy was released in the increment that ends at the trial.
    pub(super) fn releases(&self, step_run: &StepRun) -> bool {
        let (system, trial) = (&self.system, &self.trial);
        let springs = system.spring_forces(trial);
        let stored = system.elastic_energy(trial, &springs);
        let before = self.state.energies.elastic;
        let released = stored < (1.0 - RELEASE) * before;
        // Energy returned to loads and drives is not released by a snap.
        released && stored < (1.0 - RELEASE) * before + self.work_done(step_run, &springs).min(0.0)
    }

    /// Work done on the bodies in the increment that ends at the trial, by the trapezoidal rule [N mm].
    fn work_done(&self, step_run: &StepRun, springs: &[[f64; 3]]) -> f64 {
        let (state, trial) = (&self.state, &self.trial);
        let forces = state.force.iter().zip(&trial.force);
        let ways = step_run.newton.q().iter().zip(&state.q);
        let work =
            |((f0, f1), (q, start)): ((&f64, &f64), (&f64, &f64))| 0.5 * (f0 + f1) * (q - start);
        let mut sum: f64 = forces.zip(ways).map(work).sum();
        sum += trial.ties.sum(|tie| tie.jacked);
        for (s, force) in springs.iter().enumerate() {
            for i in 0..3 {
                let way = trial.spring_ends[s][i] - state.spring_ends[s][i];
                sum += 0.5 * (state.spring_forces[s][i] + force[i]) * way;
            }
        }
        sum
    }

    /// Whether the increment that ends at the trial left the path that it should follow.
    fn is_leap(&self, step_run: &StepRun) -> bool {
        let (q, last) = (step_run.newton.q(), &self.state.q);
        let dq: Vec<f64> = q.iter().zip(last).map(|(q, s)| q - s).collect();
        step_run.path.measure.is_left_by(&dq)
    }
}

/// Whether a path on which `auto` goes has slid back beyond the start of the present branch of the amplitude. A snap-back
/// takes back a part of the drive, never all of it.
fn undoes_drive(step_run: &StepRun) -> bool {
    let branch = step_run.branch.of;
    let range = (branch.to[1] - branch.from[1]).abs();
    let forth = step_run.sense() * (step_run.newton.loading.factor - branch.from[1]);
    step_run.step.procedure == Procedure::Auto && forth < -BACK * range
}

/// Ratio of the next increment size to this one (docs/theory/procedures.md, eq. 12). Below the size `floor`
/// extrapolation errors no longer reduce it.
pub(in crate::solve) fn growth(request: IncrementRequest, report: Report, floor: f64) -> f64 {
    let by_iterations = if report.iterations > 2 * MANY {
        0.7
    } else if report.iterations > MANY {
        1.0
    } else {
        GROW
    };
    // The error of the extrapolation is of first order in the increment size.
    let by_error = (IMBALANCE / report.extrapolation_error.max(f64::MIN_POSITIVE))
        .sqrt()
        .clamp(0.3, GROW);
    // Where a unit snaps, no size is small enough: the error is reported instead of reduced.
    by_iterations.min(by_error.max((floor / request.increment.size).min(1.0)))
}

/// Largest ratio of the next increment size with inertia to this one, in which the kinetic energy grew by the factor
/// `hurry`. Large increments of backward Euler hold up bodies that should fall.
pub(in crate::solve) fn resolving(hurry: f64) -> f64 {
    if hurry > 2.0 {
        0.7
    } else if hurry > 1.2 {
        1.0
    } else {
        GROW
    }
}
