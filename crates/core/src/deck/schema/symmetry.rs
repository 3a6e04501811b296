//! `[[symmetry]]`: planes of symmetry, of which one side is modelled.

use crate::deck::quantity::Length;
use crate::model::axis::Axis;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A plane of symmetry: one side of it is modelled, and walls are cut there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckSymmetry {
    /// Axis normal to the plane.
    pub normal: Axis,
    /// Position along this axis [mm].
    pub at: Length,
    /// Side that is modelled.
    #[serde(default)]
    pub keep: Keep,
}

/// A side of a plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Keep {
    /// The side of lower coordinates.
    #[default]
    Below,
    /// The side of higher coordinates.
    Above,
}
