//! Probes: displacements and velocities with a column in the history.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Mean motion of some nodes along a direction, less that of others: a column of the history.
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
    /// Direction in which motion counts as positive, of length 1. `[xyz]`
    pub direction: [f64; 3],
    /// Measured quantity.
    pub quantity: ProbeQuantity,
    /// Length by which the motion is divided: 1, or the difference in height of a drift [mm].
    pub over: f64,
}

impl Probe {
    /// Axes along which the direction has a component, with this component.
    pub fn components(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let all = self.direction.iter().copied().enumerate();
        all.filter(|(_, part)| *part != 0.0)
    }

    /// Nodes with their weights in the mean displacement that it measures. A node may come more than once: in a mirror
    /// half, for itself and for its image.
    pub fn weights(&self) -> impl Iterator<Item = (u32, f64)> + '_ {
        let sides = [(&self.nodes, 1.0), (&self.minus, -1.0)];
        sides.into_iter().flat_map(|(nodes, sign)| {
            let weight = sign / nodes.len() as f64;
            nodes.iter().map(move |n| (*n, weight))
        })
    }

    /// Derivatives of what a probe of displacements measures: node, axis, derivative by this displacement of the node.
    /// A node may come more than once.
    pub fn gradient(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        self.weights().flat_map(move |(n, weight)| {
            let all = self.components();
            all.map(move |(axis, along)| (n as usize, axis, along * weight))
        })
    }
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
    /// Displacement over the difference in height of both places [-].
    Drift,
}

impl ProbeQuantity {
    /// Ending of the names of its columns.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Displacement => "mm",
            Self::Velocity => "mm_per_s",
            Self::Drift => "drift",
        }
    }
}
