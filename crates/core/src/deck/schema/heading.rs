//! Directions of probes: an axis by its name, or any vector.

use super::Direction;
use crate::deck::quantity::Number;
use crate::element::hexahedron::norm;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::{SeqAccessDeserializer, StrDeserializer};
use serde::de::{self, Deserializer, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::fmt;

/// A direction: `"x"` … `"-z"`, or a vector of any length, `[1, 0, -1]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Heading {
    /// Along an axis.
    Axis(Direction),
    /// Along a vector. `[xyz]`
    Vector([Number; 3]),
}

impl Heading {
    /// The direction as a vector of length 1, or 0 if no vector gives a direction. `[xyz]`
    pub fn unit(self) -> [f64; 3] {
        match self {
            Self::Axis(direction) => {
                let (axis, sign) = direction.axis();
                [0, 1, 2].map(|d| if d == axis { sign } else { 0.0 })
            }
            Self::Vector(vector) => unit(vector.map(Number::get)),
        }
    }
}

/// A vector scaled to length 1; 0 stays 0.
fn unit(vector: [f64; 3]) -> [f64; 3] {
    let length = norm(vector);
    if length > 0.0 {
        vector.map(|x| x / length)
    } else {
        vector
    }
}

impl JsonSchema for Heading {
    fn schema_name() -> Cow<'static, str> {
        "Heading".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let axis = generator.subschema_for::<Direction>();
        let vector = <[Number; 3]>::json_schema(generator);
        json_schema!({ "anyOf": [axis, vector] })
    }
}

/// Directions that messages name.
const KNOWN: &[&str] = &["x", "y", "z", "-x", "-y", "-z", "[1, 0.5, 0]"];

struct HeadingVisitor;

impl<'de> Visitor<'de> for HeadingVisitor {
    type Value = Heading;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("\"x\", \"y\", \"z\", \"-x\", \"-y\", \"-z\" or a vector of three numbers")
    }

    fn visit_str<E: de::Error>(self, name: &str) -> Result<Heading, E> {
        let axis = Direction::deserialize(StrDeserializer::<E>::new(name));
        axis.map(Heading::Axis)
            .map_err(|_| E::unknown_variant(name, KNOWN))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Heading, A::Error> {
        Deserialize::deserialize(SeqAccessDeserializer::new(seq)).map(Heading::Vector)
    }
}

impl<'de> Deserialize<'de> for Heading {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(HeadingVisitor)
    }
}
