//! `[[ties]]`: rods and bars between points, and bars in bed joints.

use crate::deck::quantity::{Area, Force, Length, Number, Pressure};
use crate::model::ties::Tie;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

/// A tie: bars that carry a force along their length only.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
// More than 15 fields: one for each key of the table.
#[expect(non_snake_case, reason = "the key is the symbol of Young's modulus")]
pub struct DeckTie {
    /// Name; the names of its columns in the history begin with it.
    pub name: String,
    /// Points of its line at rest [mm]; an anchored tie has two. `[point][xyz]`
    pub points: Option<Vec<[Length; 3]>>,
    /// Wall in whose bed joints the bars lie, instead of `points`.
    pub along: Option<String>,
    /// Courses of that wall, from 0: the bars lie in the bed joint on each.
    pub courses: Option<Vec<u32>>,
    /// Area of all its bars together [mm²].
    pub area: Option<Area>,
    /// Diameter of a bar [mm], instead of `area`.
    pub diameter: Option<Length>,
    /// Number of bars; in bed joints they are spread over the thickness of the wall.
    #[serde(default = "one")]
    pub bars: u32,
    /// Young's modulus [MPa].
    pub E: Pressure,
    /// Yield stress [MPa]; elastic if absent.
    pub f_y: Option<Pressure>,
    /// Slope of the yield stress over the plastic strain [MPa].
    pub hardening: Option<Pressure>,
    /// Strain at which it breaks [-]; never if absent.
    pub rupture: Option<Number>,
    /// Whether it carries compression; a bonded tie does, and an anchored one does not, if absent.
    pub compression: Option<bool>,
    /// Force of all its bars together after stressing [N].
    pub prestress: Option<Force>,
    /// Name of the step in which it is installed and stressed; the first step if absent.
    pub step: Option<String>,
    /// Where it is bound to the solids.
    #[serde(default)]
    pub bond: TieBond,
    /// Bonded: length over which it is free at each joint [mm]; 20 diameters if absent.
    pub unbonded: Option<Length>,
}

/// Where a tie is bound to the solids.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TieBond {
    /// At its two ends.
    #[default]
    Anchored,
    /// Along its whole length, to each body that it crosses.
    Bonded,
}

impl DeckTie {
    /// Area of all its bars [mm²].
    pub fn whole_area(&self) -> f64 {
        let circle = |d: Length| 0.25 * std::f64::consts::PI * d.get() * d.get();
        let of_bars = self.diameter.map(|d| f64::from(self.bars) * circle(d));
        self.area.map(Area::get).or(of_bars).unwrap_or(0.0)
    }

    /// Diameter of a bar [mm]: that of a circle of its area, if none is given.
    pub fn bar_diameter(&self) -> f64 {
        let area = self.whole_area() / f64::from(self.bars.max(1));
        (4.0 * area / std::f64::consts::PI).sqrt()
    }

    /// Length over which a bonded tie is free at a joint [mm].
    pub fn free_length(&self) -> f64 {
        let default = UNBONDED * self.bar_diameter();
        self.unbonded.map_or(default, Length::get)
    }

    /// Whether it is bound along its whole length.
    pub fn is_bonded(&self) -> bool {
        self.bond == TieBond::Bonded || self.along.is_some()
    }

    /// Whether it carries compression.
    pub fn takes_compression(&self) -> bool {
        self.compression.unwrap_or_else(|| self.is_bonded())
    }

    /// Names of its ties in the model: its own, or one for each bed joint.
    pub fn names(&self) -> Vec<String> {
        match &self.courses {
            Some(courses) if self.along.is_some() => {
                let of = |k: &u32| format!("{}-{k}", self.name);
                courses.iter().map(of).collect()
            }
            _ => vec![self.name.clone()],
        }
    }

    /// Names of its columns in the history.
    pub fn columns(&self) -> Vec<String> {
        self.names()
            .iter()
            .flat_map(|name| Tie::columns(name))
            .collect()
    }
}

/// Diameters over which a bonded bar is free at a joint, if the deck does not say: a bar of 500 MPa yields over that
/// length, half on either side of a crack, at a bond stress of f_y/(4 · 20) = 6.25 MPa.
const UNBONDED: f64 = 20.0;

fn one() -> u32 {
    1
}
