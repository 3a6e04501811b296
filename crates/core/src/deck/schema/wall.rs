//! `[wall]`, `[[walls]]`: bond, materials, mesh and clamping of walls.

use super::Rotation;
use crate::deck::quantity::{Length, Number};
use crate::model::axis::Axis;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use serde_with::skip_serializing_none;
use std::borrow::Cow;
use std::fmt;

/// A wall of representative elements. Each is a unit with the bed joint on top of it, the head joint at its far end
/// and halves of the collar joints before and behind it.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
// More than 15 fields: one for each key of the table.
pub struct Wall {
    /// Name, used by supports, contacts and steps; `wall` if absent.
    pub name: Option<String>,
    /// Position of its lowest corner [mm].
    #[serde(default, skip_serializing_if = "at_origin")]
    pub at: [Length; 3],
    /// Axis along the wall, x or y; the other one goes through the wall.
    #[serde(default, skip_serializing_if = "along_x")]
    pub along: Axis,
    /// Rotation about the point `at`.
    pub rotate: Option<Rotation>,
    /// Length, thickness, height of a whole unit as a stretcher [mm].
    pub unit: [Length; 3],
    /// Thickness of the bed joints [mm]; 0: dry joints.
    pub bed_joint: Length,
    /// Thickness of the head joints [mm]; 0: dry joints.
    pub head_joint: Length,
    /// Thickness of the collar joints between leaves [mm]; that of the head joints if absent.
    pub collar_joint: Option<Length>,
    /// Fraction of the head joints that is filled with mortar [-].
    #[serde(default = "filled", skip_serializing_if = "is_filled")]
    pub head_filling: Number,
    /// Faces of the wall from which head joints are filled.
    #[serde(default, skip_serializing_if = "FilledFrom::is_both")]
    pub filled_from: FilledFrom,
    /// Length of the wall [mm].
    pub length: Length,
    /// Number of courses.
    pub courses: u32,
    /// Heights of its storeys from the lowest one [mm]; each ends with the course nearest to its height.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub storeys: Vec<Length>,
    /// Bond of the units.
    #[serde(default)]
    pub bond: Bond,
    /// Stretcher bond: distance between head joints of neighbouring courses [mm].
    pub overlap: Option<Length>,
    /// Number of leaves, one behind the other; in an English bond the thickness in half-bricks, 2 if absent.
    #[serde(default = "one_leaf", skip_serializing_if = "is_one_leaf")]
    pub leaves: u32,
    /// Number of courses after which one is a course of headers through two leaves; none if absent.
    pub header_courses: Option<u32>,
    /// A written bond: courses from the lowest one; the sequence repeats.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pattern: Vec<DeckCourse>,
    /// How it meets walls in the same place.
    #[serde(default, skip_serializing_if = "Corners::is_interlocked")]
    pub corners: Corners,
    /// Openings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub openings: Vec<DeckOpening>,
    /// Length of the pieces beside openings, other walls and the ends of the wall that are joined to the next unit of
    /// their course, which becomes longer [mm]: all that are shorter; a tenth of a unit if absent, 0: none.
    pub snap: Option<Length>,
    /// Material of the units.
    pub unit_material: String,
    /// Material of the joints; absent in a dry wall.
    pub mortar_material: Option<String>,
    /// Whether units grow to the middle of their joints, so that interfaces without thickness carry the mortar.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub expanded: bool,
    /// Interface in the middle of expanded units, where they can crack; none: they do not crack.
    pub crack_interface: Option<String>,
    /// Interface between representative elements.
    pub interface: String,
    /// Interface at head joints, if different.
    pub head_interface: Option<String>,
    /// Interface at collar joints, if different.
    pub collar_interface: Option<String>,
    /// Number of elements of a representative element.
    #[serde(default)]
    pub mesh: Subdivision,
    /// Whether units are rigid bodies, with as few nodes as possible.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub rigid: bool,
    /// Courses that are clamped as a whole. `false`: supports and steps hold and move the wall, as they do for all
    /// of `[[walls]]`.
    #[serde(default, skip_serializing_if = "Clamping::is_unsaid")]
    pub clamped: Clamping,
}

