//! What the steps of a deck say of inertia.

use crate::model::quantity::{Frequency, Number, Time};
use crate::model::scene::{Dynamics, Rayleigh};
use serde::{Deserialize, Serialize};

/// `dynamics` of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DeckDynamics {
    /// Equilibrium; the duration has no meaning but for viscosity.
    #[default]
    Static,
    /// Inertia by backward Euler: it carries a wall over a snap and takes the motion out.
    QuasiStatic,
    /// HHT-α.
    Dynamic,
}

/// `rayleigh` of a dynamic step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DeckRayleigh {
    /// Factor of the masses [1/s].
    pub mass: Frequency,
    /// Factor of the elastic stiffness of the solids [s].
    pub stiffness: Time,
}

/// `ground` of a step: a record of acceleration a direction.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
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

/// α where the deck says none: enough to quiet what the increments do not resolve, 0.1 % of damping
/// at ten increments a period.
const ALPHA: f64 = -0.05;

impl DeckDynamics {
    /// The dynamics of the model with these keys.
    pub fn with(self, alpha: Option<Number>, rayleigh: Option<DeckRayleigh>) -> Dynamics {
        let rayleigh = rayleigh.unwrap_or_default();
        match self {
            Self::Static => Dynamics::Static,
            Self::QuasiStatic => Dynamics::QuasiStatic,
            Self::Dynamic => Dynamics::Dynamic {
                alpha: alpha.map_or(ALPHA, Number::get),
                damping: Rayleigh {
                    mass: rayleigh.mass.get(),
                    stiffness: rayleigh.stiffness.get(),
                },
            },
        }
    }
}

impl DeckGround {
    /// The files. `[xyz]`
    pub fn files(&self) -> [Option<&str>; 3] {
        [&self.x, &self.y, &self.z].map(Option::as_deref)
    }
}
