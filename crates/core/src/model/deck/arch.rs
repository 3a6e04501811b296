//! `[arch]`: a circular arch of equal voussoirs between two springings.

use crate::model::quantity::{Angle, Length};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An arch in the plane x, z about the origin, its crown on the z axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckArch {
    /// Radius of the centre line [mm]; or `span`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<Length>,
    /// Clear span between the feet of the intrados [mm]; or `radius`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub span: Option<Length>,
    /// Thickness in the radial direction [mm].
    pub thickness: Length,
    /// Width along y [mm].
    pub width: Length,
    /// Number of voussoirs.
    pub voussoirs: u32,
    /// Angle of embrace [deg].
    #[serde(default = "semicircle")]
    pub angle: Angle,
    /// Material of voussoirs and springings.
    pub material: String,
    /// Interface of the radial joints.
    pub interface: String,
    /// Elements of a voussoir along the arch, its width, its thickness.
    #[serde(default = "one_element")]
    pub mesh: [u32; 3],
}

impl DeckArch {
    /// Radius of the centre line [mm]: given, or from the clear span s = 2 (R − t/2) sin(α/2).
    pub fn centre_line(&self) -> f64 {
        match (self.radius, self.span) {
            (Some(radius), _) => radius.get(),
            (None, Some(span)) => {
                let half_angle = 0.5 * self.angle.get().to_radians();
                0.5 * (span.get() / half_angle.sin() + self.thickness.get())
            }
            (None, None) => 0.0,
        }
    }
}

fn semicircle() -> Angle {
    Angle::new(180.0)
}

fn one_element() -> [u32; 3] {
    [1; 3]
}
