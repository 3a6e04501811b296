//! The form of a deck: every key that cannot be read, and not the first.
//!
//! serde stops at the first key that it cannot take. So that key is noted, an example of what would be
//! right stands in for it, and the deck is read again, until there is nothing left to say. What rests on
//! a stand-in is not judged ([`Broken`]).

use super::Deck;
use super::stand_in;
use crate::deck::keys::{LISTS, NAMED, TABLES, section_of};
use crate::deck::source::{Source, Trouble, join};
use crate::error::ModelError;
use serde::Deserialize;
use std::collections::BTreeSet;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// More readings than these help nobody.
const MOST_READINGS: usize = 200;

/// Readings that even the longest deck gets.
const LEAST_READINGS: usize = 3;

/// Bytes that are read in all: a long deck is read less often, so that its errors come within seconds.
const MOST_BYTES_READ: usize = 10_000_000;

/// Paths whose values are not known, because what is written there could not be read.
#[derive(Debug, Default)]
pub(super) struct Broken(BTreeSet<String>);

impl Broken {
    fn add(&mut self, path: &str) {
        self.0.insert(path.to_owned());
    }

    /// Nothing can be said of the value at `path`: it, or what it lies in, or a part of it is broken.
    pub(super) fn holds(&self, path: &str) -> bool {
        self.0
            .iter()
            .any(|broken| lies_in(path, broken) || lies_in(broken, path))
    }

    /// Something is broken in the section (material, step, wall …) in which `path` lies.
    pub(super) fn section(&self, path: &str) -> bool {
        self.holds(section_of(path))
    }

    /// The section `name` as a whole is broken, so that it is not known what stands in it.
    pub(super) fn whole(&self, name: &str) -> bool {
        self.0.contains(name)
    }
}

/// `path` is `above` or lies below it.
fn lies_in(path: &str, above: &str) -> bool {
    path.strip_prefix(above)
        .is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
}

/// What could be read of a deck.
pub(super) struct Form {
    /// The deck, with stand-ins for what could not be read.
    pub(super) deck: Option<Deck>,
    /// What could not be read.
    pub(super) errors: Vec<ModelError>,
    /// Where.
    pub(super) broken: Broken,
}

/// Reads all that can be read. `whole`: the text was TOML throughout, so that a key that is not there is
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
                // Whatever it was to say, the keys beside it may rest on it.
                form.broken.add(&path);
                stand_in::take_away(root.get_mut(), &path)
            }
            Trouble::Missing => {
                form.broken.add(&path);
                let value = stand_in::of(&path, &span);
                value.is_some_and(|value| stand_in::set(root.get_mut(), &path, value))
            }
            Trouble::Value => {
                // A stand-in that will not do either gives way to one of what it lies in.
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
    form
}

/// Sees that the sections are tables and lists of tables, as their headers make them.
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
                    // No entry says nothing, in whatever list.
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
