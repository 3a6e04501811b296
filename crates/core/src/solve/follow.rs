//! The iterates of a path: the load moves with the displacements (see [`super::path`]).

use super::newton::{Newton, along, timed};
use super::outcome::Refusal;
use super::path::Advance;
use super::state::State;
use crate::model::scene::BeamMotion;
use crate::system::{Evaluation, System, Trial};

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
    /// [`crate::system::Steered`]).
    pub(super) fn pull_along(&mut self, system: &System, state: &State, advance: Advance<'_>) {
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

    /// d₂ = −K⁻¹ ∂r/∂λ with the factors of the last solve.
    pub(super) fn solve_by_load(&mut self, system: &System, trial: &Trial) -> Result<(), Refusal> {
        let moved = system.multiply(trial, &self.prescribed_rate(system));
        let loads = self
            .loads
            .rate(self.step, system, self.load_factor, &trial.x);
        let pull = system.spring_pull(&self.step.springs);
        self.by_load.clear();
        let slots = self.equations.slot_of.iter().map(|&slot| slot as usize);
        self.by_load
            .extend(slots.map(|slot| loads[slot] - moved[slot] - pull[slot]));
        let Some(linear) = &mut self.linear else {
            return Ok(());
        };
        timed(&mut self.clock.solve, || linear.solve(&mut self.by_load))
            .map(|_| ())
            .map_err(|why| Refusal::Linear { why, dof: None })
    }

    /// q ← q + d₁ + δλ d₂, λ ← λ + δλ; leaves the forces there in `trial`.
    pub(super) fn follow(
        &mut self,
        system: &mut System,
        state: &State,
        trial: &mut Trial,
        setting: Evaluation,
        advance: Advance<'_>,
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
        for &slot in &self.equations.slot_of {
            let slot = slot as usize;
            self.q[slot] = state.q[slot] + reached[slot] + change * rate[slot];
        }
        self.load_to(self.load_factor + change, system, trial);
        self.evaluate(system, state, trial, along(setting))
    }
}
