//! One increment: equilibrium by Newton's method with the energy line search.
//!
//! With the shifted penalty (docs/theory/equilibrium.md, eq. 6) the tractions of the last iterate enter the interface
//! law, so that each iteration is one step of the fixed point and one Newton step of equilibrium at
//! once. The increment is converged when the out-of-balance force is below the tolerance after the
//! tractions were taken over: their change, as the nodes feel it, is then below it too.
//!
//! With secant stiffness the same holds of the solids: each iterate is linear about the last update
//! of their viscous strain and damage, and the out-of-balance force is that of the law.

pub use super::convergence::IMBALANCE;
use super::convergence::{Balance, NEGLIGIBLE, WORK, largest, least_scale, root_mean_square};
use super::direction::Factors;
use super::energy_balance::pursuit;
use super::external_forces::Loads;
use super::line_search::{LineSearch, dot};
use super::outcome::{Attempt, Outcome, Refusal, Report, Solves};
use super::traction_patterns::Pause;
use crate::assembly::{Equations, Evaluation, Solids, System, Trial, Turning};
use crate::linear::LinearSolver;
use crate::model::Model;
use crate::model::scene::{BeamMotion, Procedure, Step, Tangent};
use crate::solve::dynamics::integration::Motion;
use crate::solve::stepping::fallback::MethodChoice;
use crate::solve::stepping::path::Advance;
use crate::solve::stepping::relaxation::Dashpots;
use crate::solve::stepping::step_size::Increment;
use crate::state::Clock;
use crate::state::Method;
use crate::state::State;
use std::ops::Range;
use std::time::Instant;

/// The equations of one step and their solver.
pub struct Newton<'m> {
    pub(in crate::solve) model: &'m Model,
    pub(in crate::solve) step: &'m Step,
    pub(in crate::solve) method: Method,
    pub(in crate::solve) tangent: Tangent,
    pub(in crate::solve) equations: Equations,
    pub(in crate::solve) linear: Option<LinearSolver>,
    /// Its factors, if they are of a matrix of this increment: those of another one serve none of its iterates, so that what a
    /// run finds that goes on from its start hangs on the state alone.
    pub(in crate::solve) factors: Option<Factors>,
    /// [`State::wants_double`] where the increment starts.
    pub(in crate::solve) wants_double: bool,
    pub(in crate::solve) values: Vec<f64>,
    /// Which filling `values` are of; none: anything.
    pub(in crate::solve) filled: Option<u64>,
    pub(in crate::solve) direction: Vec<f64>,
    pub(in crate::solve) residual: Vec<f64>,
    /// What the last commit left out of balance [N].
    pub(in crate::solve) left: Vec<f64>,
    /// What joins −r on the right-hand side of the next solve [N] `[equation]`; empty = nothing.
    pub(in crate::solve) pull: Vec<f64>,
    /// −K⁻¹ ∂r/∂λ, where the load is an unknown.
    pub(in crate::solve) by_load: Vec<f64>,
    /// λ: part of the step's loads at the last iterate.
    pub(in crate::solve) load_factor: f64,
    /// Part of the step's time at the end of the increment.
    pub(in crate::solve) moment: f64,
    /// How fast λ grows with the part of the time where it is prescribed.
    pub(in crate::solve) slope: f64,
    pub(in crate::solve) q: Vec<f64>,
    pub(in crate::solve) q_start: Vec<f64>,
    /// Internal forces that the tangent makes of the start of the increment, if it started with that [N]. `[slot]`
    pub(in crate::solve) linear_forces: Option<Vec<f64>>,
    /// Ends of the springs when the step began [mm]. `[spring][xyz]`
    pub(in crate::solve) ends_start: Vec<[f64; 3]>,
    /// Loads at the end of the increment.
    pub(in crate::solve) loads: Loads,
    /// Loads at its start.
    pub(in crate::solve) loads_start: Loads,
    /// What forces are measured in where nothing else tells [N], see [`least_scale`].
    pub(in crate::solve) least_scale: f64,
    /// Inertia, if it acts.
    pub(in crate::solve) motion: Option<Motion>,
    /// The dashpots of a relaxation, if one is in progress.
    pub(in crate::solve) dashpots: Option<Dashpots>,
    /// When patterns of tractions are settled.
    pub(in crate::solve) pause: Pause,
    /// Wall time by phase.
    pub clock: Clock,
}

