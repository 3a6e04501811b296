//! JSON schema of decks, with which editors complete and check them.

use super::Deck;
use schemars::generate::SchemaSettings;
use serde_json::Value;

/// The schema in draft 07, which editors of TOML support best. Its descriptions are the doc comments of the deck
/// types.
pub fn schema() -> Value {
    let generator = SchemaSettings::draft07().into_generator();
    let mut schema = generator.into_root_schema_for::<Deck>().to_value();
    plain(&mut schema);
    if let Value::Object(root) = &mut schema {
        root.insert("title".to_owned(), "A deck of wythe".into());
    }
    schema
}

/// The schema as the text of a file.
pub fn text() -> String {
    format!("{:#}\n", schema())
}

/// Removes null values and integer formats, which TOML does not have: an optional key is left out.
fn plain(value: &mut Value) {
    let null = |v: &Value| v == "null" || v["type"] == "null";
    match value {
        Value::Array(items) => items.iter_mut().for_each(plain),
        Value::Object(object) => {
            for key in ["type", "anyOf"] {
                if let Some(Value::Array(choices)) = object.get_mut(key) {
                    choices.retain(|choice| !null(choice));
                }
            }
            if let Some(Value::Array(types)) = object.get_mut("type")
                && types.len() == 1
            {
                let only = types.remove(0);
                object.insert("type".to_owned(), only);
            }
            object.retain(|key, value| key != "default" || !value.is_null());
            // The format names Rust's integer types.
            if object.get("format").is_some_and(Value::is_string) {
                object.remove("format");
            }
            object.values_mut().for_each(plain);
        }
        _ => {}
    }
}
