//! Limits of the sources that clippy does not check; CONTRIBUTING.md lists them.

use std::fs;
use std::path::Path;

use crate::rooms::sources;

/// Largest number of fields of a struct without a reason.
const FIELDS: usize = 15;

/// Mark of the reason in a comment above the struct.
const REASON: &str = "// More than 15 fields: ";

/// Structs of a source with their number of fields and whether a reason stands above them.
fn structs(text: &str) -> Vec<(String, usize, bool)> {
    let lines: Vec<&str> = text.lines().collect();
    let mut found = Vec::new();
    for (at, line) in lines.iter().enumerate() {
        let words = line.trim_start();
        let indent = line.len() - words.len();
        let Some((before, name)) = words.split_once("struct ") else {
            continue;
        };
        let opens = before.is_empty() || before.starts_with("pub");
        if !opens || !line.ends_with('{') {
            continue;
        }
        let body = lines[at + 1..].iter();
        let body = body.take_while(|line| {
            !(line.starts_with(&" ".repeat(indent) as &str) && line[indent..].starts_with('}'))
        });
        let is_field = |line: &&&str| {
            let one = line.strip_prefix(&" ".repeat(indent + 4) as &str);
            one.is_some_and(|one| {
                let one = one.strip_prefix("pub").map_or(one, |rest| {
                    rest.split_once(") ")
                        .map_or(rest.trim_start(), |(_, name)| name)
                });
                let name = one.split_once(": ").map_or("", |(name, _)| name);
                !name.is_empty() && name.chars().all(|c| c.is_alphanumeric() || c == '_')
            })
        };
        let above = lines[..at].iter().rev();
        let mut above = above.take_while(|line| {
            let words = line.trim_start();
            words.starts_with("//")
                || words.starts_with('#')
                || words.starts_with(')')
                || line.starts_with("    ")
        });
        let name = name.split(|c: char| !c.is_alphanumeric()).next().unwrap();
        let has_reason = above.any(|line| line.trim_start().starts_with(REASON));
        found.push((name.to_owned(), body.filter(is_field).count(), has_reason));
    }
    found
}

#[test]
fn large_structs_give_a_reason() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files = Vec::new();
    for name in ["contact", "core", "cli", "pybind"] {
        sources(&root.join("crates").join(name).join("src"), &mut files);
    }
    let mut faults = Vec::new();
    for file in &files {
        for (name, fields, has_reason) in structs(&fs::read_to_string(file).unwrap()) {
            if fields > FIELDS && !has_reason {
                let file = file.strip_prefix(root).unwrap().display();
                faults.push(format!("{file}: {name} has {fields} fields"));
            }
        }
    }
    assert!(
        faults.is_empty(),
        "{}\nabove it: {REASON}…",
        faults.join("\n")
    );
}

/// The search finds a struct without a reason and accepts one with it.
#[test]
fn fields_are_counted() {
    let fields: String = (0..16)
        .map(|i| format!("    /// Doc: it.\n    pub(crate) f{i}: f64,\n"))
        .collect();
    let large = format!("#[derive(Clone)]\npub struct Large {{\n{fields}}}\n");
    assert_eq!(structs(&large), [("Large".to_owned(), 16, false)]);
    let told = format!("{REASON}one for each column.\n{large}");
    assert_eq!(structs(&told), [("Large".to_owned(), 16, true)]);
}
