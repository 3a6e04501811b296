//! Ties of one increment.

use crate::assembly::ties::TieResponse;
use crate::model::ties::TieStage;

/// Ties: what a step does with them, and their segments.
#[derive(Clone, Debug, Default)]
pub struct TrialTies {
    /// Stages at the present load. Empty: all carry their law. `[tie]`
    pub stages: Vec<TieStage>,
    /// Segments at the last evaluation. `[segment]`
    pub segments: Vec<TieResponse>,
}

impl TrialTies {
    /// Sum of a quantity over the segments.
    pub fn sum(&self, of: impl Fn(&TieResponse) -> f64) -> f64 {
        self.segments.iter().map(of).sum()
    }
}
