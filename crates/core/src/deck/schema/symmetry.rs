//! `[[symmetry]]`: planes of symmetry, of which one side is modelled.

use crate::deck::quantity::Length;
use crate::model::axis::Axis;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A plane that mirrors the scene: what lies on one side of it is modelled, walls are cut there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckSymmetry {
    /// Axis normal to the plane.
    pub normal: Axis,
    /// Where it lies along this axis [mm].
    pub at: Length,
    /// Which side of it is modelled.
    #[serde(default)]
    pub keep: Keep,
}

/// A side of a plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Keep {
    /// What has lower coordinates.
    #[default]
    Below,
    /// What has higher coordinates.
    Above,
}
