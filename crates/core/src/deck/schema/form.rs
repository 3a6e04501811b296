//! Reads a deck and finds all keys that cannot be read, not only the first.
//!
//! serde stops at the first key that it cannot read. That error is stored, a valid example replaces the value, and
//! the deck is read again until there is no error. Checks that depend on a replaced value are left out
//! ([`Broken`]).

use super::Deck;
use super::stand_in;
use crate::deck::keys::{LISTS, NAMED, TABLES, section_of};
use crate::deck::source::{Source, Trouble, join};
use crate::deck::symmetry::middle;
use crate::error::{ErrorKind, ModelError};
use serde::Deserialize;
use std::collections::BTreeSet;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Largest number of readings.
const MOST_READINGS: usize = 200;

/// Smallest number of readings, even of the longest deck.
const LEAST_READINGS: usize = 3;

/// Total number of bytes that are read: long decks are read less often, so that errors appear within seconds.
const MOST_BYTES_READ: usize = 10_000_000;

/// Paths whose values are unknown because they could not be read.
#[derive(Debug, Default)]
pub(super) struct Broken(BTreeSet<String>);

impl Broken {
    fn add(&mut self, path: &str) {
        self.0.insert(path.to_owned());
    }

    /// Returns whether the value at `path` is unknown: it, a part of it, or a table above it is broken.
    pub(super) fn holds(&self, path: &str) -> bool {
        self.0
            .iter()
            .any(|broken| lies_in(path, broken) || lies_in(broken, path))
    }

    /// Returns whether a part of the section (material, step, wall, …) that contains `path` is broken.
    pub(super) fn section(&self, path: &str) -> bool {
        self.holds(section_of(path))
    }

    /// Returns whether the section `name` as a whole is broken, so that its contents are unknown.
    pub(super) fn whole(&self, name: &str) -> bool {
        self.0.contains(name)
    }
}

/// Returns whether `path` is `above` or lies below it.
fn lies_in(path: &str, above: &str) -> bool {
    path.strip_prefix(above)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// Result of reading a deck.
pub(super) struct Form {
    /// The deck, with examples in place of values that could not be read.
    pub(super) deck: Option<Deck>,
    /// Errors of values that could not be read.
    pub(super) errors: Vec<ModelError>,
    /// Paths of these values.
    pub(super) broken: Broken,
}

/// Reads a deck with all its errors. `whole`: the whole text was valid TOML, so that an absent key is really
/// missing.
pub(super) fn read(source: &mut Source, mut root: Spanned<DeTable<'_>>, whole: bool) -> Form {
    let mut form = Form {
        deck: None,
        errors: Vec::new(),
        broken: Broken::default(),
    };
    sections(source, root.get_mut(), &mut form);
    let most = MOST_BYTES_READ / source.file_length.max(1);
    for _ in 0..most.clamp(LEAST_READINGS, MOST_READINGS) {
        let error = match Deck::deserialize(toml::Deserializer::from(root.clone())) {
            Ok(deck) => {
                form.deck = Some(deck);
                break;
            }
            Err(error) => error,
        };
        let span = error.span().unwrap_or(0..0);
        let misread = source.misread(&error);
        let mut path = misread.error.key().to_owned();
        let known = form.broken.holds(&path);
        let mended = match misread.trouble {
            Trouble::UnknownKey { meant } => {
                let above = path.rsplit_once('.').map_or("", |(above, _)| above);
                if let Some(meant) = meant {
                    form.broken.add(&join(above, &meant));
                }
                // Keys in the same table may depend on the unknown key.
                form.broken.add(&path);
                stand_in::take_away(root.get_mut(), &path)
            }
            Trouble::Missing => {
                form.broken.add(&path);
                let value = stand_in::of(&path, &span);
                value.is_some_and(|value| stand_in::set(root.get_mut(), &path, value))
            }
            Trouble::Value => {
                // If an example was tried here before, the value that contains it is replaced.
                while form.broken.0.contains(&path) {
                    let Some((above, _)) = path.rsplit_once('.') else {
                        break;
                    };
                    path.truncate(above.len());
                }
                let again = form.broken.0.contains(&path);
                form.broken.add(&path);
                let value = stand_in::of(&path, &span).filter(|_| !again);
                source.stands_as_table(&path);
                value.is_some_and(|value| stand_in::set(root.get_mut(), &path, value))
            }
        };
        let missing_in_part = !whole && misread.error.message().ends_with("is missing");
        if !known && !missing_in_part {
            form.errors.push(misread.error);
        }
        if !mended {
            break;
        }
    }
    name_middles(&mut form);
    form
}

/// Lets errors about planes of symmetry without a place name the middle of the walls.
fn name_middles(form: &mut Form) {
    let Some(deck) = &form.deck else { return };
    if deck.walls().any(|(path, _, _)| form.broken.section(&path)) {
        return;
    }
    for (i, plane) in deck.symmetry.iter().enumerate() {
        let path = format!("symmetry.{i}");
        if form.broken.holds(&format!("{path}.normal")) {
            continue;
        }
        let key = format!("{path}.at");
        let is_missing =
            |error: &&mut ModelError| error.kind() == ErrorKind::Missing && error.key() == key;
        let error = form.errors.iter_mut().find(is_missing);
        if let (Some(error), Some(middle)) = (error, middle(deck, plane.normal.index())) {
            let middle = (1e6 * middle).round() / 1e6;
            error.advise(format!(
                "write it like this: at = \"{middle} mm\"  # the middle of the walls"
            ));
        }
    }
}

/// Checks that the sections are tables or lists of tables, as their headers make them.
fn sections(source: &mut Source, root: &mut DeTable<'_>, form: &mut Form) {
    for (names, is_list) in [
        (&TABLES[..], false),
        (&NAMED[..], false),
        (&LISTS[..], true),
    ] {
        for name in names {
            let Some(value) = root.get(*name) else {
                continue;
            };
            let right = match value.get_ref() {
                DeValue::Table(_) => !is_list,
                DeValue::Array(items) => {
                    // An empty list is allowed.
                    is_list && items.iter().all(|item| item.get_ref().is_table())
                }
                _ => false,
            };
            if right {
                continue;
            }
            let named = NAMED.contains(name);
            let help = if is_list {
                format!("head each of its entries with [[{name}]]")
            } else if named {
                format!("head each of its tables with [{name}.NAME]")
            } else {
                format!("head it with [{name}], once")
            };
            let what = if is_list {
                "a list of tables"
            } else {
                "a table"
            };
            let error = source.error(name, format!("`{name}` is {what}"), &help);
            form.errors.push(error);
            form.broken.add(name);
            root.remove(*name);
        }
    }
}
