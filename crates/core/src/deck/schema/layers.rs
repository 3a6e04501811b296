//! `[[layers]]`: membranes on faces of walls and blocks.

use super::Names;
use crate::deck::quantity::Length;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A layer of solid elements on plane faces, bonded to them by an interface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckLayer {
    /// Name of the layer and of its body.
    pub name: String,
    /// Faces of one plane that it covers.
    pub on: Names,
    /// Thickness [mm].
    pub thickness: Length,
    /// Material.
    pub material: String,
    /// Interface between the layer and the faces.
    pub interface: String,
    /// Length across each joint of the units over which the layer is not bonded [mm]; by default twice the length over
    /// which it takes over its force. At most 0.6 of the smallest edge of a unit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unbonded: Option<Length>,
}

/// Cells between planes normal to the axes, some of them empty: the body of a layer.
#[derive(Clone, Debug, PartialEq)]
pub struct Lattice {
    /// Positions of the planes [mm], ascending. `[xyz][plane]`
    pub lines: [Vec<f64>; 3],
    /// Whether there is an element, along x first, then y, then z. `[cell]`
    pub solid: Vec<bool>,
    /// Whether the element touches one unit, to which it is bonded. `[cell]`
    pub bonded: Vec<bool>,
    /// Face that touches the units, as an index into the six faces of a block.
    pub touching: usize,
}
