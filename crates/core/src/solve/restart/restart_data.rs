//! Data of a step's equations that a checkpoint keeps.

use serde::{Deserialize, Serialize};

use crate::assembly::System;
use crate::solve::dynamics::integration::Motion;
use crate::solve::increment::newton::Newton;
use crate::solve::increment::traction_patterns::Pause;
use crate::solve::stepping::fallback::MethodChoice;
use crate::state::State;

/// State at the start of a step, to which its loads and drives refer.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StepStart {
    /// Displacements [mm]. `[slot]`
    q: Vec<f64>,
    /// Positions of the spring ends [mm]. `[spring][xyz]`
    spring_ends: Vec<[f64; 3]>,
    /// Forces on the beams [N]. `[slot]`
    applied: Vec<f64>,
    /// Values of the named loads. `[load]`
    loads: Vec<[f64; 3]>,
}

/// Data of the last commit that the next increments need.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CarriedOver {
    /// Out-of-balance forces [N]. `[equation]`
    left: Vec<f64>,
    /// Increments in which traction patterns are not settled.
    pause: Pause,
    /// Number of further increments with a loosened tolerance.
    loosened: u32,
}

impl Newton<'_> {
    /// State at the start of the step.
    pub fn starts(&self) -> StepStart {
        StepStart {
            q: self.q_start.clone(),
            spring_ends: self.loading.ends_start.clone(),
            applied: self.loading.loads.applied_start.clone(),
            loads: self.loading.loads.values_start.clone(),
        }
    }

    /// Takes over the state at the start of the step; false if it belongs to another model.
    pub fn begin_from(&mut self, starts: StepStart) -> bool {
        let sizes = [starts.q.len(), starts.applied.len()];
        let fits = sizes == [self.q.len(); 2]
            && starts.spring_ends.len() == self.loading.ends_start.len()
            && starts.loads.len() == self.loading.loads.values.len();
        if !fits {
            return false;
        }
        (self.q_start, self.loading.ends_start) = (starts.q, starts.spring_ends);
        self.loading.loads.applied_start.clone_from(&starts.applied);
        self.loading.loads_start.applied_start = starts.applied;
        self.loading.loads.values_start.clone_from(&starts.loads);
        self.loading.loads_start.values_start = starts.loads;
        true
    }

    /// Data of the last commit that the next increments need.
    pub fn carried(&self) -> CarriedOver {
        CarriedOver {
            left: self.vectors.left.clone(),
            pause: self.pause,
            loosened: self.scales.loosened,
        }
    }

    /// Takes over the data of the last commit; false if they belong to another model.
    pub fn carry_on(&mut self, carried: CarriedOver) -> bool {
        if carried.left.len() != self.vectors.left.len() {
            return false;
        }
        (self.vectors.left, self.pause) = (carried.left, carried.pause);
        self.scales.loosened = carried.loosened;
        true
    }

    /// Continues with the method, tangents and rate that led to `state`.
    pub fn rejoin(&mut self, choice: MethodChoice, slope: f64, system: &System, state: &State) {
        self.choice = choice;
        self.loading.slope = slope;
        self.motion = Motion::new(self.step, choice.method, system, &self.equations, slope);
        if let Some(motion) = &mut self.motion {
            motion.rejoin(state);
        }
    }
}
