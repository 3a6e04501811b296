//! How the steps of a deck are solved, and what they say of inertia.

use crate::deck::quantity::{Frequency, Length, Number, Time};
use crate::model::scene::{Procedure, Rayleigh};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// `procedure` of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DeckProcedure {
    /// The cheapest that finds equilibrium, from increment to increment.
    #[default]
    Auto,
    /// Newton's method; the duration has no meaning but for viscosity.
    Static,
    /// Solids extrapolated within the increment.
    Implex,
    /// Inertia by backward Euler: it carries a wall over a snap and takes the motion out.
    QuasiStatic,
    /// HHT-α.
    Dynamic,
    /// Arc length: the load is an unknown.
    ArcLength,
    /// Dissipated energy: the load is an unknown.
    Dissipation,
    /// A displacement steers the load.
    DisplacementControl,
}

/// `control` of a step: a displacement that steers the load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckControl {
    /// The probe that measures it.
    pub probe: String,
    /// How far it goes during the step [mm].
    pub displacement: Length,
}

/// `stop` of a driven step: what ends it before its displacement is whole.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DeckStop {
    /// The force falls to this part of the largest of the step [-].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub below_peak: Option<Number>,
    /// The step has driven this far [mm].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub displacement: Option<Length>,
}

/// `rayleigh` of a dynamic step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DeckRayleigh {
    /// Factor of the masses [1/s].
    pub mass: Frequency,
    /// Factor of the elastic stiffness of the solids [s].
    pub stiffness: Time,
}

/// `ground` of a step: a record of acceleration a direction.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DeckGround {
    /// File with the acceleration along the wall.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub x: Option<String>,
    /// Through the wall.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub y: Option<String>,
    /// Upwards.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z: Option<String>,
}

/// `ground_factor` of a step: by what the records are multiplied.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DeckGroundFactor {
    /// That of the record along the wall.
    pub x: Number,
    /// Through the wall.
    pub y: Number,
    /// Upwards.
    pub z: Number,
}

impl Default for DeckGroundFactor {
    fn default() -> Self {
        let one = Number::new(1.0);
        Self {
            x: one,
            y: one,
            z: one,
        }
    }
}

/// α where the deck says none: enough to quiet what the increments do not resolve, 0.1 % of damping
/// at ten increments a period.
const ALPHA: f64 = -0.05;

impl DeckProcedure {
    /// The procedure of the model with these keys.
    pub fn with(self, alpha: Option<Number>, rayleigh: Option<DeckRayleigh>) -> Procedure {
        let rayleigh = rayleigh.unwrap_or_default();
        match self {
            Self::Auto => Procedure::Auto,
            Self::Static => Procedure::Static,
            Self::Implex => Procedure::Implex,
            Self::QuasiStatic => Procedure::QuasiStatic,
            Self::Dynamic => Procedure::Dynamic {
                alpha: alpha.map_or(ALPHA, Number::get),
                damping: Rayleigh {
                    mass: rayleigh.mass.get(),
                    stiffness: rayleigh.stiffness.get(),
                },
            },
            Self::ArcLength => Procedure::ArcLength,
            Self::Dissipation => Procedure::Dissipation,
            Self::DisplacementControl => Procedure::DisplacementControl,
        }
    }
}

impl DeckGround {
    /// The files. `[xyz]`
    pub fn files(&self) -> [Option<&str>; 3] {
        [&self.x, &self.y, &self.z].map(Option::as_deref)
    }
}
