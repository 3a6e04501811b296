//! `[[probes]]`: places that the history follows.

use super::{Heading, Names};
use crate::deck::quantity::Length;
use crate::model::probes::ProbeQuantity;
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::value::{MapAccessDeserializer, SeqAccessDeserializer, StrDeserializer};
use serde::de::{self, Deserializer, MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;
use std::borrow::Cow;
use std::fmt;

/// A column of the history: the motion of a place, or of two places relative to each other.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckProbe {
    /// Name; the name of the column begins with it.
    pub name: String,
    /// Blocks or faces: the probe measures the mean of their nodes.
    pub on: Option<Names>,
    /// A point at rest [mm]: the probe measures the nearest node, of those of `on` if given.
    pub near: Option<[Length; 3]>,
    /// A place whose motion is subtracted.
    pub minus: Option<DeckPlace>,
    /// Positive direction; that of `gauge` if absent.
    pub direction: Option<Heading>,
    /// Ends of a gauge at rest [mm]: the probe measures by how much the nodes nearest to them move apart.
    /// `[end][xyz]`
    pub gauge: Option<[[Length; 3]; 2]>,
    /// Measured quantity.
    #[serde(default)]
    pub quantity: ProbeQuantity,
}

/// Nodes of a scene: names as they stand, or a table of `on` and `near`.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeckPlace {
    /// Blocks or faces.
    pub on: Option<Names>,
    /// A point at rest [mm].
    pub near: Option<[Length; 3]>,
}

impl DeckProbe {
    /// Name of its column in the history.
    pub fn column(&self) -> String {
        format!("{}_{}", self.name, self.quantity.unit())
    }
}

impl JsonSchema for DeckPlace {
    fn schema_name() -> Cow<'static, str> {
        "DeckPlace".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let (names, table) = (
            Names::json_schema(generator),
            PlaceTable::json_schema(generator),
        );
        json_schema!({ "anyOf": [names, table] })
    }
}

// The table form of `DeckPlace`.
/// Nodes of a scene: those of `on`, or the one of these nearest to `near`.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct PlaceTable {
    /// Blocks or faces.
    on: Option<Names>,
    /// A point at rest [mm].
    near: Option<[Length; 3]>,
}

struct PlaceVisitor;

impl<'de> Visitor<'de> for PlaceVisitor {
    type Value = DeckPlace;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a name, a list of names, or a table of `on` and `near`")
    }

    fn visit_str<E: de::Error>(self, name: &str) -> Result<DeckPlace, E> {
        let on = Some(Names::deserialize(StrDeserializer::new(name))?);
        Ok(DeckPlace { on, near: None })
    }

    fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<DeckPlace, A::Error> {
        let on = Some(Names::deserialize(SeqAccessDeserializer::new(seq))?);
        Ok(DeckPlace { on, near: None })
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<DeckPlace, A::Error> {
        let PlaceTable { on, near } = PlaceTable::deserialize(MapAccessDeserializer::new(map))?;
        Ok(DeckPlace { on, near })
    }
}

impl<'de> Deserialize<'de> for DeckPlace {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(PlaceVisitor)
    }
}
