//! `[[blocks]]`, `[[contacts]]`, `[[supports]]`, `[[springs]]`: scenes of single blocks.

use super::{Direction, Lattice};
use crate::deck::quantity::{Angle, Length, SpringStiffness, Velocity};
use crate::model::axis::Axis;
use crate::model::scene::turned;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use serde_with::skip_serializing_none;
use std::borrow::Cow;
use std::fmt;

/// A block of hex8: a box by its size, any hexahedron by its eight corners, a grid of nodes, or the stones of a file.
// More than 15 fields: they are the keys of a table of the deck.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckBlock {
    /// Name, used by faces, supports and springs.
    pub name: String,
    /// Length (x), thickness (y), height (z) of a box [mm].
    pub size: Option<[Length; 3]>,
    /// Position of its lowest corner, or displacement of `corners` and `nodes` [mm].
    #[serde(default)]
    pub at: [Length; 3],
    /// Rotation about the point `at`.
    pub rotate: Option<Rotation>,
    /// Corners [mm]: (−,−,−) (+,−,−) (+,+,−) (−,+,−), then the same four above. `[corner][xyz]`
    pub corners: Option<[[Length; 3]; 8]>,
    /// File of the nodes of its grid: x, y, z per line [mm], along x first, then y, then z.
    pub nodes: Option<String>,
    /// File of closed shells, each a block of its own: OBJ, PLY, STL, JSON of COMPAS, or DXF.
    pub file: Option<String>,
    /// Unit of length of `file`; mm if it is not given.
    pub units: Option<String>,
    /// Thickness of the outlines of a DXF file [mm].
    pub thickness: Option<Length>,
    /// Treatment of shells of `file` that are not convex.
    #[serde(default, skip_serializing_if = "NotConvex::is_error")]
    pub not_convex: NotConvex,
    /// Material.
    pub material: String,
    /// Number of elements along x, y, z.
    #[serde(default = "one_element")]
    pub mesh: [u32; 3],
    /// Whether it is a rigid body, with the nodes of `mesh`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub rigid: bool,
    /// Velocity at the start of the first step with inertia [mm/s].
    #[serde(default)]
    pub velocity: [Velocity; 3],
    /// Number of blocks in a column, named `NAME-0` (the lowest), `NAME-1`, …
    pub stack: Option<u32>,
    /// Interface of the joints of a column.
    pub interface: Option<String>,
    /// Number of copies along x, y, z.
    pub copies: Option<[u32; 3]>,
    /// Distances between copies [mm].
    pub pitch: Option<[Length; 3]>,
    /// Cells of a layer, instead of a box.
    #[serde(skip)]
    pub lattice: Option<Lattice>,
}

/// Treatment of shells that are not convex.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum NotConvex {
    /// They are errors that name the shell.
    #[default]
    Error,
    /// Their convex hulls stand in their place, with a warning.
    Hull,
}

impl NotConvex {
    #[expect(
        clippy::trivially_copy_pass_by_ref,
        reason = "serde calls it by reference"
    )]
    fn is_error(&self) -> bool {
        *self == Self::Error
    }
}

/// A rotation about an axis, right-handed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Rotation {
    /// Axis.
    pub axis: Direction,
    /// Angle [deg].
    pub angle: Angle,
}

impl Rotation {
    /// A point turned about the origin.
    pub(in crate::deck) fn turn(self, x: [f64; 3]) -> [f64; 3] {
        let (d, sign) = self.axis.axis();
        let mut unit = [0.0; 3];
        unit[d] = sign;
        turned(x, unit, self.angle.get().to_radians())
    }

    /// A point turned back about the origin.
    pub(in crate::deck) fn turn_back(self, x: [f64; 3]) -> [f64; 3] {
        let angle = Angle::new(-self.angle.get());
        Self { angle, ..self }.turn(x)
    }
}

/// Contact between faces: points on slave faces against master faces.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckContact {
    /// Slave faces, the finer side. Without slave and master all faces that touch at rest are paired.
    pub slave: Option<Names>,
    /// Master faces.
    pub master: Option<Names>,
    /// Interface.
    pub interface: String,
}

/// Blocks or faces that are held.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckSupport {
    /// Blocks (`"base"`) or faces (`"base.bottom"`).
    pub on: Names,
    /// Holds only nodes in this box: lower and upper corner at rest [mm].
    #[serde(rename = "box", skip_serializing_if = "Option::is_none")]
    pub within: Option<[[Length; 3]; 2]>,
    /// Held directions.
    #[serde(default = "all_axes")]
    pub fixed: Vec<Axis>,
}

impl DeckSupport {
    /// Whether it holds along x, y, z.
    pub(in crate::deck) fn holds(&self) -> [bool; 3] {
        let mut holds = [false; 3];
        for axis in &self.fixed {
            holds[axis.index()] = true;
        }
        holds
    }
}

/// A spring to the ground; a drive may move its far end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckSpring {
    /// Name, used by drives.
    pub name: String,
    /// Blocks or faces whose mean displacement it follows.
    pub on: Names,
    /// Stiffness along x, y, z [N/mm].
    pub stiffness: [SpringStiffness; 3],
}

/// One name or a list of names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Names(pub Vec<String>);

impl Serialize for Names {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match &self.0[..] {
            [one] => one.serialize(serializer),
            many => many.serialize(serializer),
        }
    }
}

impl JsonSchema for Names {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Names".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": ["string", "array"], "items": { "type": "string" } })
    }
}

struct NamesVisitor;

impl<'de> Visitor<'de> for NamesVisitor {
    type Value = Names;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a name or a list of names")
    }

    fn visit_str<E: de::Error>(self, name: &str) -> Result<Names, E> {
        Ok(Names(vec![name.to_owned()]))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Names, A::Error> {
        let mut names = Vec::new();
        while let Some(name) = seq.next_element()? {
            names.push(name);
        }
        Ok(Names(names))
    }
}

impl<'de> Deserialize<'de> for Names {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NamesVisitor)
    }
}

fn one_element() -> [u32; 3] {
    [1; 3]
}

fn all_axes() -> Vec<Axis> {
    vec![Axis::X, Axis::Y, Axis::Z]
}
