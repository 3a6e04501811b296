//! The JSON schema of decks: valid decks conform, decks of invalid form do not, and the copy in docs is up to date.

use std::path::{Path, PathBuf};
use wythe::deck::{Deck, json_schema};

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn validator() -> jsonschema::Validator {
    jsonschema::draft7::new(&json_schema::schema()).expect("a schema")
}

/// A deck as JSON, as the schema sees it.
fn json(text: &str) -> serde_json::Value {
    let value: toml::Table = toml::from_str(text).expect("TOML");
    serde_json::to_value(value).expect("no dates")
}

fn decks(folder: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(repository(folder)).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let mut decks: Vec<PathBuf> = paths
        .filter(|p| p.extension().is_some_and(|e| e == "toml"))
        .collect();
    decks.sort();
    assert!(!decks.is_empty(), "{folder}");
    decks
}

#[test]
fn examples_and_templates_validate_and_name_the_schema() {
    let validator = validator();
    for path in [decks("examples"), decks("crates/core/src/deck/templates")].concat() {
        let text = std::fs::read_to_string(&path).unwrap();
        let first = text.lines().next().unwrap();
        assert!(
            first.starts_with("#:schema ") && first.ends_with("deck.schema.json"),
            "{}",
            path.display()
        );
        let deck = json(&text);
        let wrong: Vec<String> = validator
            .iter_errors(&deck)
            .map(|e| e.to_string())
            .collect();
        assert!(wrong.is_empty(), "{}: {wrong:?}", path.display());
        // A deck with all defaults written conforms, too.
        let said = Deck::from_str(&text, "deck.toml")
            .unwrap()
            .to_toml()
            .unwrap();
        let deck = json(&said);
        let wrong: Vec<String> = validator
            .iter_errors(&deck)
            .map(|e| e.to_string())
            .collect();
        assert!(wrong.is_empty(), "{}: {wrong:?}", path.display());
    }
}

#[test]
fn decks_of_a_wrong_form_are_rejected() {
    let validator = validator();
    for name in [
        "missing_format",
        "missing_key",
        "misspelt_key",
        "newer_format",
        "unknown_mesh",
        "wrong_key",
        "wrong_type",
        "wrong_type_row",
        "zero_subdivision",
    ] {
        let text = std::fs::read_to_string(repository(&format!("tests/data/bad/{name}.toml")));
        assert!(!validator.is_valid(&json(&text.unwrap())), "{name}");
    }
    let text = std::fs::read_to_string(repository("examples/08_block_couplet.toml")).unwrap();
    let good = json(&text);
    for (path, value) in [
        ("/blocks/0/name", "3"),
        ("/blocks/0/size", "[1, 2]"),
        ("/blocks/0/at", "[0, 0, {}]"),
        ("/steps/0/kind", "\"push\""),
        ("/steps", "{}"),
        ("/materials", "[]"),
        ("/contacts/0/interface", "[1]"),
        ("/contact", "{ \"points\": \"edge\" }"),
    ] {
        let mut bad = good.clone();
        if let Some(at) = bad.pointer_mut(path) {
            *at = serde_json::from_str(value).unwrap();
        } else {
            let (above, key) = path.rsplit_once('/').unwrap();
            let above = bad.pointer_mut(above).and_then(|v| v.as_object_mut());
            let value = serde_json::from_str(value).unwrap();
            above
                .unwrap_or_else(|| panic!("{path}"))
                .insert(key.to_owned(), value);
        }
        assert!(!validator.is_valid(&bad), "{path} = {value}");
    }
}

#[test]
fn quantities_are_numbers_or_strings_with_a_unit() {
    let text = std::fs::read_to_string(repository("examples/01_couplet_tension.toml")).unwrap();
    let (good, validator) = (json(&text), validator());
    let with = |key: &str, value: serde_json::Value| {
        let mut deck = good.clone();
        *deck.pointer_mut(key).unwrap() = value;
        validator.is_valid(&deck)
    };
    for right in ["204 mm", "20.4cm", "+2.04e-1 m", ".5 um", " 3 m "] {
        assert!(with("/wall/length", right.into()), "{right}");
    }
    for wrong in ["204", "long", "mm", "", "1.2.3 mm", "- 3 mm"] {
        assert!(!with("/wall/length", wrong.into()), "{wrong}");
        let deck = text.replace("length = \"204 mm\"", &format!("length = \"{wrong}\""));
        assert!(Deck::from_str(&deck, "deck.toml").is_err(), "{wrong}");
    }
    // A string for a dimensionless quantity needs no unit.
    for right in ["15 %", "0.15", "15%"] {
        assert!(with("/materials/brick/nu", right.into()), "{right}");
    }
    assert!(with("/wall/length", 204.into()) && with("/wall/length", 204.5.into()));
    assert!(!with("/wall/length", true.into()));
}

/// Every key has a description, which editors show.
#[test]
fn every_key_is_described() {
    fn walk(value: &serde_json::Value, path: &str, bare: &mut Vec<String>) {
        let serde_json::Value::Object(object) = value else {
            if let serde_json::Value::Array(items) = value {
                for item in items {
                    walk(item, path, bare);
                }
            }
            return;
        };
        if let Some(serde_json::Value::Object(keys)) = object.get("properties") {
            for (key, of) in keys {
                if of.get("description").is_none() {
                    bare.push(format!("{path}/{key}"));
                }
            }
        }
        for (key, value) in object {
            walk(value, &format!("{path}/{key}"), bare);
        }
    }
    let mut bare = Vec::new();
    walk(&json_schema::schema(), "", &mut bare);
    assert!(bare.is_empty(), "{bare:?}");
}

#[test]
fn the_copy_in_docs_is_up_to_date() {
    let copy = std::fs::read_to_string(repository("docs/deck.schema.json")).unwrap_or_default();
    assert!(
        copy == json_schema::text(),
        "docs/deck.schema.json is old: cargo run -- schema > docs/deck.schema.json"
    );
}
