//! JSON schemas of the messages in `run.mcap`.
//!
//! Schemas `foxglove.*` have the names and fields that viewers expect. Schemas `wythe.*` are derived from a message,
//! so that they always agree with it.

use serde_json::{Map, Value, json};

/// Encoding of the schemas in MCAP.
pub const SCHEMA_ENCODING: &str = "jsonschema";
/// Encoding of the messages in MCAP.
pub const MESSAGE_ENCODING: &str = "json";

/// A schema.
pub struct Schema {
    /// Name.
    pub name: &'static str,
    /// JSON Schema.
    pub text: String,
}

/// Schema of messages like `example`, an object of numbers and texts.
pub fn like(name: &'static str, about: &str, example: &Value) -> Schema {
    let kind = |value: &Value| match value {
        Value::Number(n) if n.is_f64() => number(),
        Value::Number(_) => integer(),
        _ => string(),
    };
    let fields = example.as_object().into_iter().flatten();
    let fields: Vec<(&str, Value)> = fields.map(|(k, v)| (k.as_str(), kind(v))).collect();
    schema(name, about, &fields)
}

/// `foxglove.Log`
pub fn log() -> Schema {
    let fields = [
        ("timestamp", time()),
        ("level", integer()),
        ("message", string()),
        ("name", string()),
        ("file", string()),
        ("line", integer()),
    ];
    schema("foxglove.Log", "A line of the log", &fields)
}

/// `foxglove.SceneUpdate`
pub fn scene_update() -> Schema {
    let deletion = [("timestamp", time()), ("type", integer()), ("id", string())];
    let pair = [("key", string()), ("value", string())];
    let entity = [
        ("timestamp", time()),
        ("frame_id", string()),
        ("id", string()),
        ("lifetime", time()),
        ("frame_locked", boolean()),
        ("metadata", array(&object(&pair))),
        ("arrows", array(&arrow())),
        ("cubes", array(&solid(&[]))),
        ("spheres", array(&solid(&[]))),
        (
            "cylinders",
            array(&solid(&[
                ("bottom_scale", number()),
                ("top_scale", number()),
            ])),
        ),
        (
            "lines",
            array(&pointwise(&[
                ("type", integer()),
                ("thickness", number()),
                ("scale_invariant", boolean()),
            ])),
        ),
        ("triangles", array(&pointwise(&[]))),
        ("texts", array(&text())),
        ("models", array(&model())),
    ];
    let fields = [
        ("deletions", array(&object(&deletion))),
        ("entities", array(&object(&entity))),
    ];
    schema("foxglove.SceneUpdate", "Entities of a 3D scene", &fields)
}

fn schema(name: &'static str, about: &str, fields: &[(&str, Value)]) -> Schema {
    let mut root = object(fields);
    root["title"] = name.into();
    root["description"] = about.into();
    Schema {
        name,
        text: root.to_string(),
    }
}

fn object(fields: &[(&str, Value)]) -> Value {
    let properties: Map<String, Value> = fields
        .iter()
        .map(|(k, v)| ((*k).to_owned(), v.clone()))
        .collect();
    json!({ "type": "object", "properties": properties })
}

fn array(items: &Value) -> Value {
    json!({ "type": "array", "items": items })
}

fn number() -> Value {
    json!({ "type": "number" })
}

fn integer() -> Value {
    json!({ "type": "integer" })
}

fn string() -> Value {
    json!({ "type": "string" })
}

fn boolean() -> Value {
    json!({ "type": "boolean" })
}

/// A time or a duration.
fn time() -> Value {
    object(&[("sec", integer()), ("nsec", integer())])
}

fn numbers(names: &[&str]) -> Value {
    let fields: Vec<(&str, Value)> = names.iter().map(|n| (*n, number())).collect();
    object(&fields)
}

fn xyz() -> Value {
    numbers(&["x", "y", "z"])
}

fn color() -> Value {
    numbers(&["r", "g", "b", "a"])
}

fn pose() -> Value {
    let turn = numbers(&["x", "y", "z", "w"]);
    object(&[("position", xyz()), ("orientation", turn)])
}

fn arrow() -> Value {
    let sizes = [
        "shaft_length",
        "shaft_diameter",
        "head_length",
        "head_diameter",
    ];
    let mut fields = vec![("pose", pose()), ("color", color())];
    fields.extend(sizes.map(|size| (size, number())));
    object(&fields)
}

fn solid(more: &[(&'static str, Value)]) -> Value {
    let mut fields = vec![("pose", pose()), ("size", xyz()), ("color", color())];
    fields.extend_from_slice(more);
    object(&fields)
}

/// Lines or triangles.
fn pointwise(more: &[(&'static str, Value)]) -> Value {
    let mut fields = vec![
        ("pose", pose()),
        ("points", array(&xyz())),
        ("color", color()),
        ("colors", array(&color())),
        ("indices", array(&integer())),
    ];
    fields.extend_from_slice(more);
    object(&fields)
}

fn text() -> Value {
    object(&[
        ("pose", pose()),
        ("billboard", boolean()),
        ("font_size", number()),
        ("scale_invariant", boolean()),
        ("color", color()),
        ("text", string()),
    ])
}

fn model() -> Value {
    object(&[
        ("pose", pose()),
        ("scale", xyz()),
        ("color", color()),
        ("override_color", boolean()),
        ("url", string()),
        ("media_type", string()),
        (
            "data",
            json!({ "type": "string", "contentEncoding": "base64" }),
        ),
    ])
}
