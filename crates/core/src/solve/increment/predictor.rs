//! Predictor: the start of the iterations of an increment (docs/theory/equilibrium.md, eqs 12 and 13).

use super::newton::{Newton, timed};
use super::outcome::{Attempt, Problem, Rejection};
use crate::assembly::{Evaluation, STIFFEST_UNDER_LOADS};
use crate::solve::stepping::path::Advance;
use crate::state::{LastIncrement, State};

/// Least ratio of the numerical stiffness of interfaces to the inertia against their gaps. In small increments gaps
/// hardly move, and the tractions would converge by the factor 1 − k'/k only.
const OVER_INERTIA: f64 = 3.0;

impl Newton<'_> {
    /// Sets the start of the iterations: a repetition of the last increment, or a tangent solve with the prescribed
    /// displacements on the right-hand side.
    pub(in crate::solve) fn predict(
        &mut self,
        at: &mut Problem<'_>,
        setting: Evaluation,
    ) -> Result<(), Rejection> {
        at.system.start(self.model, at.trial, at.state);
        if self.step.loads.iter().any(Option::is_some) {
            at.trial.shift.stiffest = STIFFEST_UNDER_LOADS;
        }
        self.q.copy_from_slice(&at.state.q);
        self.linear_forces = None;
        let last = at.state.last.as_ref().filter(|_| at.attempt.repeat);
        let dt = self.extrapolated_time(&at.attempt, last);
        let end = match (at.attempt.advance, last) {
            (Advance::Load, _) => at.attempt.load_end,
            (_, Some(last)) => at.attempt.load + dt / last.dt * last.load,
            (_, None) => at.attempt.load,
        };
        self.load(at, setting, end);
        if let (Some(last), true) = (last, setting.shifted) {
            let ratio = self.traction_extrapolation(&at.state.energies) * dt / last.dt;
            (at.system).extrapolate_tractions(self.model, at.state, at.trial, ratio);
        }
        // With inertia, motion continues; a tangent would make sliding points stick.
        if let Some(motion) = &self.motion {
            motion.predict(at.state, &mut self.q);
            return Ok(());
        }
        if let Some(last) = last {
            let ratio = dt / last.dt;
            for &slot in &self.equations.slot_of {
                self.q[slot as usize] += ratio * last.dq[slot as usize];
            }
            self.anchor(at.state);
            return Ok(());
        }
        if at.attempt.advance != Advance::Load {
            self.anchor(at.state);
            return Ok(());
        }
        self.start_by_tangent(at, setting)
    }

    /// Time over which the last increment is extrapolated [s].
    fn extrapolated_time(&self, attempt: &Attempt<'_>, last: Option<&LastIncrement>) -> f64 {
        match self.dashpots.as_ref().filter(|dashpots| !dashpots.loads) {
            // Pseudo-time of a relaxation; at most twice the last one.
            Some(dashpots) => {
                let before = last.map_or(f64::INFINITY, |last| last.dt);
                (1.0 / dashpots.factor).min(2.0 * before)
            }
            None => attempt.increment.size * self.step.duration,
        }
    }

    /// Sets the loads at the start of the increment and at its end, at part `end` of the step's loads.
    fn load(&mut self, at: &mut Problem<'_>, setting: Evaluation, end: f64) {
        let (increment, start) = (at.attempt.increment, at.attempt.load);
        self.loading.moment = increment.end();
        let loads_start = &mut self.loading.loads_start;
        loads_start.at(self.step, at.system, start, increment.start);
        loads_start.follow(at.system, &at.trial.x);
        if self.motion.is_none() {
            // A weight that the step turns at once acts on a body at rest as if it turned within the increment.
            let weights = at.state.weights;
            at.system.mass.forces(weights, &mut loads_start.body);
        }
        self.load_to(end, at.system, at.trial);
        if let Some(motion) = &mut self.motion {
            motion.start(at.state, setting.dt, &self.loading.loads_start.total);
            at.trial.inertia = OVER_INERTIA * motion.mass_factor();
        }
    }

    /// Starts from a tangent solve with the prescribed displacements on the right-hand side.
    fn start_by_tangent(
        &mut self,
        at: &mut Problem<'_>,
        setting: Evaluation,
    ) -> Result<(), Rejection> {
        let target = std::mem::replace(&mut self.q, at.state.q.clone());
        self.anchor(at.state);
        timed(&mut self.clock.contact, || {
            at.system.search(at.trial, &self.q);
        });
        // At the start of a step the direction of slip is unknown, because a drive may reverse.
        at.trial.shift.sticks = at.state.last.is_none();
        let evaluated = self.evaluate(at, setting);
        at.trial.shift.sticks = false;
        evaluated?;
        // The forces K_fp Δp of the prescribed displacements are added to the residual.
        let change: Vec<f64> = target.iter().zip(&self.q).map(|(t, q)| t - q).collect();
        let moved = at.system.multiply(at.trial, &change);
        let residual = self.vectors.residual.iter_mut();
        for (r, &slot) in residual.zip(&self.equations.slot_of) {
            *r += moved[slot as usize];
        }
        self.solve(at.system, at.trial)?;
        at.solves.one_more();
        self.q = target;
        if self.flies(at.system) {
            // A body without support would pass through the one that it is pressed on; the line search finds the
            // contact.
            return Ok(());
        }
        for (d, &slot) in self.vectors.direction.iter().zip(&self.equations.slot_of) {
            self.q[slot as usize] += d;
        }
        if self.step.increments.peak < 1.0 {
            let way = self.q.iter().zip(&at.state.q).map(|(q, s)| q - s);
            self.linear_forces = Some(at.system.multiply(at.trial, &way.collect::<Vec<_>>()));
        }
        self.anchor(at.state);
        let loads = &self.loading.loads;
        let pressed = loads.mean > 0.0 || loads.values.iter().any(|v| *v != [0.0; 3]);
        if pressed && setting.shifted {
            // Weight, or another load, closes joints that were without pressure. They need the pressure of this
            // start: without it they would have no friction in the next iterate.
            timed(&mut self.clock.contact, || {
                at.system.search(at.trial, &self.q);
            });
            let start = Evaluation {
                tangent: false,
                ..setting
            };
            self.evaluate(at, start)?;
            at.trial.keep_tractions();
        }
        Ok(())
    }

    /// Anchors the dashpots of a relaxation: at the present start while loads grow, else at the last commit.
    fn anchor(&mut self, state: &State) {
        if let Some(dashpots) = &mut self.dashpots {
            let q = if dashpots.loads { &self.q } else { &state.q };
            dashpots.anchor_at(q);
        }
    }
}
