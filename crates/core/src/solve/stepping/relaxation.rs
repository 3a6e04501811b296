//! Relaxation of a snap: dashpots at the nodes carry the structure to its next equilibrium
//! (docs/theory/procedures.md, eqs 10 and 11).
//!
//! Where a unit cracks through or a joint parts, the next equilibrium is far away and Newton's method does not find
//! it. The relevant equilibrium is that of vanishing viscosity. With internal forces p, loads F, a dashpot at every
//! degree of freedom and constant loads and drives, the motion obeys
//!
//! ```text
//! C u̇ + p(u) = F
//! ```
//!
//! It ends in an equilibrium. Its path depends on the distribution of C only, not on its size. Backward Euler in a
//! pseudo-time τ gives sub-increments
//!
//! ```text
//! p(u₁) − F + κ c (u₁ − u₀) = 0,   κ = 1/Δτ
//! ```
//!
//! The coefficient c of a node is the mean of E h of its elements (Young's modulus times size), so that dashpots with
//! κ = 1 are about as stiff as the elements around the node. κ falls while the sub-increments converge and grows
//! where one fails. The first sub-increment applies the loads of the rejected increment; its dashpots act on the
//! difference to the predicted displacements and so do not resist the drive. The relaxation ends when the dashpot
//! forces are below the tolerance of equilibrium: the state is then static. Where a body had come loose, it is solved
//! once more with κ = 0, because dashpots alone may hold that body. The work of the dashpots is the energy
//! that the snap releases, and counts as damping.
//!
//! Where the prediction of the first sub-increment is wrong, the drive pulls the structure through its dashpots. This
//! work is none of the structure: the drive's work is that of its forces at both ends of the relaxation.

use super::acceptance::LOST;
use super::path::Advance;
use super::run::Run;
use super::step_run::{IncrementRequest, StepRun};
use crate::assembly::{Equations, System};
use crate::model::Model;
use crate::model::scene::Procedure;
use crate::solve::Recorder;
use crate::solve::increment::convergence::Balance;
use crate::solve::increment::outcome::{Attempt, Outcome, Problem, Report, Solves};
use crate::state::{Energies, Method, State};

/// Dashpots of one sub-increment.
#[derive(Clone, Debug)]
pub(in crate::solve) struct Dashpots {
    /// c, the mean of E h of the elements around each node, summed over the nodes of a beam [N/mm]. `[slot]`
    coefficient: Vec<f64>,
    /// κ [-].
    pub(in crate::solve) factor: f64,
    /// Displacements u₀ at which the dashpot forces vanish [mm]. `[slot]`
    anchor: Vec<f64>,
    /// Whether the sub-increment changes loads; the anchor is then the predicted displacement.
    pub(in crate::solve) loads: bool,
    /// Whether states on the way need less than all criteria: no body has come loose, whose energy they would lose.
    pub(in crate::solve) passes: bool,
}

impl Dashpots {
    /// Dashpots of a model; [`Self::anchor_at`] must be called before they act.
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
            passes: false,
        }
    }

    /// Sets the displacements u₀ at which the dashpot forces vanish [mm]. `[slot]`
    pub(in crate::solve) fn anchor_at(&mut self, q: &[f64]) {
        self.anchor.copy_from_slice(q);
    }

    /// Dashpot force κ c (q − u₀) [N].
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
/// Largest κ; stiffer dashpots do not help.
const STIFFEST: f64 = 1e3;
/// Smallest κ; forces that remain below it have no equilibrium.
const SOFTEST: f64 = 1e-9;
/// Part of the tolerance of equilibrium below which the structure is at rest.
pub(in crate::solve) const AT_REST: f64 = 0.3;
/// Most sub-increments of a relaxation.
const MOST: usize = 80;
/// Growth of κ after a sub-increment that failed.
const STIFFER: f64 = 5.0;
/// Most solves for a quick fall of κ, and for a slow one.
const EASY: usize = 5;
const FAIR: usize = 9;
/// Most solves for a fall of κ if the motion speeds up.
const AT_ONCE: usize = 2;
/// Factors of κ in a quick and in a slow fall.
const QUICKLY: f64 = 0.1;
const SLOWLY: f64 = 0.3;
/// Number of sub-increments after a failed one in which κ neither falls quickly nor below `ABOVE_FAILED` of the κ that
/// failed: it would fail there again.
const CAUTIOUS: usize = 5;
const ABOVE_FAILED: f64 = 2.0;
/// Ratio of dashpot forces to those of the last sub-increment below which κ may fall quickly.
const FALLS: f64 = 0.9;

