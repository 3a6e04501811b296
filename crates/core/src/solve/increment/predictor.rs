//! Predictor: the start of the iterations of an increment (docs/theory/equilibrium.md, eqs 12 and 13).

use super::newton::{Newton, timed};
use super::outcome::{Attempt, Rejection, Solves};
use crate::assembly::{Evaluation, STIFFEST_UNDER_LOADS, System, Trial};
use crate::solve::stepping::path::Advance;
use crate::state::State;

/// Least ratio of the numerical stiffness of interfaces to the inertia against their gaps. In small increments gaps
/// hardly move, and the tractions would converge by the factor 1 − k'/k only.
const OVER_INERTIA: f64 = 3.0;

impl Newton<'_> {
    /// Sets the start of the iterations: a repetition of the last increment, or a tangent solve with the prescribed
    /// displacements on the right-hand side.
    pub(in crate::solve) fn predict(
        &mut self,
        system: &mut System,
        state: &State,
        trial: &mut Trial,
        attempt: Attempt,
        setting: Evaluation,
        solves: &mut Solves,
    ) -> Result<(), Rejection> {
        system.start(self.model, trial, state);
        if self.step.loads.iter().any(Option::is_some) {
            trial.shift.stiffest = STIFFEST_UNDER_LOADS;
        }
        self.q.copy_from_slice(&state.q);
        self.linear_forces = None;
        let last = state.last.as_ref().filter(|_| attempt.repeat);
        let start = attempt.load;
        // Time over which the last increment is extrapolated.
        let pseudo_time = self.dashpots.as_ref().filter(|dashpots| !dashpots.loads);
        let dt = match pseudo_time {
            // At most twice the last one.
            Some(dashpots) => {
                let before = last.map_or(f64::INFINITY, |last| last.dt);
                (1.0 / dashpots.factor).min(2.0 * before)
            }
            None => attempt.increment.size * self.step.duration,
        };
        let end = match (attempt.advance, last) {
            (Advance::Load, _) => attempt.load_end,
            (_, Some(last)) => start + dt / last.dt * last.load,
            (_, None) => start,
        };
        self.loading.moment = attempt.increment.end();
        let begin = attempt.increment.start;
        self.loading.loads_start.at(self.step, system, start, begin);
        self.loading.loads_start.follow(system, &trial.x);
        self.load_to(end, system, trial);
        if let Some(motion) = &mut self.motion {
            motion.start(state, setting.dt, &self.loading.loads_start.total);
            trial.inertia = OVER_INERTIA * motion.mass_factor();
        }
        if let (Some(last), true) = (last, setting.shifted) {
            let ratio = self.momentum(&state.energies) * dt / last.dt;
            system.extrapolate_tractions(self.model, state, trial, ratio);
        }
        // With inertia, motion continues; a tangent would make sliding points stick.
        if let Some(motion) = &self.motion {
            motion.predict(state, &mut self.q);
            return Ok(());
        }
        if let Some(last) = last {
            let ratio = dt / last.dt;
            for &slot in &self.equations.slot_of {
                self.q[slot as usize] += ratio * last.dq[slot as usize];
            }
            self.anchor(state);
            return Ok(());
        }
        if attempt.advance != Advance::Load {
            self.anchor(state);
            return Ok(());
        }
        let target = std::mem::replace(&mut self.q, state.q.clone());
        self.anchor(state);
        timed(&mut self.clock.contact, || system.search(trial, &self.q));
        // At the start of a step the direction of slip is unknown, because a drive may reverse.
        trial.shift.sticks = state.last.is_none();
        let evaluated = self.evaluate(system, state, trial, setting);
        trial.shift.sticks = false;
        evaluated?;
        // The forces K_fp Δp of the prescribed displacements are added to the residual.
        let change: Vec<f64> = target.iter().zip(&self.q).map(|(t, q)| t - q).collect();
        let moved = system.multiply(trial, &change);
        for (r, &slot) in self
            .vectors
            .residual
            .iter_mut()
            .zip(&self.equations.slot_of)
        {
            *r += moved[slot as usize];
        }
        self.solve(system, trial)?;
        solves.one_more();
        self.q = target;
        if self.flies(system) {
            // A body without support would pass through the one that it is pressed on; the line search finds the
            // contact.
            return Ok(());
        }
        for (d, &slot) in self.vectors.direction.iter().zip(&self.equations.slot_of) {
            self.q[slot as usize] += d;
        }
        if self.step.increments.peak < 1.0 {
            let way: Vec<f64> = self.q.iter().zip(&state.q).map(|(q, s)| q - s).collect();
            self.linear_forces = Some(system.multiply(trial, &way));
        }
        self.anchor(state);
        let pressed = self.loading.loads.mean > 0.0
            || self.loading.loads.values.iter().any(|v| *v != [0.0; 3]);
        if pressed && setting.shifted {
            // Weight, or another load, closes joints that were without pressure. They need the pressure of this
            // start: without it they would have no friction in the next iterate.
            timed(&mut self.clock.contact, || system.search(trial, &self.q));
            let start = Evaluation {
                tangent: false,
                ..setting
            };
            self.evaluate(system, state, trial, start)?;
            trial.keep_tractions();
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
