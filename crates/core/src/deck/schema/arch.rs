//! `[arch]`: a circular arch of equal voussoirs between two springings.

use crate::deck::quantity::{Angle, Length};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

/// An arch in the plane x, z about the origin, with its crown on the z axis.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckArch {
    /// Radius of the centre line [mm]; or `span`.
    pub radius: Option<Length>,
    /// Clear span between the feet of the intrados [mm]; or `radius`.
    pub span: Option<Length>,
    /// Thickness in the radial direction [mm].
    pub thickness: Length,
    /// Width along y [mm].
    pub width: Length,
    /// Number of voussoirs.
    pub voussoirs: u32,
    /// Angle of embrace [deg]; if absent, it follows from `span` and `rise`, or the arch is a semicircle.
    pub angle: Option<Angle>,
    /// Clear rise of the intrados over its feet [mm], with `span`; or `angle`.
    pub rise: Option<Length>,
    /// Material of voussoirs and springings.
    pub material: String,
    /// Interface of the radial joints.
    pub interface: String,
    /// Whether the stones are rigid bodies, with the nodes of `mesh`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub rigid: bool,
    /// Number of elements of a voussoir along the arch, its width and its thickness.
    #[serde(default = "one_element")]
    pub mesh: [u32; 3],
}

impl DeckArch {
    /// Angle of embrace [rad]: the given one; or 4 atan(2 f/s) for clear span s and rise f, from the angles at foot
    /// and crown over the chord; else π.
    pub fn embrace(&self) -> f64 {
        match (self.angle, self.rise, self.span) {
            (Some(angle), ..) => angle.get().to_radians(),
            (None, Some(rise), Some(span)) => 4.0 * (2.0 * rise.get() / span.get()).atan(),
            _ => SEMICIRCLE.to_radians(),
        }
    }

    /// Radius of the centre line [mm]: the given one, or that of the clear span s = 2 (R − t/2) sin(α/2).
    pub fn centre_line(&self) -> f64 {
        match (self.radius, self.span) {
            (Some(radius), _) => radius.get(),
            (None, Some(span)) => {
                let half_angle = 0.5 * self.embrace();
                0.5 * (span.get() / half_angle.sin() + self.thickness.get())
            }
            (None, None) => 0.0,
        }
    }
}

/// Angle of embrace of a semicircle [deg].
const SEMICIRCLE: f64 = 180.0;

fn one_element() -> [u32; 3] {
    [1; 3]
}