pub(in crate::solve) fn timed<T>(clock: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = work();
    *clock += start.elapsed().as_secs_f64();
    result
}

impl<'m> Newton<'m> {
    /// Prepares a step that begins at `state`.
    pub fn new(model: &'m Model, step: &'m Step, system: &System, state: &State) -> Self {
        let equations = Equations::new(&system.dofs, step);
        let n = equations.len();
        let loads = Loads::new(step, system, state);
        Self {
            model,
            step,
            least_scale: least_scale(step, system, &loads),
            method: Method::Static,
            tangent: step.tangent,
            equations,
            linear: None,
            factors: None,
            wants_double: false,
            values: Vec::new(),
            filled: None,
            direction: vec![0.0; n],
            residual: vec![0.0; n],
            left: vec![0.0; n],
            pull: Vec::new(),
            by_load: Vec::new(),
            load_factor: 0.0,
            moment: 0.0,
            slope: step.branch(0).slope(),
            q: state.q.clone(),
            q_start: state.q.clone(),
            linear_forces: None,
            ends_start: state.spring_ends.clone(),
            loads_start: loads.clone(),
            loads,
            motion: None,
            dashpots: None,
            pause: Pause::default(),
            clock: Clock::default(),
        }
    }

    /// Goes on by the method of `choice`. With inertia the state gets the velocities and accelerations that what is
    /// driven has from here on.
    pub fn adopt(
        &mut self,
        choice: MethodChoice,
        system: &mut System,
        state: &mut State,
        trial: &mut Trial,
    ) {
        let before = self.backend();
        (self.method, self.tangent) = (choice.method, choice.tangent);
        if self.backend() != before {
            self.linear = None;
        }
        self.motion = Motion::new(self.step, self.method, system, &self.equations, self.slope);
        if let Some(motion) = &mut self.motion {
            system.search(trial, &state.q);
            motion.begin(system, state, trial);
        }
    }

    /// Goes on at another rate; with inertia what is driven jumps to its velocity.
    pub fn turn(&mut self, slope: f64, system: &mut System, state: &mut State, trial: &mut Trial) {
        self.slope = slope;
        if let Some(motion) = &mut self.motion {
            motion.drive_at(self.step, system, slope);
            system.search(trial, &state.q);
            motion.begin(system, state, trial);
        }
    }

    /// What solves the increments now.
    pub(in crate::solve) fn method(&self) -> Method {
        self.method
    }

    /// Unknowns of this step.
    pub fn unknowns(&self) -> usize {
        self.equations.len()
    }

    /// Internal forces that the tangent has made of the start of the last increment, if it started with that [N]. `[slot]`
    pub(in crate::solve) fn linear_forces(&self) -> Option<&[f64]> {
        self.linear_forces.as_deref()
    }

    /// The motion, if inertia acts.
    pub fn motion(&mut self) -> Option<&mut Motion> {
        self.motion.as_mut()
    }

    /// Whether the penalty is shifted.
    fn shifted(&self) -> bool {
        self.tangent != Tangent::Direct
    }

    /// Loads, prescribed displacements and ends of the springs at part `s` of those of the step.
    pub(in crate::solve) fn load_to(&mut self, s: f64, system: &System, trial: &mut Trial) {
        self.load_factor = s;
        for (b, motion) in self.step.motion.iter().enumerate() {
            for (i, motion) in motion.iter().enumerate() {
                let slot = system.dofs.beam_slot(b, i);
                match *motion {
                    BeamMotion::Locked => self.q[slot] = self.q_start[slot],
                    BeamMotion::Driven(by) => self.q[slot] = self.q_start[slot] + s * by,
                    BeamMotion::Force(_) => {}
                }
            }
        }
        self.drive_springs(trial, s);
        self.loads.at(self.step, system, s, self.moment);
        trial.loads.clone_from(&self.loads.values);
    }

    /// What of follower pressures a tangent holds: the secant one nothing, and stays symmetric and
    /// positive definite (docs/decisions/follower-pressure.md).
    pub(in crate::solve) fn turning(&self) -> Turning {
        if self.tangent == Tangent::Secant {
            Turning::Ignored
        } else {
            Turning::Exact
        }
    }

