//! Modules of the core library: each uses only modules below it, as ARCHITECTURE.md describes.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Modules of `crates/core/src`, the lowest first. A module may use those before it.
const ROOMS: [&str; 17] = [
    "files",
    "input",
    "error",
    "command",
    "tensor",
    "experiment",
    "material",
    "element",
    "linear",
    "model",
    "state",
    "assembly",
    "limit",
    "solve",
    "point",
    "deck",
    "results",
];

/// Source files below a folder.
pub fn sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// Code without comments and without the unit tests at its end.
fn code(text: &str) -> String {
    let end = text.find("#[cfg(test)]\nmod tests {").unwrap_or(text.len());
    let lines = text[..end].lines();
    let lines = lines.map(|line| line.find("//").map_or(line, |at| &line[..at]));
    lines.collect::<Vec<_>>().join("\n")
}

/// Modules that a piece of code names, as in `use crate::model::Mesh` or `use crate::{model::Mesh, tensor}`.
fn named(code: &str) -> BTreeSet<String> {
    let word = |text: &str| -> String {
        let end = text.find(|c: char| !c.is_alphanumeric() && c != '_');
        text[..end.unwrap_or(text.len())].to_owned()
    };
    let mut found = BTreeSet::new();
    for (at, path) in code.match_indices("crate::") {
        let rest = &code[at + path.len()..];
        if !rest.starts_with('{') {
            found.insert(word(rest));
            continue;
        }
        let (mut depth, mut begins) = (0, true);
        for (i, c) in rest.char_indices() {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' => begins = true,
                c if begins && depth == 1 && c.is_alphabetic() => {
                    found.insert(word(&rest[i..]));
                    begins = false;
                }
                _ => {}
            }
            if depth == 0 {
                break;
            }
        }
    }
    found
}

/// Uses of modules that are not below the module of the file.
fn upward(file: &str, text: &str) -> Vec<String> {
    let first = file.split('/').next().unwrap();
    let room = first.strip_suffix(".rs").unwrap_or(first);
    if room == "lib" {
        return Vec::new();
    }
    let Some(own) = ROOMS.iter().position(|r| *r == room) else {
        return vec![format!(
            "{file}: `{room}` is none of the rooms of this test"
        )];
    };
    let above = |name: &String| name != room && !ROOMS[..own].contains(&name.as_str());
    let names = named(&code(text)).into_iter().filter(above);
    names
        .map(|name| format!("{file}: {room} uses {name}, which is not below it"))
        .collect()
}

#[test]
fn rooms_use_only_rooms_below_them() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates/core/src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    assert!(
        files.len() > 200,
        "{} files in {}",
        files.len(),
        root.display()
    );
    let mut wrong = Vec::new();
    for path in files {
        let name = path.file_name().unwrap().to_string_lossy();
        // Files of unit tests, and the small run that unit tests of several modules share.
        if name.ends_with("tests.rs") || name == "fake.rs" {
            continue;
        }
        let file = path
            .strip_prefix(&root)
            .unwrap()
            .to_string_lossy()
            .replace('\\', "/");
        wrong.extend(upward(&file, &fs::read_to_string(&path).unwrap()));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn an_arrow_that_goes_up_is_found() {
    let text =
        "use crate::{model::Mesh, results::{Curve, deck}};\n// crate::solve\nuse crate::tensor;\n";
    let found = upward("state/mod.rs", text);
    assert_eq!(
        found,
        ["state/mod.rs: state uses results, which is not below it"]
    );
    assert!(upward("solve/run.rs", "use crate::state::State;").is_empty());
    assert_eq!(
        upward("model/mesh.rs", "fn f(x: &crate::deck::Deck) {}").len(),
        1
    );
    assert_eq!(upward("attic/mod.rs", "").len(), 1);
}

/// The crates: contact is a leaf, core depends only on contact.
#[test]
fn crates_depend_downwards() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("crates");
    for (name, below) in [
        ("contact", &[][..]),
        ("core", &["wythe-contact"]),
        ("cli", &["wythe-contact", "wythe-core"]),
    ] {
        let text = fs::read_to_string(root.join(name).join("Cargo.toml")).unwrap();
        let table: toml::Table = text.parse().unwrap();
        let own = table["dependencies"].as_table().unwrap().keys();
        let own: Vec<&str> = own
            .map(String::as_str)
            .filter(|d| d.starts_with("wythe"))
            .collect();
        assert!(
            own.iter().all(|d| below.contains(d)),
            "{name} depends on {own:?}"
        );
    }
}