/// Arrangement of the units in courses.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Bond {
    /// Stretchers; the last unit of a course is cut to the length, every second course is mirrored.
    #[default]
    Stretcher,
    /// All courses equal: head joints run through.
    Stack,
    /// Headers: units lie through the wall, every second course is shifted by half a unit.
    Header,
    /// Courses of stretchers in two leaves alternate with courses of headers.
    English,
    /// As English, with every second course of stretchers shifted by half a unit.
    EnglishCross,
    /// Stretchers in two leaves and headers alternate in every course.
    Flemish,
    /// The bond of `pattern`.
    Pattern,
}

impl Bond {
    /// Returns whether the wall is one whole unit thick, of two stretchers or a header.
    pub fn has_headers(self) -> bool {
        matches!(self, Self::English | Self::EnglishCross | Self::Flemish)
    }
}

/// How a wall meets another wall in the same place.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Corners {
    /// They pass through each other in turn, course by course.
    #[default]
    Interlocked,
    /// It ends at the other wall in all courses.
    Butted,
}

impl Corners {
    fn is_interlocked(&self) -> bool {
        *self == Self::Interlocked
    }
}

/// Faces from which partly filled head joints are filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FilledFrom {
    /// Half from each face of the wall.
    #[default]
    Both,
    /// From the front only.
    Front,
    /// From the back only.
    Back,
}

impl FilledFrom {
    fn is_both(&self) -> bool {
        *self == Self::Both
    }
}

/// A course of a written bond.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckCourse {
    /// Height of its units [mm]; that of the wall's units if absent.
    pub height: Option<Length>,
    /// Leaves, from the front.
    pub leaves: Vec<DeckLeaf>,
}

/// A leaf of a course.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckLeaf {
    /// Thickness [mm]; that of the wall's units if absent.
    pub thickness: Option<Length>,
    /// Start of its first unit [mm]; the part below 0 is cut off.
    #[serde(default)]
    pub offset: Length,
    /// Lengths of its units in order [mm]; the sequence repeats.
    pub units: Vec<Length>,
    /// Indices, from 0, of the units that go through all leaves behind this one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub headers: Vec<u32>,
    /// Material of its units, if different.
    pub material: Option<String>,
}

/// An opening through the whole thickness of a wall.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckOpening {
    /// Start along the wall [mm].
    pub from: Length,
    /// End along the wall [mm].
    pub to: Length,
    /// Number of courses below it.
    pub sill: u32,
    /// Number of courses that it interrupts.
    pub courses: u32,
    /// Lintel; if absent, the courses above span the opening.
    pub lintel: Option<DeckLintel>,
}

/// A lintel: one long unit over an opening.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckLintel {
    /// Length of the bearing on the wall at each end [mm].
    pub bearing: Length,
    /// Height in courses.
    #[serde(default = "one_course")]
    pub courses: u32,
    /// Material; that of the units if absent.
    pub material: Option<String>,
}

/// Courses held by the steel beams of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Clamped {
    /// Number of lowest courses held in x, y, z; 0: the bottom face is held.
    pub bottom_courses: u32,
    /// Number of highest courses tied to the level beam; 0: the top face is tied.
    pub top_courses: u32,
}

impl Default for Clamped {
    fn default() -> Self {
        Self {
            bottom_courses: 1,
            top_courses: 1,
        }
    }
}

/// Clamped courses of a wall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clamping {
    /// Default: one course at either end of `[wall]`, none of `[[walls]]`.
    #[default]
    Unsaid,
    /// None.
    Nothing,
    /// These courses.
    Courses(Clamped),
}

impl Clamping {
    fn is_unsaid(&self) -> bool {
        *self == Self::Unsaid
    }
}

impl Serialize for Clamping {
    fn serialize<S: Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Unsaid => Clamped::default().serialize(s),
            Self::Nothing => false.serialize(s),
            Self::Courses(clamped) => clamped.serialize(s),
        }
    }
}

impl JsonSchema for Clamping {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Clamping".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let clamped = generator.subschema_for::<Clamped>();
        json_schema!({ "anyOf": [{ "const": false }, clamped] })
    }
}

impl<'de> Deserialize<'de> for Clamping {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ClampingVisitor;
        impl<'de> Visitor<'de> for ClampingVisitor {
            type Value = Clamping;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a table, or false")
            }