    /// Ends of the springs at fraction `s` of the step.
    fn drive_springs(&self, trial: &mut Trial, s: f64) {
        trial.spring_ends.clone_from(&self.ends_start);
        for (end, by) in trial.spring_ends.iter_mut().zip(&self.step.springs) {
            for i in 0..3 {
                end[i] += s * by[i];
            }
        }
    }

    /// Forces of the dashpots at the last iterate [N]. `[equation]`
    pub(in crate::solve) fn dashpot_forces(&self) -> Vec<f64> {
        let slots = self.equations.slot_of.iter().map(|&slot| slot as usize);
        slots
            .map(|slot| {
                let dashpots = self.dashpots.as_ref();
                dashpots.map_or(0.0, |dashpots| dashpots.force(slot, self.q[slot]))
            })
            .collect()
    }

    /// Generalised displacements at the last iterate [mm]. `[slot]`
    pub fn q(&self) -> &[f64] {
        &self.q
    }

    /// Finds equilibrium at the end of an increment, and tells of each linear solve.
    pub fn converge(
        &mut self,
        system: &mut System,
        state: &State,
        trial: &mut Trial,
        attempt: Attempt,
        mut solves: Solves,
    ) -> Outcome {
        // Nothing of refused attempts: a run that goes on knows the state alone.
        self.wants_double = state.wants_double;
        self.factors = None;
        if let Some(linear) = &mut self.linear {
            linear.trust_single(!self.wants_double);
        }
        let found = self
            .iterate(system, state, trial, attempt, &mut solves)
            .and_then(|mut report| {
                if self.method == Method::Implex {
                    (report.out_of_balance, report.extrapolation_error) =
                        self.correct(system, state, trial, attempt.increment)?;
                }
                Ok(report)
            });
        match found {
            Ok(report) => Outcome::Converged(report),
            Err(refusal) => Outcome::Refused(refusal, solves.count),
        }
    }

    fn iterate(
        &mut self,
        system: &mut System,
        state: &State,
        trial: &mut Trial,
        attempt: Attempt,
        solves: &mut Solves,
    ) -> Result<Report, Refusal> {
        // A relaxation ends when nothing is held back any more.
        let dt = if self.dashpots.is_some() {
            self.step.duration
        } else {
            attempt.increment.size * self.step.duration
        };
        let solids = if self.method == Method::Implex {
            // The rate of a state without a last increment is not known: nothing extrapolated.
            let ratio = state.last.as_ref().map_or(0.0, |last| dt / last.dt);
            Solids::Extrapolated { ratio }
        } else if self.tangent == Tangent::Secant {
            Solids::Secant
        } else {
            Solids::Implicit
        };
        let setting = Evaluation {
            dt,
            solids,
            shifted: self.shifted(),
            tangent: true,
            turning: self.turning(),
        };
        self.predict(system, state, trial, attempt, setting, solves)?;
        let most = match &self.dashpots {
            // A stiffer relaxation is cheaper than one that converges slowly.
            Some(_) => self.step.tolerance.max_iterations.min(RELAXING),
            None => self.step.tolerance.max_iterations,
        };
        let report = self.equilibrate(system, state, trial, attempt, solves, setting, 0..most)?;
        if !setting.shifted || self.method == Method::Implex {
            return Ok(report);
        }
        self.settle(system, state, trial, attempt, solves, setting, report)
    }