/// Largest work of the dashpots over all work done before. A snap releases a part of this work, and bodies that fall by a
/// gap under their weight some hundred times the work that pressed them elastically.
const MOST_WORK: f64 = 1e3;

impl Run<'_> {
    /// Carries the structure from the last commit, over a snap within the rejected increment of `request`, to the
    /// next equilibrium. Returns the request by which the trial, which then holds this equilibrium, is to be
    /// committed. Returns none and restores the state if no equilibrium is near. `proves`: whether the equilibrium is
    /// solved once more without dashpots, which may hold a body that nothing else holds.
    pub(in crate::solve) fn relax(
        &mut self,
        step_run: &mut StepRun,
        request: IncrementRequest,
        proves: bool,
        recorder: &mut dyn Recorder,
    ) -> Option<(IncrementRequest, Report)> {
        let (saved, carried) = (self.state.clone(), step_run.newton.carried());
        let (load, increments) = (step_run.load, self.state.increments);
        step_run.newton.dashpots = Some(Dashpots {
            passes: !proves,
            ..Dashpots::new(self.model, &self.system)
        });
        let work = self.energy_watch.work().max(saved.energies.taken());
        let found = self.relax_in_steps(step_run, request, proves, recorder);
        let damped = self.state.energies.damping - saved.energies.damping;
        // Where the prediction of the first sub-increment is wrong, the drive pulls the structure through its dashpots.
        let found = found.filter(|_| damped <= MOST_WORK * work);
        let Some((request, report, driven)) = found else {
            self.state = saved;
            step_run.newton.carry_on(carried);
            step_run.newton.dashpots = None;
            step_run.load = load;
            return None;
        };
        self.state.increments = increments;
        self.take_off_drag(step_run, &saved, driven);
        Some((request, report))
    }

    /// The same in sub-increments, with the work of the drive [N mm].
    fn relax_in_steps(
        &mut self,
        step_run: &mut StepRun,
        mut request: IncrementRequest,
        proves: bool,
        recorder: &mut dyn Recorder,
    ) -> Option<(IncrementRequest, Report, f64)> {
        request.method = Method::Relaxation;
        let reach = self.system.contact.reach();
        let mut start = self.state.q.clone();
        let (mut softening, mut loads) = (Softening::default(), true);
        let mut at_rest = false;
        let mut driven = 0.0;
        for _ in 0..MOST {
            if let Some(dashpots) = &mut step_run.newton.dashpots {
                let factor = if at_rest { 0.0 } else { softening.factor };
                (dashpots.factor, dashpots.loads) = (factor, loads);
            }
            let report = match self.relax_once(step_run, request, loads, recorder) {
                Ok(report) => report,
                Err(spent) => {
                    step_run.attempts.solves += spent;
                    if at_rest {
                        return None; // only dashpots held it
                    }
                    softening.stiffen()?;
                    continue;
                }
            };
            driven += step_run
                .newton
                .driven_work(&self.system, &self.state, &self.trial);
            if at_rest {
                return Some((request, report, driven));
            }
            let newton = &mut step_run.newton;
            let scale = newton.scale(&self.system, &self.state, &self.trial);
            let balance = Balance::new(&newton.dashpot_forces(), scale);
            at_rest = balance.holds(AT_REST, step_run.step.tolerance.residual);
            if at_rest && !proves {
                return Some((request, report, driven));
            }
            step_run.attempts.solves += report.iterations;
            let added = report.load_factor - step_run.load;
            self.commit(newton, step_run.step, request.increment.size, added);
            step_run.load = report.load_factor;
            if loads {
                start.clone_from(&self.state.q);
            }
            if loads || at_rest {
                self.state.last = None;
            } else if let Some(last) = &mut self.state.last {
                last.dt = 1.0 / softening.factor;
            }
            request.increment = request.increment.and_then_none();
            loads = false;
            if at_rest {
                continue;
            }
            softening.soften(report.iterations, balance.root_mean_square);
            let way = self.state.q.iter().zip(&start);
            let falls_apart = way.into_iter().any(|(q, s)| (q - s).abs() > reach);
            if falls_apart || softening.factor < SOFTEST {
                return None;
            }
        }
        None
    }

    /// Energy that solids, joints and dashpots take in the sub-increment that ends at the trial beyond the work done
    /// [N mm].
    fn energy_made(&self, step_run: &StepRun) -> f64 {
        let (newton, state) = (&step_run.newton, &self.state);
        let ways = newton.q().iter().zip(&state.q);
        let dq: Vec<f64> = ways.map(|(q, start)| q - start).collect();
        let energies = newton
            .account(&self.system, state, &self.trial, &dq)
            .energies;
        let taken = |e: &Energies| e.taken() + e.damping - e.external;
        taken(&energies) - taken(&state.energies)
    }

    /// Takes the work by which the drive pulled dashpots, a part of `driven` since `saved`, off work and damping
    /// [N mm].
    fn take_off_drag(&mut self, step_run: &StepRun, saved: &State, driven: f64) {
        let newton = &step_run.newton;
        let drag = driven - newton.driven_work(&self.system, saved, &self.trial);
        let energies = &mut self.state.energies;
        let drag = drag.min(energies.damping - saved.energies.damping);
        energies.external -= drag;
        energies.damping -= drag;
    }

    /// One sub-increment; the number of its solves if it failed. `loads`: whether it adds the loads of the increment.
    fn relax_once(
        &mut self,
        step_run: &mut StepRun,
        request: IncrementRequest,
        loads: bool,
        recorder: &mut dyn Recorder,
    ) -> Result<Report, usize> {
        let (before, time, index) = (step_run.attempts.solves, self.state.time, step_run.index);
        let mut tell = |count| recorder.progress(index, time, before + count);
        let (load_end, part) = if loads {
            let end = request.increment.end();
            (step_run.branch.of.factor(end), step_run.part(&request))
        } else {
            (step_run.load, 0.0)
        };
        let steers = step_run.step.procedure == Procedure::DisplacementControl;
        let control = step_run.path.control.as_ref().filter(|_| steers);
        let outcome = step_run.newton.converge(&mut Problem {
            system: &mut self.system,
            state: &self.state,
            trial: &mut self.trial,
            attempt: Attempt {
                increment: request.increment,
                load: step_run.load,
                load_end,
                repeat: true,
                advance: control.map_or(Advance::Load, |control| control.along(part)),
            },
            solves: Solves::new(&mut tell),
        });
        let work = self.energy_watch.work().max(self.state.energies.taken());
        match outcome {
            // An equilibrium with more energy is another one, far away.
            Outcome::Converged(report) if self.energy_made(step_run) > LOST * work => {
                Err(report.iterations)
            }
            Outcome::Converged(report) => Ok(report),
            Outcome::Rejected(_, spent) => Err(spent),
        }
    }
}

