//! `[wall]`, `[[walls]]`: what is built, of what, how finely, and how it is held.

use crate::deck::quantity::{Length, Number};
use crate::model::axis::Axis;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;

/// A wall of representative elements: each a unit with the bed joint on top of it, the head joint at its
/// far end and the collar joint behind it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// Name, by which supports, contacts and steps call it; `wall` if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Where its lowest corner lies [mm].
    #[serde(default, skip_serializing_if = "at_origin")]
    pub at: [Length; 3],
    /// Along which axis it runs, x or y; the other one goes through it.
    #[serde(default, skip_serializing_if = "along_x")]
    pub along: Axis,
    /// Length, thickness, height of a whole unit as a stretcher [mm].
    pub unit: [Length; 3],
    /// Thickness of the bed joints [mm]; 0: the units lie dry on each other.
    pub bed_joint: Length,
    /// Thickness of the head joints [mm]; 0: the units stand dry beside each other.
    pub head_joint: Length,
    /// Thickness of the collar joints between leaves [mm]; that of the head joints if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub collar_joint: Option<Length>,
    /// Part of the head joints that is filled with mortar [-].
    #[serde(default = "filled", skip_serializing_if = "is_filled")]
    pub head_filling: Number,
    /// From which face of the wall it is filled inwards.
    #[serde(default, skip_serializing_if = "FilledFrom::is_both")]
    pub filled_from: FilledFrom,
    /// Length of the wall [mm].
    pub length: Length,
    /// Number of courses.
    pub courses: u32,
    /// How the units overlap.
    #[serde(default)]
    pub bond: Bond,
    /// Stretcher bond: distance of the head joints of a course from those of the next [mm].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub overlap: Option<Length>,
    /// Number of leaves, one behind the other.
    #[serde(default = "one_leaf", skip_serializing_if = "is_one_leaf")]
    pub leaves: u32,
    /// Every so many courses one of headers through two leaves; none if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub header_courses: Option<u32>,
    /// A bond written out: courses from the lowest one, then all over again.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pattern: Vec<DeckCourse>,
    /// Openings.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub openings: Vec<DeckOpening>,
    /// Material of the units.
    pub unit_material: String,
    /// Material of the joints; a dry wall has none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mortar_material: Option<String>,
    /// Interface between representative elements.
    pub interface: String,
    /// Interface at head joints, if it is another one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub head_interface: Option<String>,
    /// Interface at collar joints, if it is another one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub collar_interface: Option<String>,
    /// Elements of a representative element.
    #[serde(default)]
    pub mesh: Subdivision,
    /// Rigid-like: as few elements as may be, a hundred times as stiff as the stiffest joint of the deck.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub rigid: bool,
    /// Courses held as a whole; `false`: supports and steps say what holds and moves the wall, as they do
    /// for all of `[[walls]]`.
    #[serde(default, skip_serializing_if = "Clamping::is_unsaid")]
    pub clamped: Clamping,
}

/// How the units of a course lie on those below.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Bond {
    /// Stretchers; the last unit of a course is cut to the length, every second course is mirrored.
    #[default]
    Stretcher,
    /// All courses alike: head joints run through.
    Stack,
    /// Headers: units lie through the wall, every second course is shifted by half a unit.
    Header,
    /// Courses of stretchers in two leaves and of headers by turns.
    English,
    /// As English, every second course of stretchers shifted by half a unit.
    EnglishCross,
    /// Stretchers in two leaves and headers by turns in every course.
    Flemish,
    /// As `pattern` says.
    Pattern,
}

impl Bond {
    /// Whether it is laid one whole unit thick, of two stretchers or a header.
    pub fn has_headers(self) -> bool {
        matches!(self, Self::English | Self::EnglishCross | Self::Flemish)
    }
}

/// From where partly filled head joints are filled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FilledFrom {
    /// Half from either face of the wall.
    #[default]
    Both,
    /// All from the front.
    Front,
    /// All from the back.
    Back,
}

impl FilledFrom {
    fn is_both(&self) -> bool {
        *self == Self::Both
    }
}

/// A course of a written bond.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckCourse {
    /// Height of its units [mm]; that of the wall's unit if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub height: Option<Length>,
    /// Its leaves, from the front.
    pub leaves: Vec<DeckLeaf>,
}

/// A leaf of a course.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckLeaf {
    /// Its thickness [mm]; that of the wall's unit if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thickness: Option<Length>,
    /// Where its first unit begins [mm]; below 0 it is cut.
    #[serde(default)]
    pub offset: Length,
    /// Lengths of its units one after the other, then all over again [mm].
    pub units: Vec<Length>,
    /// Which of them, from 0, go through all leaves behind this one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub headers: Vec<u32>,
    /// Material of its units, if it is another one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
}

/// An opening through the whole thickness of a wall.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckOpening {
    /// Where it begins along the wall [mm].
    pub from: Length,
    /// Where it ends along the wall [mm].
    pub to: Length,
    /// Courses below it.
    pub sill: u32,
    /// Courses that it goes through.
    pub courses: u32,
    /// What spans it; the courses above span it by themselves if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lintel: Option<DeckLintel>,
}

/// A lintel: one long unit over an opening.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckLintel {
    /// How far it lies on the wall at either end [mm].
    pub bearing: Length,
    /// Courses that it is high.
    #[serde(default = "one_course")]
    pub courses: u32,
    /// Its material; that of the units if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
}

/// Courses that a test's steel beams hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct Clamped {
    /// Lowest courses held in x, y, z; 0: the bottom face is held.
    pub bottom_courses: u32,
    /// Highest courses tied to the level beam; 0: the top face is tied.
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

/// What is clamped of a wall.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clamping {
    /// One course at either end of `[wall]`, nothing of `[[walls]]`.
    #[default]
    Unsaid,
    /// Nothing.
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

/// Elements of a representative element along its length, height and thickness, one of them the
/// joint in length and in height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Subdivision {
    /// Along x: those of the unit and one of the head joint.
    pub length: u32,
    /// Along z: those of the unit and one of the bed joint.
    pub height: u32,
    /// Along y.
    pub thickness: u32,
}

impl Wall {
    /// Axes along and through the wall.
    pub fn axes(&self) -> (usize, usize) {
        match self.along {
            Axis::Y => (1, 0),
            Axis::X | Axis::Z => (0, 1),
        }
    }
}

impl Subdivision {
    /// 20 hex8: the paper's coarse mesh.
    pub const COARSE: Self = Self {
        length: 5,
        height: 2,
        thickness: 2,
    };
    /// 108 hex8: the paper's fine mesh.
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
