//! Forces from outside at one fraction of a step: gravity, the ground, and what presses the beams.

use super::state::State;
use crate::model::scene::{BeamMotion, Step};
use crate::system::System;

/// Loads at a fraction of a step.
#[derive(Clone, Debug)]
pub struct Loads {
    /// All loads of the unknowns [N]. `[slot]`
    pub total: Vec<f64>,
    /// Gravity and the ground alone: M (g − a) [N]. `[slot]`
    pub body: Vec<f64>,
    /// Mean magnitude of these over the elements' nodes [N].
    pub mean: f64,
    /// Forces on the beams when the step began [N]. `[slot]`
    pub(super) applied_start: Vec<f64>,
}

impl Loads {
    /// No loads yet, in a step that begins at `state`.
    pub fn new(step: &Step, system: &System, state: &State) -> Self {
        let slots = system.dofs.slots;
        let mut loads = Self {
            total: vec![0.0; slots],
            body: vec![0.0; slots],
            mean: 0.0,
            applied_start: state.applied.clone(),
        };
        loads.at(step, system, 0.0);
        loads
    }

    /// Takes the loads at fraction `s` of the step.
    pub fn at(&mut self, step: &Step, system: &System, s: f64) {
        let (gravity, ground) = (step.gravity.at(s), step.ground.at(s * step.duration));
        let acceleration = [0, 1, 2].map(|i| gravity[i] - ground[i]);
        system.mass.forces(acceleration, &mut self.body);
        let slots = 0..self.body.len();
        self.mean = system
            .mass
            .mean_force(slots.map(|slot| system.mass.along(slot, acceleration)));
        self.total.copy_from_slice(&self.body);
        for (b, motion) in step.motion.iter().enumerate() {
            for (i, motion) in motion.iter().enumerate() {
                if let BeamMotion::Force(to) = *motion {
                    let slot = system.dofs.beam_slot(b, i);
                    let from = self.applied_start[slot];
                    self.total[slot] += from + s * (to - from);
                }
            }
        }
    }

    /// ∂F/∂s at fraction `s` of the step, the ground at rest [N]. `[slot]`
    pub fn rate(&self, step: &Step, system: &System, s: f64) -> Vec<f64> {
        /// Gravity is linear in s, or turns: the central difference errs by h²/6.
        const H: f64 = 1e-4;
        let (ahead, behind) = (step.gravity.at(s + H), step.gravity.at(s - H));
        let mut rate = vec![0.0; self.total.len()];
        let change = [0, 1, 2].map(|i| (ahead[i] - behind[i]) / (2.0 * H));
        system.mass.forces(change, &mut rate);
        for (b, motion) in step.motion.iter().enumerate() {
            for (i, motion) in motion.iter().enumerate() {
                if let BeamMotion::Force(to) = *motion {
                    let slot = system.dofs.beam_slot(b, i);
                    rate[slot] += to - self.applied_start[slot];
                }
            }
        }
        rate
    }

    /// Work of gravity and the ground over displacements `dq` [mm] `[slot]` from the loads `start`
    /// to these, by the trapezoidal rule [N mm].
    pub fn work_of_bodies(&self, start: &Self, dq: &[f64]) -> f64 {
        let forces = self.body.iter().zip(&start.body);
        forces.zip(dq).map(|((a, b), dq)| 0.5 * (a + b) * dq).sum()
    }
}
