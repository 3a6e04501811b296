//! `[[beams]]`: stiff beams on level faces, which turn freely or stay level.

use super::Names;
use crate::deck::quantity::{Density, Length};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

/// A loading beam: a nearly rigid block on level faces.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckBeam {
    /// Name of the beam and of its block.
    pub name: String,
    /// Level faces on which it lies.
    pub on: Names,
    /// Depth [mm]; a beam that turns is driven and pressed at half of it.
    pub depth: Length,
    /// Whether it turns.
    #[serde(default)]
    pub rotation: Turning,
    /// Interface between the beam and the faces on which it lies.
    pub interface: String,
    /// Density [tonne/mm³]; that of air if absent.
    pub density: Option<Density>,
}

/// Rotation of a beam.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Turning {
    /// It turns with the faces on which it lies.
    Free,
    /// It stays level.
    #[default]
    Level,
}
