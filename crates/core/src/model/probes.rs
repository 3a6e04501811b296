//! Probes: displacements and velocities with a column in the history.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Mean motion of some nodes along an axis, less that of others: a column of the history.
///
/// Each node counts once in a mean. Motion is relative to the ground where that moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Name of the column.
    pub column: String,
    /// Nodes.
    pub nodes: Vec<u32>,
    /// Nodes whose mean motion is subtracted. Empty: the ground.
    pub minus: Vec<u32>,
    /// Axis, 0 to 2.
    pub axis: usize,
    /// 1, or −1 if motion against the axis counts as positive.
    pub sign: f64,
    /// Measured quantity.
    pub quantity: ProbeQuantity,
}

/// Quantity that a probe measures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum ProbeQuantity {
    /// Displacement [mm].
    #[default]
    Displacement,
    /// Velocity [mm/s], 0 in steps without inertia.
    Velocity,
}

impl ProbeQuantity {
    /// Ending of the names of its columns.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Displacement => "mm",
            Self::Velocity => "mm_per_s",
        }
    }
}
