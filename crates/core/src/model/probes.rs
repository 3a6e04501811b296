//! Probes: places whose motion is a column of the history.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Motion of some nodes along an axis, less that of others: a column of the history.
///
/// A place moves as its nodes do on the mean, each counted once. Relative to the ground where that
/// moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Name of the column.
    pub column: String,
    /// Nodes.
    pub nodes: Vec<u32>,
    /// Nodes whose motion is taken off; empty = the ground.
    pub minus: Vec<u32>,
    /// Axis, 0 to 2.
    pub axis: usize,
    /// 1, or −1 if the other way counts as positive.
    pub sign: f64,
    /// What is followed.
    pub quantity: ProbeQuantity,
}

/// What a probe follows.
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
    /// What ends the names of its columns.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Displacement => "mm",
            Self::Velocity => "mm_per_s",
        }
    }
}
