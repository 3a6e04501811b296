//! `[[beams]]`: stiff beams on level faces, which turn freely or stay level.

use super::Names;
use crate::deck::quantity::{Density, Length};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A loading beam: a block as stiff as can be told from rigid, on level faces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckBeam {
    /// Name, of the block that it is, too.
    pub name: String,
    /// Level faces that it lies on.
    pub on: Names,
    /// Its depth [mm]; a beam that turns is driven and pressed at half of it.
    pub depth: Length,
    /// Whether it turns.
    #[serde(default)]
    pub rotation: Turning,
    /// Interface between it and what it lies on.
    pub interface: String,
    /// Its density [tonne/mm³]; as light as air if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub density: Option<Density>,
}

/// What a beam may do beside moving.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Turning {
    /// It turns as what it lies on does.
    Free,
    /// It stays level.
    #[default]
    Level,
}
