//! What of a step's equations a checkpoint keeps.

use serde::{Deserialize, Serialize};

use crate::assembly::System;
use crate::solve::dynamics::integration::Motion;
use crate::solve::increment::newton::Newton;
use crate::solve::increment::traction_patterns::Pause;
use crate::solve::stepping::fallback::MethodChoice;
use crate::state::State;

/// What a step counts its loads and drives from.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct StepStart {
    /// Displacements when the step began [mm]. `[slot]`
    q: Vec<f64>,
    /// Ends of the springs then [mm]. `[spring][xyz]`
    spring_ends: Vec<[f64; 3]>,
    /// Forces on the beams then [N]. `[slot]`
    applied: Vec<f64>,
    /// Values of the loads with a name then. `[load]`
    loads: Vec<[f64; 3]>,
}

/// What the last commit left to the next increments.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CarriedOver {
    /// Out of balance [N]. `[equation]`
    left: Vec<f64>,
    /// When patterns of tractions are settled.
    pause: Pause,
}

impl Newton<'_> {
    /// What the step counts from.
    pub fn starts(&self) -> StepStart {
        StepStart {
            q: self.q_start.clone(),
            spring_ends: self.ends_start.clone(),
            applied: self.loads.applied_start.clone(),
            loads: self.loads.values_start.clone(),
        }
    }

    /// Counts from where the step once began; false if that was in another model.
    pub fn begin_from(&mut self, starts: StepStart) -> bool {
        let sizes = [starts.q.len(), starts.applied.len()];
        let fits = sizes == [self.q.len(); 2]
            && starts.spring_ends.len() == self.ends_start.len()
            && starts.loads.len() == self.loads.values.len();
        if !fits {
            return false;
        }
        (self.q_start, self.ends_start) = (starts.q, starts.spring_ends);
        self.loads.applied_start.clone_from(&starts.applied);
        self.loads_start.applied_start = starts.applied;
        self.loads.values_start.clone_from(&starts.loads);
        self.loads_start.values_start = starts.loads;
        true
    }

    /// What the last commit leaves to the next increments.
    pub fn carried(&self) -> CarriedOver {
        CarriedOver {
            left: self.left.clone(),
            pause: self.pause,
        }
    }

    /// Takes over what the last commit left; false if that was in another model.
    pub fn carry_on(&mut self, carried: CarriedOver) -> bool {
        if carried.left.len() != self.left.len() {
            return false;
        }
        (self.left, self.pause) = (carried.left, carried.pause);
        true
    }

    /// Goes on by the method, the tangents and the rate that led to `state`.
    pub fn rejoin(&mut self, choice: MethodChoice, slope: f64, system: &System, state: &State) {
        (self.method, self.tangent) = (choice.method, choice.tangent);
        self.slope = slope;
        self.motion = Motion::new(self.step, self.method, system, &self.equations, slope);
        if let Some(motion) = &mut self.motion {
            motion.rejoin(state);
        }
    }
}