    /// Iterates until the increment is in balance; `iterations` were done and are allowed.
    #[expect(
        clippy::too_many_arguments,
        reason = "the increment, and how it is evaluated"
    )]
    pub(in crate::solve) fn equilibrate(
        &mut self,
        system: &mut System,
        state: &State,
        trial: &mut Trial,
        attempt: Attempt,
        solves: &mut Solves,
        mut setting: Evaluation,
        iterations: Range<usize>,
    ) -> Result<Report, Refusal> {
        let (solids, tolerance) = (setting.solids, self.step.tolerance);
        let (mut iteration, mut pursued) = (iterations.start, 0);
        // Whether a region alone has led to balance since the last solve of the whole.
        let mut alone = false;
        // Whether a stiffness that knows of softening has led away from balance: the secant one leads on.
        let (mut misled, mut before) = (false, f64::INFINITY);
        // A start in balance is no progress where the path says how far to go.
        let mut on_path = iteration > 0 || attempt.advance == Advance::Load;
        loop {
            timed(&mut self.clock.contact, || system.search(trial, &self.q));
            if solids == Solids::Secant && attempt.repeat {
                setting.solids = if iteration < SOFTENED && !misled {
                    Solids::Softened
                } else {
                    Solids::Secant
                };
            }
            self.evaluate(system, state, trial, setting)?;
            let scale = self.scale(system, state, trial);
            let balance = Balance::new(&self.residual, scale);
            if !balance.largest.is_finite() {
                return Err(Refusal::NotFinite);
            }
            let farther = balance.root_mean_square > before;
            misled |= farther && iteration > 1 && setting.solids == Solids::Softened;
            before = balance.root_mean_square;
            // Nothing has been solved yet: what a start leaves would add up from increment to increment.
            let part = if solves.count == 0 { START } else { 1.0 };
            let mut work = 0.0;
            let mut balanced = balance.holds(part, tolerance.residual);
            // The tractions of the last iterate have just been taken over, so that the residual holds
            // their change as the nodes feel it. The start has taken over nothing yet.
            let settled = (iteration > 0 && trial.is_settled()) || !setting.shifted;
            // Along a path the dissipation is given: nothing lags behind a load. Nor behind none.
            let loaded = scale > self.least_scale;
            if balanced && loaded && attempt.advance == Advance::Load {
                let way: Vec<f64> = self.q.iter().zip(&state.q).map(|(q, s)| q - s).collect();
                let [lost, turned] = self.works(system, state, trial, &way);
                work = lost.abs() / turned.max(f64::MIN_POSITIVE);
                balanced =
                    work <= part * WORK || balance.holds(part * NEGLIGIBLE, tolerance.residual);
            }
            let ends = settled && balanced && on_path;
            if ends && (pursued == pursuit(self.method) || self.closes(system, state, trial)) {
                self.prove(system, trial, attempt.increment.ends_step())?;
                return Ok(Report {
                    iterations: solves.count,
                    residual: balance.largest,
                    out_of_balance: balance.largest,
                    extrapolation_error: 0.0,
                    load_factor: self.load_factor,
                });
            }
            pursued += usize::from(ends);
            let hopeless = self.step.procedure == Procedure::Auto
                && self.motion.is_none()
                && iteration >= PATIENCE
                && balance.root_mean_square > FAR_OFF * IMBALANCE;
            if hopeless || iteration >= iterations.end + pursued {
                let (node, _) = system
                    .dofs
                    .node_of(self.equations.slot_of[balance.worst] as usize);
                return Err(Refusal::Iterations {
                    residual: balance.largest,
                    root_mean_square: balance.root_mean_square,
                    work,
                    node,
                });
            }
            // What a region leaves in balance may be so altogether: it is asked from the start, once.
            let asks = iteration > 0 && on_path && !balanced;
            if asks && self.eliminate(system, state, trial, setting, scale)? && !alone {
                alone = Balance::new(&self.residual, scale).holds(1.0, tolerance.residual);
                if alone {
                    continue;
                }
            }
            alone = false;
            // A start in balance needs no solve, only its tractions taken over.
            if !balanced || !on_path {
                self.pull_along(system, state, attempt.advance);
                if attempt.advance == Advance::Load {
                    self.solve(system, trial)?;
                    solves.one_more();
                    self.search_line(system, state, trial, setting)?;
                } else {
                    let force = self.solve_with_load(system, trial)?;
                    solves.one_more();
                    // The first iterate goes as far as it should.
                    let searches = on_path && self.method == Method::DisplacementControl;
                    self.follow(
                        system,
                        state,
                        trial,
                        setting,
                        attempt.advance,
                        &force,
                        searches,
                    )?;
                    on_path = true;
                }
            }
            trial.keep_tractions();
            iteration += 1;
        }
    }

    /// Forces (and tangents) at `self.q`; the residual of the unknowns.
    pub(in crate::solve) fn evaluate(
        &mut self,
        system: &mut System,
        state: &State,
        trial: &mut Trial,
        setting: Evaluation,
    ) -> Result<(), Refusal> {
        self.clock.evaluations += 1;
        system
            .evaluate(self.model, state, trial, &self.q, setting, &mut self.clock)
            .map_err(|(element, why)| Refusal::Local { element, why })?;
        self.loads.follow(system, &trial.x);
        let loads = &self.loads.total;
        for (r, &slot) in self.residual.iter_mut().zip(&self.equations.slot_of) {
            *r = trial.force[slot as usize] - loads[slot as usize];
        }
        if let Some(dashpots) = &self.dashpots {
            for (r, &slot) in self.residual.iter_mut().zip(&self.equations.slot_of) {
                *r += dashpots.force(slot as usize, self.q[slot as usize]);
            }
        }
        if let Some(motion) = &mut self.motion {
            motion.update(system, state, trial, &self.q, setting.tangent);
            for (r, &slot) in self.residual.iter_mut().zip(&self.equations.slot_of) {
                *r += motion.residual(&system.mass, slot as usize);
            }
        }
        Ok(())
    }

    /// q ← q + η d with the energy line search; leaves the forces of the accepted point in `trial`.
    fn search_line(
        &mut self,
        system: &mut System,
        state: &State,
        trial: &mut Trial,
        setting: Evaluation,
    ) -> Result<(), Refusal> {
        let setting = along(setting);
        let mut search = LineSearch::new(dot(&self.direction, &self.residual));
        if trial.may_meet() || self.flies(system) {
            search = search.to_impact();
        }
        if self.dashpots.is_some() {
            search = search.no_further_than(1.0);
        }
        let slots = self.equations.slot_of.iter();
        let origin: Vec<f64> = slots.map(|&slot| self.q[slot as usize]).collect();
        search.run(|eta| {
            let from = origin.iter().zip(&self.direction);
            for ((q, d), &slot) in from.zip(&self.equations.slot_of) {
                self.q[slot as usize] = q + eta * d;
            }
            self.evaluate(system, state, trial, setting)?;
            Ok(dot(&self.direction, &self.residual))
        })
    }

    /// Updates extrapolated solids implicitly at the converged displacements. Returns the largest true
    /// out-of-balance force and the root mean square of what the update changed of the forces, both
    /// over the mean nodal force (theory F, B.3): the second is the error of the extrapolation, free
    /// of what the tolerance left.
    ///
    /// # Errors
    /// The law that gave no answer.
    fn correct(
        &mut self,
        system: &mut System,
        state: &State,
        trial: &mut Trial,
        increment: Increment,
    ) -> Result<(f64, f64), Refusal> {
        let setting = Evaluation {
            dt: increment.size * self.step.duration,
            solids: Solids::Implicit,
            shifted: self.shifted(),
            tangent: false,
            turning: Turning::Ignored,
        };
        let solved = trial.force.clone();
        let mut left = self.residual.clone();
        self.evaluate(system, state, trial, setting)?;
        let scale = self.scale(system, state, trial);
        let (largest, _) = largest(&self.residual);
        for (left, r) in left.iter_mut().zip(&self.residual) {
            *left -= r;
        }
        // Reactions are those of the equilibrium that was solved.
        trial.force = solved;
        Ok((largest / scale, root_mean_square(&left) / scale))
    }
}

/// Iterates of an increment that know of the softening of the solids. Those after them, and those after a
/// cut, take the secant stiffness: slower, but it does not circle where a unit snaps.
const SOFTENED: usize = 6;

/// Iterations after which an increment of `auto` is given up whose out-of-balance forces, in the root mean square, are still
/// more than so many times the tolerance: a smaller one, or a relaxation, is cheaper.
const PATIENCE: usize = 12;
const FAR_OFF: f64 = 10.0;

/// Iterations of a sub-increment of a relaxation at most.
const RELAXING: usize = 14;

/// How forces are asked for along a direction: that of held solids. Their law is asked at the end.
pub(in crate::solve) fn along(setting: Evaluation) -> Evaluation {
    Evaluation {
        tangent: false,
        solids: match setting.solids {
            Solids::Secant => Solids::Held,
            solids => solids,
        },
        ..setting
    }
}

/// Part of the tolerance within which a start is equilibrium without a solve.
const START: f64 = 0.1;
