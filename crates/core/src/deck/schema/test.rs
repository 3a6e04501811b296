//! `[test]`: the standard test that a deck models, for its evaluation.

use crate::deck::quantity::{Angle, Length, Pressure};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

/// A standard test, and the sizes that its evaluation needs.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckTest {
    /// Evaluation.
    pub kind: TestKind,
    /// Length of the bed or of the wall; of flexure, width of the plane of failure [mm].
    pub length: Option<Length>,
    /// Thickness [mm].
    pub thickness: Option<Length>,
    /// Height [mm].
    pub height: Option<Length>,
    /// Distances of the outer and of the inner bearings [mm].
    pub spans: Option<[Length; 2]>,
    /// Distance from the load of a bond wrench to the tension face [mm].
    pub lever: Option<Length>,
    /// Precompression [MPa].
    pub pressure: Option<Pressure>,
    /// Angle of a tilting table at the end of its step [deg].
    pub angle: Option<Angle>,
}

/// Evaluation of a standard test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum TestKind {
    /// EN 1052-1: strength and modulus in compression.
    #[serde(rename = "en1052-1")]
    Compression,
    /// EN 1052-2: flexural strength.
    #[serde(rename = "en1052-2")]
    Flexure,
    /// EN 1052-3: initial shear strength.
    #[serde(rename = "en1052-3")]
    Triplet,
    /// EN 1052-5: bond strength by the wrench.
    #[serde(rename = "en1052-5")]
    BondWrench,
    /// Tensile strength and fracture energy of a couplet.
    #[serde(rename = "couplet-tension")]
    CoupletTension,
    /// Cohesion, friction and fracture energy of couplets in shear.
    #[serde(rename = "direct-shear")]
    DirectShear,
    /// ASTM E519 and RILEM LUM B6: shear strength and modulus along the diagonal.
    #[serde(rename = "astm-e519")]
    Diagonal,
    /// Walls sheared under compression.
    #[serde(rename = "shear-compression")]
    ShearCompression,
    /// Walls bent by an airbag.
    #[serde(rename = "out-of-plane")]
    OutOfPlane,
    /// Load factor of a wall on a tilting table.
    #[serde(rename = "tilting-table")]
    TiltingTable,
    /// ASTM C1196 and RILEM MDT.D.4: stress of a wall by a flat jack in a slot.
    #[serde(rename = "flat-jack")]
    FlatJack,
    /// ASTM C1197 and RILEM MDT.D.5: modulus of the masonry between two flat jacks.
    #[serde(rename = "flat-jack-double")]
    FlatJackDouble,
    /// ASTM C1531: shear strength of the beds of a unit pushed in place.
    #[serde(rename = "astm-c1531")]
    PushedUnit,
}

impl TestKind {
    /// Whether the test measures the strength of joints alone.
    pub fn measures_joints(self) -> bool {
        matches!(
            self,
            Self::Triplet
                | Self::BondWrench
                | Self::CoupletTension
                | Self::DirectShear
                | Self::PushedUnit
        )
    }
}

impl DeckTest {
    /// Keys that its evaluation needs and that are missing.
    pub fn missing(&self) -> Vec<&'static str> {
        use TestKind as Kind;
        let has = [
            ("length", self.length.is_some()),
            ("thickness", self.thickness.is_some()),
            ("height", self.height.is_some()),
            ("spans", self.spans.is_some()),
            ("lever", self.lever.is_some()),
            ("pressure", self.pressure.is_some()),
            ("angle", self.angle.is_some()),
        ];
        let needs: &[&str] = match self.kind {
            Kind::Compression | Kind::Diagonal | Kind::OutOfPlane => {
                &["length", "thickness", "height"]
            }
            Kind::Flexure => &["length", "thickness", "spans"],
            Kind::Triplet | Kind::DirectShear | Kind::PushedUnit => {
                &["length", "thickness", "pressure"]
            }
            Kind::BondWrench => &["length", "thickness", "lever"],
            Kind::CoupletTension => &["length", "thickness"],
            Kind::ShearCompression => &["length", "thickness", "height", "pressure"],
            Kind::TiltingTable => &["length", "thickness", "height", "angle"],
            Kind::FlatJack | Kind::FlatJackDouble => &["pressure"],
        };
        let missing = has
            .into_iter()
            .filter(|(key, there)| !there && needs.contains(key));
        missing.map(|(key, _)| key).collect()
    }

    /// Probes that its evaluation reads, by name.
    pub fn probes(&self) -> &'static [&'static str] {
        match self.kind {
            TestKind::Compression => &["front", "back"],
            TestKind::Diagonal => &["vertical", "horizontal"],
            TestKind::Triplet | TestKind::PushedUnit => &["slip"],
            TestKind::DirectShear => &["uplift"],
            TestKind::FlatJack | TestKind::FlatJackDouble => &["left", "middle", "right"],
            _ => &[],
        }
    }
}
