//! Procedures of steps, and their keys of inertia.

use crate::deck::quantity::{Frequency, Length, Number, Time};
use crate::model::scene::{Procedure, Rayleigh};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

/// `procedure` of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DeckProcedure {
    /// The cheapest procedure that finds equilibrium, chosen in each increment.
    #[default]
    Auto,
    /// Newton's method; the duration matters for viscosity only.
    Static,
    /// Static, with extrapolated solids.
    Implex,
    /// Inertia by backward Euler: it carries a wall over a snap and damps the motion.
    QuasiStatic,
    /// Dynamics by HHT-α.
    Dynamic,
    /// Arc length: the load factor is an unknown.
    ArcLength,
    /// Dissipated energy: the load factor is an unknown.
    Dissipation,
    /// A prescribed displacement; the load factor is an unknown.
    DisplacementControl,
}

/// `control` of a step: the displacement that controls the load.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckControl {
    /// Probe that measures it.
    pub probe: String,
    /// Displacement during the step [mm].
    pub displacement: Length,
}

/// `stop` of a step that drives or loads: conditions that end it before its full displacement or load.
#[skip_serializing_none]
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DeckStop {
    /// The force falls to this fraction of the largest one of the step [-].
    pub below_peak: Option<Number>,
    /// The step has driven this distance [mm].
    pub displacement: Option<Length>,
}

/// `rayleigh` of a dynamic step: its two factors, or a damping ratio at two frequencies.
#[skip_serializing_none]
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DeckRayleigh {
    /// Factor of the mass matrix [1/s].
    pub mass: Option<Frequency>,
    /// Factor of the elastic stiffness of the solids [s].
    pub stiffness: Option<Time>,
    /// Damping ratio at the two `frequencies` [-].
    pub ratio: Option<Number>,
    /// Frequencies of vibration at which the damping has this `ratio` [Hz].
    pub frequencies: Option<[Frequency; 2]>,
}

impl DeckRayleigh {
    /// The factors of mass and stiffness (docs/theory/inertia.md, eq. 13).
    pub fn factors(self) -> Rayleigh {
        if let (Some(ratio), Some(frequencies)) = (self.ratio, self.frequencies) {
            return Rayleigh::at(ratio.get(), frequencies.map(Frequency::get));
        }
        Rayleigh {
            mass: self.mass.map_or(0.0, Frequency::get),
            stiffness: self.stiffness.map_or(0.0, Time::get),
        }
    }
}

/// `ground` of a step: a record of acceleration for each direction.
#[skip_serializing_none]
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DeckGround {
    /// File with the acceleration along the wall.
    pub x: Option<String>,
    /// File with the acceleration through the wall.
    pub y: Option<String>,
    /// File with the upward acceleration.
    pub z: Option<String>,
}

/// `ground_factor` of a step: factors of the records.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct DeckGroundFactor {
    /// Factor of the record along the wall.
    pub x: Number,
    /// Factor of the record through the wall.
    pub y: Number,
    /// Factor of the upward record.
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

/// Default of α: it damps vibrations that the increments do not resolve, with a damping ratio of 0.1 % at ten
/// increments per period.
const ALPHA: f64 = -0.05;

impl DeckProcedure {
    /// The procedure of the model with these keys.
    pub fn with(self, alpha: Option<Number>, rayleigh: Option<DeckRayleigh>) -> Procedure {
        match self {
            Self::Auto => Procedure::Auto,
            Self::Static => Procedure::Static,
            Self::Implex => Procedure::Implex,
            Self::QuasiStatic => Procedure::QuasiStatic,
            Self::Dynamic => Procedure::Dynamic {
                alpha: alpha.map_or(ALPHA, Number::get),
                damping: rayleigh.unwrap_or_default().factors(),
            },
            Self::ArcLength => Procedure::ArcLength,
            Self::Dissipation => Procedure::Dissipation,
            Self::DisplacementControl => Procedure::DisplacementControl,
        }
    }
}

impl DeckGround {
    /// Names of the files. `[xyz]`
    pub fn files(&self) -> [Option<&str>; 3] {
        [&self.x, &self.y, &self.z].map(Option::as_deref)
    }
}
