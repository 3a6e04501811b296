//! The iterates of a path: the load moves with the displacements (see [`crate::solve::stepping::path`]).

use super::line_search::{LineSearch, dot};
use super::newton::{Newton, along};
use super::outcome::Refusal;
use crate::assembly::{Evaluation, System, Trial};
use crate::model::scene::BeamMotion;
use crate::solve::stepping::path::Advance;
use crate::state::State;

impl Newton<'_> {
    /// How what is prescribed moves with the load [mm]. `[slot]`
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

    /// α c (s − c·Δq) of the stiffness along the displacement that steers the load, for the next solve (see
    /// [`crate::assembly::Steered`]).
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
        self.pull = slots.map(|&slot| pull * gradient[slot as usize]).collect();
    }

    /// d₁ = −K⁻¹ r and d₂ = −K⁻¹ ∂r/∂λ. Returns −∂r/∂λ [N]. `[equation]`
    pub(in crate::solve) fn solve_with_load(
        &mut self,
        system: &mut System,
        trial: &mut Trial,
    ) -> Result<Vec<f64>, Refusal> {
        let moved = system.multiply(trial, &self.prescribed_rate(system));
        let loads = self
            .loads
            .rate(self.step, system, self.load_factor, &trial.x);
        let pull = system.spring_pull(&self.step.springs);
        let slots = self.equations.slot_of.iter().map(|&slot| slot as usize);
        let force: Vec<f64> = slots
            .map(|slot| loads[slot] - moved[slot] - pull[slot])
            .collect();
        // That of the last iterate, or of none.
        let before = std::mem::replace(&mut self.by_load, force.clone());
        self.solve_both(system, trial, &before)?;
        Ok(force)
    }

    /// q ← q + η (d₁ + δλ d₂), λ ← λ + η δλ; leaves the forces there in `trial`. `force`: −∂r/∂λ [N]
    /// `[equation]`; `searches`: η by a line search, 1 without.
    #[expect(
        clippy::too_many_arguments,
        reason = "the increment, and how it is evaluated"
    )]
    pub(in crate::solve) fn follow(
        &mut self,
        system: &mut System,
        state: &State,
        trial: &mut Trial,
        setting: Evaluation,
        advance: Advance<'_>,
        force: &[f64],
        searches: bool,
    ) -> Result<(), Refusal> {
        let mut rate = self.prescribed_rate(system);
        let mut reached: Vec<f64> = self.q.iter().zip(&state.q).map(|(q, s)| q - s).collect();
        for (e, &slot) in self.equations.slot_of.iter().enumerate() {
            reached[slot as usize] += self.direction[e];
            rate[slot as usize] = self.by_load[e];
        }
        let change = advance
            .load_change(&reached, &rate)
            .ok_or(Refusal::NoSuchLoad)?;
        // Where nothing is searched there is nothing to go back to.
        let origin: Vec<f64> = if searches {
            let slots = self.equations.slot_of.iter();
            slots.map(|&slot| self.q[slot as usize]).collect()
        } else {
            Vec::new()
        };
        let from = self.load_factor;
        for (d, by_load) in self.direction.iter_mut().zip(&self.by_load) {
            *d += change * by_load;
        }
        let idle = if searches {
            self.idle(force)
        } else {
            Vec::new()
        };
        let search = LineSearch::new(dot(&idle, &self.residual)).no_further_than(1.0);
        let mut slope = |eta: f64| {
            for (e, &slot) in self.equations.slot_of.iter().enumerate() {
                let slot = slot as usize;
                self.q[slot] = if eta == 1.0 {
                    state.q[slot] + reached[slot] + change * rate[slot]
                } else {
                    origin[e] + eta * self.direction[e]
                };
            }
            self.load_to(from + eta * change, system, trial);
            self.evaluate(system, state, trial, along(setting))?;
            Ok(dot(&idle, &self.residual))
        };
        if searches {
            search.run(slope)
        } else {
            slope(1.0).map(drop)
        }
    }

    /// What is left of the direction without the part on which the loads do work [mm]: along it the
    /// out-of-balance forces have a slope that no load changes. With K d₂ = f it is
    /// v = d − (f·d)/(f·d₂) d₂, and v·r = −d·K d + (f·d)²/(f·d₂) ≤ 0 for a positive definite K.
    /// `[equation]`
    fn idle(&self, force: &[f64]) -> Vec<f64> {
        let share = dot(&self.direction, force) / dot(&self.by_load, force);
        let both = self.direction.iter().zip(&self.by_load);
        both.map(|(d, by_load)| d - share * by_load).collect()
    }
}
