//! Relaxation of a snap: dashpots at the nodes carry a structure that has lost its equilibrium to the next one.
//!
//! Where a unit cracks through or a joint parts, the next equilibrium is far away and Newton's method does not find it. The
//! answer that counts is that of vanishing viscosity. With internal forces p, loads F, a dashpot at every degree of freedom
//! and loads and drives held, the motion obeys
//!
//! ```text
//! C u̇ + p(u) = F
//! ```
//!
//! whose end is an equilibrium and whose way does not depend on the size of C, only on its distribution. Backward Euler in a
//! pseudo-time τ gives sub-increments
//!
//! ```text
//! p(u₁) − F + κ c (u₁ − u₀) = 0,   κ = 1/Δτ
//! ```
//!
//! with c of a node the mean of E h of its elements (Young's modulus times size), so that κ = 1 resists about as the elements
//! around the node do. κ falls while the sub-increments converge and grows where one does not. The first sub-increment takes
//! the increment of the loads that was refused; its dashpots act on the difference to the predicted displacements, so that
//! they do not resist the drive. The relaxation ends when the forces of the dashpots are below the tolerance of equilibrium:
//! the state is then one of statics. Their work is the energy that the snap sets free, and is counted as damping.

use super::path::Advance;
use super::run::Run;
use super::step_run::{IncrementRequest, StepRun};
use super::step_size::Increment;
use crate::assembly::{Equations, System};
use crate::model::Model;
use crate::model::scene::Procedure;
use crate::solve::Recorder;
use crate::solve::increment::convergence::Balance;
use crate::solve::increment::outcome::{Attempt, Outcome, Report, Solves};
use crate::state::Method;

/// The dashpots of one sub-increment.
#[derive(Clone, Debug)]
pub(in crate::solve) struct Dashpots {
    /// c: mean of E h of the elements around each node, summed over the nodes of a beam [N/mm]. `[slot]`
    coefficient: Vec<f64>,
    /// κ [-].
    pub(in crate::solve) factor: f64,
    /// Displacements that the dashpots resist leaving [mm]. `[slot]`
    anchor: Vec<f64>,
    /// Whether the sub-increment adds loads: the anchor is then the predicted displacement.
    pub(in crate::solve) loads: bool,
}

impl Dashpots {
    /// The dashpots of a model; they do not act before [`Self::anchor_at`].
    pub(in crate::solve) fn new(model: &Model, system: &System) -> Self {
        let mesh = &model.mesh;
        let mut node = vec![0.0; mesh.nodes.len()];
        for (e, nodes) in mesh.elements.iter().enumerate() {
            let parameters = &model.materials[mesh.material[e] as usize].parameters;
            let stiffness = parameters.elastic().E * system.bulk.shape(e).volume.cbrt();
            for &n in nodes {
                node[n as usize] += 0.125 * stiffness;
            }
        }
        let mut coefficient = vec![0.0; system.dofs.slots];
        for (c, slots) in node.iter().zip(&system.dofs.slot) {
            for &slot in slots {
                if let Some(sum) = coefficient.get_mut(slot as usize) {
                    *sum += c;
                }
            }
        }
        Self {
            anchor: vec![0.0; coefficient.len()],
            coefficient,
            factor: 1.0,
            loads: false,
        }
    }

    /// The dashpots resist leaving these displacements [mm]. `[slot]`
    pub(in crate::solve) fn anchor_at(&mut self, q: &[f64]) {
        self.anchor.copy_from_slice(q);
    }

    /// Force of a dashpot against leaving its anchor [N].
    pub(in crate::solve) fn force(&self, slot: usize, q: f64) -> f64 {
        self.factor * self.coefficient[slot] * (q - self.anchor[slot])
    }

    /// Adds κ c to the diagonal of the matrix of `equations`.
    pub(in crate::solve) fn add_to(
        &self,
        system: &System,
        equations: &Equations,
        values: &mut [f64],
    ) {
        system.add_diagonal(equations, self.factor, &self.coefficient, values);
    }
}

/// κ of the first sub-increment.
const FIRST: f64 = 1.0;
/// Largest κ: stiffer dashpots find nothing either.
const STIFFEST: f64 = 1e3;
/// Smallest κ: forces that do not die away with it have no equilibrium.
const SOFTEST: f64 = 1e-9;
/// Part of the tolerance of equilibrium below which dashpot forces are none.
const AT_REST: f64 = 0.3;
/// Sub-increments of a relaxation at most.
const MOST: usize = 80;
/// Growth of κ where a sub-increment does not converge.
const STIFFER: f64 = 5.0;
/// Solves up to which κ falls quickly, and up to which it falls.
const EASY: usize = 5;
const FAIR: usize = 9;
/// The same of a motion that does not slow down.
const AT_ONCE: usize = 2;
/// Factors of κ then.
const QUICKLY: f64 = 0.1;
const SLOWLY: f64 = 0.3;
/// Sub-increments after one that did not converge in which κ falls slowly.
const CAUTIOUS: usize = 2;
/// Dashpot forces over those of the last sub-increment below which the motion slows down.
const FALLS: f64 = 0.9;

