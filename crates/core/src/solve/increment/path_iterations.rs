//! Iterations along a path: the load factor is an unknown (docs/theory/procedures.md, eqs 1 to 7; see
//! [`crate::solve::stepping::path`]).

use super::line_search::{LineSearch, dot};
use super::newton::{Newton, along};
use super::outcome::{Problem, Rejection};
use crate::assembly::{Evaluation, System, Trial};
use crate::model::scene::BeamMotion;
use crate::solve::stepping::path::Advance;
use crate::state::State;

impl Newton<'_> {
    /// ∂q/∂λ of the prescribed displacements [mm]. `[slot]`
    fn prescribed_rate(&self, system: &System) -> Vec<f64> {
        let mut rate = vec![0.0; system.dofs.slots];
        for (b, motion) in self.step.motion.iter().enumerate() {
            for (i, motion) in motion.iter().enumerate() {
                if let BeamMotion::Driven(by) = *motion {
                    rate[system.dofs.beam_slot(b, i)] = by;
                }
            }
        }
        rate
    }

    /// Sets the force α c (s − c·Δq) of the stiffness along the displacement that steers the load, for the next solve
    /// (docs/theory/procedures.md, eq. 6; [`crate::assembly::Steered`]).
    pub(in crate::solve) fn pull_along(
        &mut self,
        system: &System,
        state: &State,
        advance: Advance<'_>,
    ) {
        let (Some(steered), Advance::Along { gradient, by }) = (&system.steered, advance) else {
            return;
        };
        let ways = self.q.iter().zip(&state.q);
        let gone: f64 = gradient
            .iter()
            .zip(ways)
            .map(|(c, (q, s))| c * (q - s))
            .sum();
        let pull = steered.stiffness * (by - gone);
        let slots = self.equations.slot_of.iter();
        self.vectors.pull = slots.map(|&slot| pull * gradient[slot as usize]).collect();
    }

    /// Solves d₁ = −K⁻¹ r and d₂ = −K⁻¹ ∂r/∂λ. Returns −∂r/∂λ [N]. `[equation]`
    pub(in crate::solve) fn solve_with_load(
        &mut self,
        system: &mut System,
        trial: &mut Trial,
    ) -> Result<Vec<f64>, Rejection> {
        let moved = system.multiply(trial, &self.prescribed_rate(system));
        let loads = self
            .loading
            .loads
            .rate(self.step, system, self.loading.factor, &trial.x);
        let pull = system.spring_pull(&self.step.springs);
        let jacked = system.tie_pull(trial, &self.step.ties);
        let slots = self.equations.slot_of.iter().map(|&slot| slot as usize);
        let force: Vec<f64> = slots
            .map(|slot| loads[slot] - moved[slot] - pull[slot] - jacked[slot])
            .collect();
        // d₂ of the last iterate, or empty, as a first guess.
        let before = std::mem::replace(&mut self.vectors.by_load, force.clone());
        self.solve_both(system, trial, &before)?;
        Ok(force)
    }

    /// q ← q + η (d₁ + δλ d₂), λ ← λ + η δλ; leaves the forces there in `trial`. `force`: −∂r/∂λ [N] `[equation]`;
    /// `searches`: whether a line search finds η, else η = 1.
    pub(in crate::solve) fn follow(
        &mut self,
        at: &mut Problem<'_>,
        setting: Evaluation,
        force: &[f64],
        searches: bool,
    ) -> Result<(), Rejection> {
        let mut rate = self.prescribed_rate(at.system);
        let mut reached: Vec<f64> = self.q.iter().zip(&at.state.q).map(|(q, s)| q - s).collect();
        for (e, &slot) in self.equations.slot_of.iter().enumerate() {
            reached[slot as usize] += self.vectors.direction[e];
            rate[slot as usize] = self.vectors.by_load[e];
        }
        let change = at
            .attempt
            .advance
            .load_change(&reached, &rate)
            .ok_or(Rejection::NoSuchLoad)?;
        // Without a line search there is no return to the origin.
        let origin: Vec<f64> = if searches {
            let slots = self.equations.slot_of.iter();
            slots.map(|&slot| self.q[slot as usize]).collect()
        } else {
            Vec::new()
        };
        let from = self.loading.factor;
        for (d, by_load) in self.vectors.direction.iter_mut().zip(&self.vectors.by_load) {
            *d += change * by_load;
        }
        let idle = if searches {
            self.idle(force)
        } else {
            Vec::new()
        };
        let search = LineSearch::new(dot(&idle, &self.vectors.residual)).no_further_than(1.0);
        let mut slope = |eta: f64| {
            for (e, &slot) in self.equations.slot_of.iter().enumerate() {
                let slot = slot as usize;
                self.q[slot] = if eta == 1.0 {
                    at.state.q[slot] + reached[slot] + change * rate[slot]
                } else {
                    origin[e] + eta * self.vectors.direction[e]
                };
            }
            self.load_to(from + eta * change, at.system, at.trial);
            self.evaluate(at, along(setting))?;
            Ok(dot(&idle, &self.vectors.residual))
        };
        if searches {
            search.run(slope)
        } else {
            slope(1.0).map(drop)
        }
    }

    /// v = d − (f·d)/(f·d₂) d₂, the direction without the part along which the loads do work [mm] `[equation]`
    /// (docs/theory/procedures.md, eq. 7). Along v the slope of the out-of-balance forces does not depend on the
    /// load. With K d₂ = f, v·r = −d·K d + (f·d)²/(f·d₂) ≤ 0 for a positive definite K.
    fn idle(&self, force: &[f64]) -> Vec<f64> {
        let share = dot(&self.vectors.direction, force) / dot(&self.vectors.by_load, force);
        let both = self.vectors.direction.iter().zip(&self.vectors.by_load);
        both.map(|(d, by_load)| d - share * by_load).collect()
    }
}
