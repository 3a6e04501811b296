//! `--set KEY=VALUE`: replaces one key of the deck, with the same checks as in the file.

use std::borrow::Cow;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Pairs of exclusive keys: setting one removes the other.
const EITHER_OR: [(&str, &str); 8] = [
    ("u_k", "G_I"),
    ("delta_k", "G_II"),
    ("radius", "span"),
    ("radius", "rise"),
    ("rise", "angle"),
    ("size", "corners"),
    ("size", "nodes"),
    ("corners", "nodes"),
];

/// An earlier override that excludes the last one: both set one of a pair of exclusive keys of the same table.
pub(super) fn excluded(overrides: &[(String, String)]) -> Option<&str> {
    let ((last, _), earlier) = overrides.split_last()?;
    let (table, key) = last.rsplit_once('.').unwrap_or(("", last));
    let other = |(a, b): &(&'static str, &'static str)| match key {
        key if key == *a => Some(*b),
        key if key == *b => Some(*a),
        _ => None,
    };
    let others: Vec<&str> = EITHER_OR.iter().filter_map(other).collect();
    let mut earlier = earlier.iter().map(|(path, _)| path.as_str());
    earlier.find(|path| {
        let (of, key) = path.rsplit_once('.').unwrap_or(("", path));
        of == table && others.contains(&key)
    })
}

/// A TOML text whose only value begins at byte `start`: its spans are then those of the source to which the
/// override was appended.
pub(super) fn padded(value: &str, start: usize) -> String {
    format!("{}v={value}", "\n".repeat(start - 2))
}

/// The value of a [`padded`] text; a text that is no TOML counts as a string.
pub(super) fn parse(padded: &str, start: usize) -> Spanned<DeValue<'_>> {
    let text = || Spanned::new(start..padded.len(), DeValue::String(padded[start..].into()));
    match DeTable::parse(padded) {
        // Several keys mean that the value contained a line break and further keys.
        Ok(table) if table.get_ref().len() == 1 => {
            table.into_inner().remove("v").unwrap_or_else(text)
        }
        _ => text(),
    }
}

/// Sets the key at the dotted path (arrays counted from zero) below `table`. The path stands at byte `at` of the
/// source.
///
/// # Errors
/// A sentence, if the path leads through a value that is no table, or to an array entry that does not exist.
pub(super) fn set<'a>(
    table: &mut DeTable<'a>,
    path: &'a str,
    at: usize,
    value: Spanned<DeValue<'a>>,
) -> Result<(), String> {
    let (part, below) = first_part(path);
    if part.is_empty() {
        return Err("the key is not a dotted path".to_owned());
    }
    let span = at..at + part.len();
    let name = Spanned::new(span.clone(), Cow::Borrowed(part));
    let Some(below) = below else {
        for (a, b) in EITHER_OR {
            if part == a {
                table.remove(b);
            } else if part == b {
                table.remove(a);
            }
        }
        table.remove(part);
        table.insert(name, value);
        return Ok(());
    };
    if !table.contains_key(part) {
        let empty = DeValue::Table(DeTable::new());
        table.insert(name, Spanned::new(span.clone(), empty));
    }
    match table.get_mut(part) {
        Some(inner) => set_value(inner, part, below, span.end + 1, value),
        None => Err(format!("`{part}` could not be made")),
    }
}

/// The first part of a path, and the rest.
fn first_part(path: &str) -> (&str, Option<&str>) {
    let parts = path.split_once('.');
    parts.map_or((path, None), |(part, below)| (part, Some(below)))
}

fn set_value<'a>(
    inside: &mut Spanned<DeValue<'a>>,
    name: &str,
    path: &'a str,
    at: usize,
    value: Spanned<DeValue<'a>>,
) -> Result<(), String> {
    match inside.get_mut() {
        DeValue::Table(table) => set(table, path, at, value),
        DeValue::Array(array) => {
            let (part, below) = first_part(path);
            let count = array.len();
            let entry = part
                .parse::<usize>()
                .ok()
                .and_then(|i| array.get_mut(i))
                .ok_or_else(|| {
                    let entries = if count == 1 { "entry" } else { "entries" };
                    format!(
                        "`{name}` has {count} {entries}, counted from 0: there is no `{name}.{part}`"
                    )
                })?;
            if let Some(below) = below {
                set_value(entry, part, below, at + part.len() + 1, value)
            } else {
                *entry = value;
                Ok(())
            }
        }
        _ => Err(format!("`{name}` is no table: it has no `{path}`")),
    }
}