impl Run<'_> {
    /// Carries the structure from the last commit over a snap within the refused increment of `request` to the next equilibrium.
    /// The trial holds it then, with the request to commit it by; none if there is no equilibrium near, and the state is as before.
    pub(in crate::solve) fn relax(
        &mut self,
        step_run: &mut StepRun,
        request: IncrementRequest,
        recorder: &mut dyn Recorder,
    ) -> Option<(IncrementRequest, Report)> {
        let (saved, carried) = (self.state.clone(), step_run.newton.carried());
        let (load, increments) = (step_run.load, self.state.increments);
        step_run.newton.dashpots = Some(Dashpots::new(self.model, &self.system));
        let found = self.relax_in_steps(step_run, request, recorder);
        if found.is_some() {
            self.state.increments = increments;
        } else {
            self.state = saved;
            step_run.newton.carry_on(carried);
            step_run.newton.dashpots = None;
            step_run.load = load;
        }
        found
    }

    fn relax_in_steps(
        &mut self,
        step_run: &mut StepRun,
        request: IncrementRequest,
        recorder: &mut dyn Recorder,
    ) -> Option<(IncrementRequest, Report)> {
        let mut request = IncrementRequest {
            method: Method::Relaxation,
            ..request
        };
        let reach = self.system.contact.reach();
        let mut start = self.state.q.clone();
        let (mut factor, mut loads, mut slowly) = (FIRST, true, 0_usize);
        let mut last_force = f64::INFINITY;
        for _ in 0..MOST {
            let (before, time, index) = (step_run.solves, self.state.time, step_run.index);
            let mut tell = |count| recorder.progress(index, time, before + count);
            let newton = &mut step_run.newton;
            if let Some(dashpots) = &mut newton.dashpots {
                (dashpots.factor, dashpots.loads) = (factor, loads);
            }
            let load_end = if loads {
                step_run.branch.factor(request.increment.end())
            } else {
                step_run.load
            };
            let part = if loads { step_run.part(&request) } else { 0.0 };
            let steers = step_run.step.procedure == Procedure::DisplacementControl;
            let control = step_run.control.as_ref().filter(|_| steers);
            let attempt = Attempt {
                increment: request.increment,
                load: step_run.load,
                load_end,
                repeat: true,
                advance: control.map_or(Advance::Load, |control| control.along(part)),
            };
            let outcome = step_run.newton.converge(
                &mut self.system,
                &self.state,
                &mut self.trial,
                attempt,
                Solves::new(&mut tell),
            );
            let report = match outcome {
                Outcome::Converged(report) => report,
                Outcome::Refused(_, spent) => {
                    step_run.solves += spent;
                    factor *= STIFFER;
                    slowly = CAUTIOUS;
                    if factor > STIFFEST {
                        return None;
                    }
                    continue;
                }
            };
            let forces = step_run.newton.dashpot_forces();
            let scale = step_run
                .newton
                .scale(&self.system, &self.state, &self.trial);
            let balance = Balance::new(&forces, scale);
            if balance.holds(AT_REST, step_run.step.tolerance.residual) {
                return Some((request, report));
            }
            step_run.solves += report.iterations;
            let added = report.load_factor - step_run.load;
            self.commit(
                &mut step_run.newton,
                step_run.step,
                request.increment.size,
                added,
            );
            step_run.load = report.load_factor;
            if loads {
                self.state.last = None;
                start.clone_from(&self.state.q);
            } else if let Some(last) = &mut self.state.last {
                last.dt = 1.0 / factor;
            }
            request.increment = Increment {
                start: request.increment.end(),
                size: 0.0,
            };
            loads = false;
            slowly = slowly.saturating_sub(1);
            let falls = balance.root_mean_square < FALLS * last_force;
            last_force = balance.root_mean_square;
            if report.iterations <= EASY && slowly == 0 && falls {
                factor *= QUICKLY;
            } else if report.iterations <= FAIR && (falls || report.iterations <= AT_ONCE) {
                factor *= SLOWLY;
            }
            let way = self.state.q.iter().zip(&start);
            let falls_apart = way.into_iter().any(|(q, s)| (q - s).abs() > reach);
            if falls_apart || factor < SOFTEST {
                return None;
            }
        }
        None
    }
}
