//! One increment: equilibrium by Newton's method with an energy line search (docs/theory/equilibrium.md).
//!
//! With the shifted penalty (eq. 6 there) the interface law uses the tractions of the last iterate. Each iteration is
//! therefore one step of that fixed point and one Newton step of equilibrium at once. The increment has converged
//! when the out-of-balance force is below the tolerance after the tractions were taken over. The nodal forces of the
//! traction change are then below the tolerance too.
//!
//! With secant stiffness the solids are treated alike: each iterate is linear about the last update of viscous strain
//! and damage, and the out-of-balance force is that of the law.

use super::body_balance::Bodies;
pub use super::convergence::IMBALANCE;
use super::convergence::{Balance, Scales, largest, least_scale, root_mean_square};
use super::energy_balance::traction_updates;
use super::external_forces::Loads;
use super::line_search::{LineSearch, dot};
use super::linear_system::{Loading, TangentMatrix, Vectors};
use super::outcome::{Outcome, Problem, Rejection, Report};
use super::traction_patterns::Pause;
use crate::assembly::{Equations, Evaluation, Solids, System, Trial, Turning};
use crate::model::Model;
use crate::model::scene::{BeamMotion, Step, Tangent};
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

/// The equations of one step, their solver and the present iterate.
pub struct Newton<'m> {
    pub(in crate::solve) model: &'m Model,
    pub(in crate::solve) step: &'m Step,
    pub(in crate::solve) choice: MethodChoice,
    pub(in crate::solve) equations: Equations,
    pub(in crate::solve) matrix: TangentMatrix,
    pub(in crate::solve) vectors: Vectors,
    pub(in crate::solve) loading: Loading,
    pub(in crate::solve) q: Vec<f64>,
    pub(in crate::solve) q_start: Vec<f64>,
    /// Internal forces that the first tangent predicts at the end of the increment, if the increment started from
    /// that tangent [N]. `[slot]`
    pub(in crate::solve) linear_forces: Option<Vec<f64>>,
    pub(in crate::solve) scales: Scales,
    /// State of the time integration, if inertia acts.
    pub(in crate::solve) motion: Option<Motion>,
    /// Dashpots of a relaxation, if one is in progress.
    pub(in crate::solve) dashpots: Option<Dashpots>,
    /// Increments in which traction patterns are not settled.
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
        let loads = Loads::new(step, system, state);
        Self {
            model,
            step,
            scales: Scales {
                least: least_scale(step, system, &loads),
                bodies: Bodies::new(model, system),
                loosened: 0,
            },
            choice: MethodChoice {
                method: Method::Static,
                tangent: step.tangent,
            },
            matrix: TangentMatrix::default(),
            vectors: Vectors::new(equations.len()),
            equations,
            loading: Loading {
                factor: 0.0,
                moment: 0.0,
                slope: step.branch(0).slope(),
                loads_start: loads.clone(),
                loads,
                ends_start: state.spring_ends.clone(),
            },
            q: state.q.clone(),
            q_start: state.q.clone(),
            linear_forces: None,
            motion: None,
            dashpots: None,
            pause: Pause::default(),
            clock: Clock::default(),
        }
    }

    /// Changes to the method of `choice`. With inertia the state gets the velocities and accelerations of the drives
    /// from now on.
    pub fn adopt(
        &mut self,
        choice: MethodChoice,
        system: &mut System,
        state: &mut State,
        trial: &mut Trial,
    ) {
        let before = self.backend();
        self.choice = choice;
        if self.backend() != before {
            self.matrix.solver = None;
        }
        self.motion = Motion::new(
            self.step,
            self.choice.method,
            system,
            &self.equations,
            self.loading.slope,
        );
        if let Some(motion) = &mut self.motion {
            system.search(trial, &state.q);
            motion.begin(system, state, trial);
        }
    }

    /// Changes the rate of the loads and drives. With inertia, driven unknowns jump to their new velocity.
    pub fn turn(&mut self, slope: f64, system: &mut System, state: &mut State, trial: &mut Trial) {
        self.loading.slope = slope;
        if let Some(motion) = &mut self.motion {
            motion.drive_at(self.step, system, slope);
            system.search(trial, &state.q);
            motion.begin(system, state, trial);
        }
    }

    /// The present method.
    pub(in crate::solve) fn method(&self) -> Method {
        self.choice.method
    }

    /// Number of unknowns of this step.
    pub fn unknowns(&self) -> usize {
        self.equations.len()
    }

    /// Internal forces that the first tangent predicted at the end of the last increment, if it started from that
    /// tangent [N]. `[slot]`
    pub(in crate::solve) fn linear_forces(&self) -> Option<&[f64]> {
        self.linear_forces.as_deref()
    }

    /// State of the time integration, if inertia acts.
    pub fn motion(&mut self) -> Option<&mut Motion> {
        self.motion.as_mut()
    }

    /// Whether the penalty is shifted.
    fn shifted(&self) -> bool {
        self.choice.tangent != Tangent::Direct
    }

    /// Sets loads, prescribed displacements and spring ends to part `s` of their change in the step.
    pub(in crate::solve) fn load_to(&mut self, s: f64, system: &System, trial: &mut Trial) {
        self.loading.factor = s;
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
        let stages = self.step.ties.iter().map(|stage| stage.at(s));
        trial.ties.stages.clear();
        trial.ties.stages.extend(stages);
        self.loading
            .loads
            .at(self.step, system, s, self.loading.moment);
        trial.loads.clone_from(&self.loading.loads.values);
    }

    /// Treatment of follower pressures in the tangent. Secant tangents omit their stiffness and so stay symmetric and
    /// positive definite; the line search makes up for it.
    pub(in crate::solve) fn turning(&self) -> Turning {
        if self.choice.tangent == Tangent::Secant {
            Turning::Ignored
        } else {
            Turning::Exact
        }
    }

    /// Moves the spring ends to part `s` of the step.
    fn drive_springs(&self, trial: &mut Trial, s: f64) {
        trial.spring_ends.clone_from(&self.loading.ends_start);
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

    /// Seeks equilibrium at the end of an increment and reports each linear solve.
    pub fn converge(&mut self, at: &mut Problem<'_>) -> Outcome {
        // Rejected attempts leave nothing behind: a resumed run knows the state alone.
        self.matrix.wants_double = at.state.wants_double;
        self.matrix.factors = None;
        if let Some(linear) = &mut self.matrix.solver {
            linear.trust_single(!self.matrix.wants_double);
        }
        let found = self.iterate(at).and_then(|mut report| {
            if self.choice.method == Method::Implex {
                (report.out_of_balance, report.extrapolation_error) =
                    self.correct(at, at.attempt.increment)?;
            }
            Ok(report)
        });
        match found {
            Ok(report) => Outcome::Converged(report),
            Err(rejection) => Outcome::Rejected(rejection, at.solves.count),
        }
    }

    fn iterate(&mut self, at: &mut Problem<'_>) -> Result<Report, Rejection> {
        // Damage must not lag behind at the end of a relaxation, so the full duration of the step is available to it.
        let dt = if self.dashpots.is_some() {
            self.step.duration
        } else {
            at.attempt.increment.size * self.step.duration
        };
        let solids = if self.choice.method == Method::Implex {
            // Without a last increment no rate is known, and nothing is extrapolated.
            let ratio = at.state.last.as_ref().map_or(0.0, |last| dt / last.dt);
            Solids::Extrapolated { ratio }
        } else if self.choice.tangent == Tangent::Secant {
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
        self.predict(at, setting)?;
        let most = match &self.dashpots {
            // A relaxation with stiffer dashpots is cheaper than one that converges slowly.
            Some(_) => self.step.tolerance.max_iterations.min(RELAXING),
            None => self.step.tolerance.max_iterations,
        };
        let report = self.equilibrate(at, setting, 0..most)?;
        if !setting.shifted || self.choice.method == Method::Implex {
            return Ok(report);
        }
        self.settle(at, setting, report)
    }

    /// Iterates until the increment is in balance. `iterations` is the range from the iterations done to the most
    /// allowed.
    pub(in crate::solve) fn equilibrate(
        &mut self,
        at: &mut Problem<'_>,
        mut setting: Evaluation,
        iterations: Range<usize>,
    ) -> Result<Report, Rejection> {
        let (solids, tolerance) = (setting.solids, self.step.tolerance);
        let (mut iteration, mut pursued) = (iterations.start, 0);
        // Whether only a region was solved, and led to balance, since the last solve of the whole.
        let mut alone = false;
        // Whether the residual grew with a tangent that includes softening; the secant stiffness is then taken.
        let (mut misled, mut before) = (false, f64::INFINITY);
        // Where the path prescribes the advance, a balanced start has not advanced and needs a solve.
        let mut on_path = iteration > 0 || at.attempt.advance == Advance::Load;
        // The end of a relaxation is solved without its dashpots, which proves that it stands.
        on_path &= iteration > 0 || self.dashpots.as_ref().is_none_or(|d| d.factor > 0.0);
        loop {
            self.straighten(at.system);
            timed(&mut self.clock.contact, || {
                at.system.search(at.trial, &self.q);
            });
            if solids == Solids::Secant && at.attempt.repeat {
                setting.solids = if iteration < SOFTENED && !misled {
                    Solids::Softened
                } else {
                    Solids::Secant
                };
            }
            self.evaluate(at, setting)?;
            let scale = self.scale(at.system, at.state, at.trial);
            let balance = Balance::new(&self.vectors.residual, scale);
            if !balance.largest.is_finite() {
                return Err(Rejection::NotFinite);
            }
            let farther = balance.root_mean_square > before;
            misled |= farther && iteration > 1 && setting.solids == Solids::Softened;
            before = balance.root_mean_square;
            let (mut balanced, work) = self.is_balanced(at, &balance, scale);
            // The tractions of the last iterate were just taken over, so the residual contains the nodal forces of
            // their change. The predictor has taken over no tractions yet.
            let settled = (iteration > 0 && at.trial.is_settled()) || !setting.shifted;
            let ends = settled && balanced && on_path;
            let all_pursued = pursued == traction_updates(self.choice.method);
            if ends && (all_pursued || self.closes(at.system, at.state, at.trial)) {
                if self.is_near(at, scale)? {
                    return self.converged(at, balance.largest);
                }
                balanced = false;
            }
            pursued += usize::from(ends && !all_pursued);
            if self.is_hopeless(iteration, &balance) || iteration >= iterations.end + pursued {
                return Err(self.not_converged(at.system, &balance, work));
            }
            // Solving a region may balance the whole. In that case all criteria are checked once more from the top.
            let asks = iteration > 0 && on_path && !balanced;
            if asks && self.eliminate(at, setting, scale)? && !alone {
                alone = Balance::new(&self.vectors.residual, scale).holds(1.0, tolerance.residual);
                if alone {
                    continue;
                }
            }
            alone = false;
            // A balanced start needs no solve, only its tractions taken over.
            if !balanced || !on_path {
                self.advance(at, setting, on_path)?;
                on_path = true;
            }
            at.trial.keep_tractions();
            iteration += 1;
        }
    }

    /// Report on an increment in balance whose matrix is positive definite.
    fn converged(&mut self, at: &mut Problem<'_>, largest: f64) -> Result<Report, Rejection> {
        let ends = at.attempt.increment.ends_step();
        self.prove(at.system, at.trial, ends)?;
        Ok(Report {
            iterations: at.solves.count,
            residual: largest,
            out_of_balance: largest,
            extrapolation_error: 0.0,
            load_factor: self.loading.factor,
        })
    }

    /// One solve and the way along its direction. `on_path`: whether the prescribed advance was taken.
    fn advance(
        &mut self,
        at: &mut Problem<'_>,
        setting: Evaluation,
        on_path: bool,
    ) -> Result<(), Rejection> {
        self.pull_along(at.system, at.state, at.attempt.advance);
        if at.attempt.advance == Advance::Load {
            self.solve(at.system, at.trial)?;
            at.solves.one_more();
            return self.search_line(at, setting);
        }
        let force = self.solve_with_load(at.system, at.trial)?;
        at.solves.one_more();
        // The first iterate takes the full prescribed advance.
        let searches = on_path && self.step.control.is_some();
        self.follow(at, setting, &force, searches)
    }

    /// Evaluates forces (and tangents) at `self.q` and forms the residual of the unknowns.
    pub(in crate::solve) fn evaluate(
        &mut self,
        at: &mut Problem<'_>,
        setting: Evaluation,
    ) -> Result<(), Rejection> {
        self.clock.evaluations += 1;
        self.straighten(at.system);
        at.system
            .evaluate(
                self.model,
                at.state,
                at.trial,
                &self.q,
                setting,
                &mut self.clock,
            )
            .map_err(|(element, why)| Rejection::Local { element, why })?;
        self.loading.loads.follow(at.system, &at.trial.x);
        let loads = &self.loading.loads.total;
        for (r, &slot) in self
            .vectors
            .residual
            .iter_mut()
            .zip(&self.equations.slot_of)
        {
            *r = at.trial.force[slot as usize] - loads[slot as usize];
        }
        if let Some(dashpots) = &self.dashpots {
            for (r, &slot) in self
                .vectors
                .residual
                .iter_mut()
                .zip(&self.equations.slot_of)
            {
                *r += dashpots.force(slot as usize, self.q[slot as usize]);
            }
        }
        if let Some(motion) = &mut self.motion {
            motion.update(at.system, at.state, at.trial, &self.q, setting.tangent);
            for (r, &slot) in self
                .vectors
                .residual
                .iter_mut()
                .zip(&self.equations.slot_of)
            {
                *r += motion.residual(&at.system.mass, slot as usize);
            }
        }
        let (system, residual) = (&at.system, &mut self.vectors.residual);
        (system.rigid).project(&system.dofs, &self.equations, &at.trial.x, residual);
        Ok(())
    }

    /// Moves the nodes of rigid bodies to a rigid pose.
    fn straighten(&mut self, system: &System) {
        system.rigid.straighten(&system.dofs, &mut self.q);
    }

    /// q ← q + η d with the energy line search; leaves the forces of the accepted point in `trial`.
    fn search_line(&mut self, at: &mut Problem<'_>, setting: Evaluation) -> Result<(), Rejection> {
        let setting = along(setting);
        let mut search = LineSearch::new(dot(&self.vectors.direction, &self.vectors.residual));
        if at.trial.may_meet() || self.flies(at.system) {
            search = search.to_impact();
        }
        if self.dashpots.is_some() {
            search = search.no_further_than(1.0);
        }
        let slots = self.equations.slot_of.iter();
        let origin: Vec<f64> = slots.map(|&slot| self.q[slot as usize]).collect();
        search.run(|eta| {
            let from = origin.iter().zip(&self.vectors.direction);
            for ((q, d), &slot) in from.zip(&self.equations.slot_of) {
                self.q[slot as usize] = q + eta * d;
            }
            self.evaluate(at, setting)?;
            Ok(dot(&self.vectors.direction, &self.vectors.residual))
        })
    }

    /// Updates extrapolated solids implicitly at the converged displacements (docs/theory/equilibrium.md, eqs 14 and
    /// 21). Returns the largest true out-of-balance force and the root mean square of the force change caused by the
    /// update, both over the mean nodal force. The second value is the error of the extrapolation alone, without the
    /// residual that the tolerance allows.
    ///
    /// # Errors
    /// A local failure of a law.
    fn correct(
        &mut self,
        at: &mut Problem<'_>,
        increment: Increment,
    ) -> Result<(f64, f64), Rejection> {
        let setting = Evaluation {
            dt: increment.size * self.step.duration,
            solids: Solids::Implicit,
            shifted: self.shifted(),
            tangent: false,
            turning: Turning::Ignored,
        };
        let solved = at.trial.force.clone();
        let mut left = self.vectors.residual.clone();
        self.evaluate(at, setting)?;
        let scale = self.scale(at.system, at.state, at.trial);
        let (largest, _) = largest(&self.vectors.residual);
        for (left, r) in left.iter_mut().zip(&self.vectors.residual) {
            *left -= r;
        }
        // Reactions belong to the equilibrium that was solved.
        at.trial.force = solved;
        Ok((largest / scale, root_mean_square(&left) / scale))
    }
}

/// Number of first iterates whose tangent includes the softening of the solids. Later iterates, and all iterates
/// after a cut, use the secant stiffness. It converges more slowly but does not cycle where a unit snaps.
const SOFTENED: usize = 6;

/// Most iterations of a sub-increment of a relaxation.
const RELAXING: usize = 14;

/// Evaluation along a search direction: the histories of secant solids are held, their law is evaluated at the
/// accepted point.
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