/// κ, the factor on the stiffness of the dashpots, through a relaxation.
struct Softening {
    /// κ [-].
    factor: f64,
    /// Number of the next sub-increments in which κ falls with caution, see [`CAUTIOUS`].
    slowly: usize,
    /// κ of the last sub-increment that failed; 0 if none has.
    failed: f64,
    /// Root mean square of the dashpot forces in the last sub-increment, over the mean nodal force.
    last_force: f64,
}

impl Default for Softening {
    fn default() -> Self {
        Self {
            factor: FIRST,
            slowly: 0,
            failed: 0.0,
            last_force: f64::INFINITY,
        }
    }
}

impl Softening {
    /// Raises κ after a sub-increment that failed; none if it is too large already.
    fn stiffen(&mut self) -> Option<()> {
        self.failed = self.factor;
        self.factor *= STIFFER;
        self.slowly = CAUTIOUS;
        (self.factor <= STIFFEST).then_some(())
    }

    /// Lowers κ after a sub-increment of so many solves, with this root mean square of the dashpot forces.
    fn soften(&mut self, solves: usize, force: f64) {
        self.slowly = self.slowly.saturating_sub(1);
        let falls = force < FALLS * self.last_force;
        // A steady motion, such as that of a toe that is crushed, takes too many sub-increments at one κ.
        let is_steady = force < self.last_force;
        self.last_force = force;
        if solves <= EASY && self.slowly == 0 && falls {
            self.factor *= QUICKLY;
        } else if solves <= FAIR && (is_steady || solves <= AT_ONCE) {
            self.factor *= SLOWLY;
        }
        if self.slowly > 0 {
            self.factor = self.factor.max(ABOVE_FAILED * self.failed);
        }
    }
}
