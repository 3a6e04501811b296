//! History of a segment of a tie.

use serde::{Deserialize, Serialize};

/// History of a segment of a tie (theory/ties.md).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TieHistory {
    /// Change of the length over the length at rest [-].
    pub strain: f64,
    /// Stress [MPa].
    pub stress: f64,
    /// Strain that was given to it when it was stressed or installed [-].
    pub offset: f64,
    /// Plastic strain [-].
    pub plastic_strain: f64,
    /// Sum of the magnitudes of the plastic strains [-].
    pub yielded: f64,
    /// Whether it broke. It carries nothing from the next increment on.
    pub is_broken: bool,
}
