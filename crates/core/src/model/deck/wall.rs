//! `[wall]`: what is built, of what, how finely, and how it is held.

use crate::model::quantity::Length;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize, Serializer};
use std::borrow::Cow;
use std::fmt;

/// A wall of representative elements: each a unit with the bed joint on top of it and the head joint
/// at its +x end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wall {
    /// Length (x), thickness (y), height (z) of a whole unit [mm].
    pub unit: [Length; 3],
    /// Thickness of the bed joints [mm].
    pub bed_joint: Length,
    /// Thickness of the head joints [mm].
    pub head_joint: Length,
    /// Length of the wall [mm].
    pub length: Length,
    /// Number of courses.
    pub courses: u32,
    /// How the units overlap.
    #[serde(default)]
    pub bond: Bond,
    /// Material of the units.
    pub unit_material: String,
    /// Material of the joints.
    pub mortar_material: String,
    /// Interface between representative elements.
    pub interface: String,
    /// Elements of a representative element.
    #[serde(default)]
    pub mesh: Subdivision,
    /// Courses held as a whole.
    #[serde(default)]
    pub clamped: Clamped,
}

/// How the units of a course lie on those below.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Bond {
    /// Stretchers; the last unit of a course is cut to the length, every second course is mirrored.
    #[default]
    Stretcher,
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
                    "items": [count(2), count(2), count(1)],
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