            fn visit_bool<E: de::Error>(self, clamped: bool) -> Result<Self::Value, E> {
                if clamped {
                    let what = de::Unexpected::Bool(clamped);
                    return Err(E::invalid_value(what, &self));
                }
                Ok(Clamping::Nothing)
            }

            fn visit_map<A: de::MapAccess<'de>>(self, map: A) -> Result<Self::Value, A::Error> {
                let table = de::value::MapAccessDeserializer::new(map);
                Clamped::deserialize(table).map(Clamping::Courses)
            }
        }
        deserializer.deserialize_any(ClampingVisitor)
    }
}

fn at_origin(at: &[Length; 3]) -> bool {
    at.iter().all(|x| x.get() == 0.0)
}

fn along_x(axis: &Axis) -> bool {
    *axis == Axis::X
}

fn filled() -> Number {
    Number::new(1.0)
}

fn is_filled(part: &Number) -> bool {
    part.get() == 1.0
}

fn one_leaf() -> u32 {
    1
}

fn is_one_leaf(leaves: &u32) -> bool {
    *leaves == 1
}

fn one_course() -> u32 {
    1
}

/// Number of elements of a representative element along its length, height and thickness, including one of the
/// joint in length and in height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Subdivision {
    /// Along x: elements of the unit and one of the head joint.
    pub length: u32,
    /// Along z: elements of the unit and one of the bed joint.
    pub height: u32,
    /// Along y.
    pub thickness: u32,
}

/// Length of the pieces that are joined to the unit beside them, over that of a unit.
const SNAP: f64 = 0.1;

impl Wall {
    /// Length below which a piece is joined to the unit beside it [mm].
    pub fn snap_below(&self) -> f64 {
        self.snap.map_or(SNAP * self.unit[0].get(), Length::get)
    }

    /// Range of an opening along the wall [mm]. It ends with the wall if less than a piece would be left beside it.
    pub fn edges(&self, opening: &DeckOpening) -> [f64; 2] {
        let ([from, to], length) = ([opening.from.get(), opening.to.get()], self.length.get());
        let most = self.snap_below();
        let ends = |gap: f64| gap > 0.0 && gap < most;
        [
            if ends(from) { 0.0 } else { from },
            if ends(length - to) { length } else { to },
        ]
    }

    /// Axes along and through the wall.
    pub fn axes(&self) -> (usize, usize) {
        match self.along {
            Axis::Y => (1, 0),
            Axis::X | Axis::Z => (0, 1),
        }
    }
}

impl Subdivision {
    /// 20 hex8: the coarse mesh of the paper.
    pub const COARSE: Self = Self {
        length: 5,
        height: 2,
        thickness: 2,
    };
    /// 108 hex8: the fine mesh of the paper.
    pub const FINE: Self = Self {
        length: 9,
        height: 4,
        thickness: 3,
    };
}

impl Default for Subdivision {
    fn default() -> Self {
        Self::COARSE
    }
}

impl Serialize for Subdivision {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        [self.length, self.height, self.thickness].serialize(serializer)
    }
}

impl JsonSchema for Subdivision {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        "Subdivision".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let count = |least: u32| json_schema!({ "type": "integer", "minimum": least });
        json_schema!({
            "anyOf": [
                { "enum": ["coarse", "fine"] },
                {
                    "type": "array",
                    "items": [count(1), count(1), count(1)],
                    "minItems": 3,
                    "maxItems": 3,
                },
            ],
        })
    }
}

struct SubdivisionVisitor;

impl<'de> Visitor<'de> for SubdivisionVisitor {
    type Value = Subdivision;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"coarse\", \"fine\" or [length, height, thickness]")
    }

    fn visit_str<E: de::Error>(self, name: &str) -> Result<Self::Value, E> {
        match name {
            "coarse" => Ok(Subdivision::COARSE),
            "fine" => Ok(Subdivision::FINE),
            other => Err(E::invalid_value(de::Unexpected::Str(other), &self)),
        }
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
        let mut counts = Vec::with_capacity(3);
        while let Some(count) = seq.next_element::<u32>()? {
            counts.push(count);
        }
        match counts[..] {
            [length, height, thickness] => Ok(Subdivision {
                length,
                height,
                thickness,
            }),
            _ => Err(de::Error::invalid_length(counts.len(), &self)),
        }
    }
}

impl<'de> Deserialize<'de> for Subdivision {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(SubdivisionVisitor)
    }
}
