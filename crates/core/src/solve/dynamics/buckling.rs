//! Disturbance of an equilibrium that is not stable (docs/theory/inertia.md, eq. 14).
//!
//! A column that is exactly straight under a load exactly along it stays so beyond its critical load: nothing moves it to
//! a side. Where the stiffness is not positive definite although the forces balance, and the bodies do not move in the
//! lowest mode by themselves, they get a small velocity in it. What is stable comes to rest again; a column buckles.

use crate::model::scene::Procedure;
use crate::solve::Recorder;
use crate::solve::stability::{gives_way, unstable_mode};
use crate::solve::stepping::run::Run;
use crate::solve::stepping::step_run::StepRun;
use crate::state::{Method, QUIET, Status};

/// Energy of the disturbance over [`QUIET`] times the energy taken.
const NUDGE: f64 = 0.5;
/// Part of this energy from which the bodies move in the mode by themselves.
const MOVES_ALREADY: f64 = 1e-3;
/// Largest increment of direct tangents under growing loads, over `increments.peak` of the load: the loss of stability is
/// found to this part.
const LONGEST_DIRECT: f64 = 4.0;

impl Run<'_> {
    /// Gives the bodies a small velocity in the lowest mode if its stiffness is negative and they have none in it.
    pub(in crate::solve) fn disturb(&mut self, step_run: &mut StepRun) {
        if step_run.step.control.is_some() {
            // Under the load alone any descent is unstable.
            return;
        }
        let of = (self.model, step_run.step);
        let Some(mode) = unstable_mode(of, &mut self.system, &self.state, &mut self.trial) else {
            return;
        };
        step_run.branch.unstable_from.get_or_insert(step_run.load);
        let (state, mass) = (&mut self.state, &self.system.mass);
        let with = |part: f64| -> Vec<f64> {
            let both = state.velocity.iter().zip(&mode);
            both.map(|(v, shape)| v + part * shape).collect()
        };
        let of_mode = mass.kinetic_energy(&mode);
        let before = mass.kinetic_energy(&state.velocity);
        // Modes are orthogonal in M.
        let coupling = mass.kinetic_energy(&with(1.0)) - before - of_mode;
        let present = coupling * coupling / (4.0 * of_mode);
        let nudge = NUDGE * QUIET * state.energies.taken();
        if present > MOVES_ALREADY * nudge {
            return;
        }
        let velocity = with((nudge / of_mode).sqrt());
        let kinetic = mass.kinetic_energy(&velocity);
        state.energies.numerical -= kinetic - state.energies.kinetic;
        state.energies.kinetic = kinetic;
        state.velocity = velocity;
    }

    /// Disturbs the bodies that inertia carried to the present loads from those at `start`, if what they stand in is not
    /// stable. This is checked each time the loads have changed by `increments.peak`. Direct tangents are not symmetric,
    /// so that their factors do not tell either; where what they found is not stable, inertia takes over.
    pub(in crate::solve) fn watch_stability(
        &mut self,
        step_run: &mut StepRun,
        start: f64,
        recorder: &mut dyn Recorder,
    ) {
        let step = step_run.step;
        let seeks = step.procedure == Procedure::Auto && !step.drives();
        let method = step_run.fallback.method();
        let direct = method == Method::Direct && step.only_loads();
        let watched = direct || method == Method::QuasiStatic;
        let interval = |load: f64| (load.abs().ln() / step.increments.peak.ln_1p()).floor();
        let changed = start == 0.0 || interval(start) != interval(step_run.load);
        if !(seeks && watched && changed) || step_run.branch.unstable_from.is_some() {
            return;
        }
        let of = (self.model, step);
        let gives_way = gives_way(of, &mut self.system, &self.state, &mut self.trial);
        let (load, floor) = (step_run.load.abs(), step_run.fallback.floor());
        if !gives_way {
            // Below the floor of statics other increments do not resolve the load either.
            if direct && load > floor {
                let most = LONGEST_DIRECT * step.increments.peak * load;
                step_run.schedule.shorten(most);
            }
            return;
        }
        if direct {
            step_run.fallback.start_moving();
            self.adopt(step_run);
            if step_run.fallback.method() != Method::QuasiStatic {
                return;
            }
            self.begin_inertia(step_run, floor);
            self.note(step_run, "direct: the equilibrium is not stable", recorder);
        }
        self.disturb(step_run);
    }

    /// Holds the loads while bodies move, see [`StepRun::hold_or_go_on`]. What the disturbance has moved may come to rest
    /// where it is stable.
    pub(in crate::solve) fn hold_or_go_on(&mut self, step_run: &mut StepRun, moves: bool) {
        let held = step_run.held > 0;
        step_run.hold_or_go_on(moves);
        let rests = held && step_run.held == 0;
        if rests && step_run.branch.unstable_from.is_some() {
            let of = (self.model, step_run.step);
            if !gives_way(of, &mut self.system, &self.state, &mut self.trial) {
                let left = step_run.branch.unstable_from.take();
                self.summary.warnings.extend(left.map(|load_factor| {
                    format!(
                        "step {} ({}): the equilibrium is not stable at load factor {load_factor:.4}: the scene moves \
                         aside there, and comes to rest in another one",
                        step_run.index, step_run.step.name
                    )
                }));
            }
        }
    }

    /// Warns at the end of a step whose equilibrium is not stable, although inertia found no motion that leads away from
    /// it.
    pub(in crate::solve) fn warn_of_instability(&mut self, step_run: &StepRun) {
        let collapsed = self.summary.status == Status::Collapsed;
        if let (Some(load_factor), false) = (step_run.branch.unstable_from, collapsed) {
            self.summary.warnings.push(format!(
                "step {} ({}): the equilibrium is not stable from load factor {load_factor:.4} on: the scene buckles if \
                 anything moves it aside",
                step_run.index, step_run.step.name
            ));
        }
    }
}
