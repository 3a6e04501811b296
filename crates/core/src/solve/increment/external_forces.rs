//! External loads at one moment of a step: gravity, ground motion, forces on beams and named loads.

use crate::assembly::System;
use crate::model::scene::{BeamMotion, Step};
use crate::state::State;

/// External loads at a moment of a step.
#[derive(Clone, Debug)]
pub struct Loads {
    /// All loads of the unknowns [N]. `[slot]`
    pub total: Vec<f64>,
    /// Acceleration of the weights, less that of the ground, g − a [mm/s²].
    pub weights: [f64; 3],
    /// Gravity and ground motion alone, M (g − a) [N]. `[slot]`
    pub body: Vec<f64>,
    /// Mean magnitude of `body` over the nodes of the elements [N].
    pub mean: f64,
    /// Forces on the beams at the start of the step [N]. `[slot]`
    pub(in crate::solve) applied_start: Vec<f64>,
    /// Values of the named loads. `[load]`
    pub(in crate::solve) values: Vec<[f64; 3]>,
    /// The same at the start of the step. `[load]`
    pub(in crate::solve) values_start: Vec<[f64; 3]>,
    /// Nodal forces of the named loads [N] `[slot]`; empty in a model without them.
    pub(in crate::solve) named: Vec<f64>,
    /// All loads except follower pressures [N] `[slot]`; empty in a model without named loads.
    fixed: Vec<f64>,
    /// Named loads except follower pressures [N]. `[slot]`
    dead: Vec<f64>,
}

impl Loads {
    /// Zero loads of a step that begins at `state`.
    pub fn new(step: &Step, system: &System, state: &State) -> Self {
        let slots = system.dofs.slots;
        let mut loads = Self {
            total: vec![0.0; slots],
            weights: [0.0; 3],
            body: vec![0.0; slots],
            mean: 0.0,
            applied_start: state.applied.clone(),
            values: state.loads.clone(),
            values_start: state.loads.clone(),
            named: Vec::new(),
            fixed: Vec::new(),
            dead: Vec::new(),
        };
        loads.at(step, system, 0.0, 0.0);
        loads
    }

    /// Applies part `s` of the step's change of the loads, and the ground motion at part `time` of its time. Follower
    /// pressures are set by [`Self::follow`].
    pub fn at(&mut self, step: &Step, system: &System, s: f64, time: f64) {
        let (gravity, ground) = (step.gravity.at(s), step.ground.at(time * step.duration));
        let acceleration = [0, 1, 2].map(|i| gravity[i] - ground[i]);
        self.weights = acceleration;
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
        if system.outside.is_empty() {
            return;
        }
        for (l, value) in self.values.iter_mut().enumerate() {
            let from = self.values_start[l];
            *value = match step.loads.get(l) {
                Some(Some(to)) => [0, 1, 2].map(|i| from[i] + s * (to[i] - from[i])),
                _ => from,
            };
        }
        self.dead = system.dead_loads(&self.values);
        for (total, dead) in self.total.iter_mut().zip(&self.dead) {
            *total += dead;
        }
        self.fixed.clone_from(&self.total);
        self.named.clone_from(&self.dead);
    }

    /// Adds follower pressures on nodes at `x` [mm]. `[node]`
    pub fn follow(&mut self, system: &System, x: &[[f64; 3]]) {
        if system.outside.cells().is_empty() {
            return;
        }
        self.named = system.follower_loads(&self.values, x);
        for (slot, named) in self.named.iter_mut().enumerate() {
            self.total[slot] = self.fixed[slot] + *named;
            *named += self.dead[slot];
        }
    }

    /// Force on a slot from gravity, ground motion and named loads, without those that press or drive a beam [N].
    pub fn given(&self, slot: usize) -> f64 {
        self.named
            .get(slot)
            .map_or(self.body[slot], |named| self.body[slot] + named)
    }

    /// ∂F/∂s at part `s` of the step's loads, with the ground at rest and nodes at `x` [mm] [N]. `[slot]`
    pub fn rate(&self, step: &Step, system: &System, s: f64, x: &[[f64; 3]]) -> Vec<f64> {
        /// Difference of s. Gravity is linear in s or turns; the central difference then errs by H²/6.
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
        if !system.outside.is_empty() {
            let from = self.values_start.iter().enumerate();
            let change: Vec<[f64; 3]> = from
                .map(|(l, from)| match step.loads.get(l) {
                    Some(Some(to)) => [0, 1, 2].map(|i| to[i] - from[i]),
                    _ => [0.0; 3],
                })
                .collect();
            let (dead, turning) = (
                system.dead_loads(&change),
                system.follower_loads(&change, x),
            );
            for (rate, (dead, turning)) in rate.iter_mut().zip(dead.iter().zip(turning)) {
                *rate += dead + turning;
            }
        }
        rate
    }

    /// Work of gravity, ground motion and named loads over displacements `dq` [mm] `[slot]`, from the loads `start`
    /// to these, by the trapezoidal rule [N mm].
    pub fn work(&self, start: &Self, dq: &[f64]) -> f64 {
        let work = |a: &[f64], b: &[f64]| -> f64 {
            let forces = a.iter().zip(b);
            forces.zip(dq).map(|((a, b), dq)| 0.5 * (a + b) * dq).sum()
        };
        let bodies = work(&self.body, &start.body);
        if self.named.is_empty() {
            return bodies;
        }
        bodies + work(&self.named, &start.named)
    }
}
