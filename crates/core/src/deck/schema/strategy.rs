//! `strategy`, `[simplified]`: how much of a wall is modelled (theory/strategies.md).

use super::Subdivision;
use crate::deck::quantity::{FractureEnergy, Length, Number, Pressure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

/// Strategy with which a deck is modelled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Strategy {
    /// Units and mortar are solids that crack and crush, joined by interfaces.
    #[default]
    Detailed,
    /// Units that are expanded to the middle of their joints, with few elements. Interfaces without thickness open, slide
    /// and crush in place of the mortar.
    Simplified,
    /// Rigid-like units that are expanded to the middle of their joints, on interfaces with the stiffness of units and
    /// mortar.
    Rigid,
    /// Limit analysis of rigid units: a factor and a mechanism, without steps.
    Limit,
}

impl Strategy {
    /// All strategies, from the coarsest one.
    pub const ALL: [Self; 4] = [Self::Limit, Self::Rigid, Self::Simplified, Self::Detailed];

    /// Its name in a deck.
    pub fn name(self) -> &'static str {
        match self {
            Self::Detailed => "detailed",
            Self::Simplified => "simplified",
            Self::Rigid => "rigid",
            Self::Limit => "limit",
        }
    }

    /// Whether it is the default.
    pub(super) fn is_detailed(&self) -> bool {
        *self == Self::Detailed
    }
}

/// `[simplified]`: values of the strategies `simplified` and `rigid` that would otherwise follow from materials and
/// joints.
#[skip_serializing_none]
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[expect(
    non_snake_case,
    reason = "energy and weight are spelt in the deck as in the theory"
)]
pub struct DeckSimplified {
    /// Number of elements of an expanded unit along its length, height and thickness; [2, 1, 1] if absent, and
    /// [2, 1, 3] in walls that are bent out of their plane.
    pub mesh: Option<Subdivision>,
    /// Compressive strength of the masonry f_m [MPa].
    pub f_m: Option<Pressure>,
    /// Energy of crushing above the residual strength, for each joint G_fc [N/mm].
    pub G_fc: Option<FractureEnergy>,
    /// Plastic closing of a joint at the compressive strength κ_p [mm].
    pub kappa_p: Option<Length>,
    /// Weight of the shear traction in the cap C_ss [-].
    pub C_ss: Option<Number>,
    /// Whether units are elastic and crack by an interface in their middle, instead of by the law of their material;
    /// false if absent.
    pub unit_cracks: Option<bool>,
}
