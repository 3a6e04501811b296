//! Bounds on the size of a deck, checked before its keys are read: any file is then checked in bounded time and
//! memory.

use crate::deck::source::Source;
use crate::error::{ErrorKind, ModelError, is_hidden};
use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Longest text of a deck [bytes]: some 100,000 blocks.
pub const MOST_BYTES: usize = 1 << 24;

/// Largest depth of nested tables and lists; the deepest key of a deck, a unit of a pattern, has depth seven.
const DEEPEST: usize = 16;

/// Longest name of a key, a material or an interface [bytes].
const LONGEST_KEY: usize = 200;

/// Longest name, quantity or path of a file [bytes].
const LONGEST_TEXT: usize = 1000;

/// Largest total length of the paths of all values [bytes]: all are stored, so that errors can point at them.
const MOST_PATHS: usize = 1 << 26;

/// Rejects a text that is too long.
pub(super) fn judge_text(file: &str, text: &str) -> Result<(), ModelError> {
    if text.len() <= MOST_BYTES {
        return Ok(());
    }
    let message = format!("{} bytes are too many for a deck", text.len());
    let help =
        format!("at most {MOST_BYTES}: describe many blocks by `copies`, `stack` or [[imports]]");
    Err(ModelError::new((file, ""), None, "", message, help).of_kind(ErrorKind::TooMany))
}

/// Rejects the path of an override that is deeper than any key.
pub(super) fn judge_path(path: &str) -> Result<(), String> {
    if path.len() <= DEEPEST * LONGEST_KEY && path.split('.').count() <= DEEPEST {
        return Ok(());
    }
    Err(format!("the path has more than {DEEPEST} parts"))
}

/// Rejects keys that are too long, too deep or too many.
pub(super) fn judge_keys(source: &Source, root: &DeTable<'_>) -> Result<(), ModelError> {
    let mut judge = Judge {
        source,
        path: String::new(),
        left: MOST_PATHS,
    };
    judge.table(root, 1)
}

struct Judge<'a> {
    source: &'a Source,
    /// Path of the current value.
    path: String,
    /// Remaining length of paths [bytes].
    left: usize,
}

impl Judge<'_> {
    /// Checks the keys of the table at the current path, which has the depth `depth`.
    fn table(&mut self, table: &DeTable<'_>, depth: usize) -> Result<(), ModelError> {
        let above = self.path.len();
        for (key, value) in table {
            let name = key.get_ref();
            if name.len() > LONGEST_KEY {
                let message = format!("a key of {} bytes", name.len());
                let help = format!(
                    "names of keys, materials and interfaces have at most {LONGEST_KEY} bytes"
                );
                return Err(self.wrong(key.span(), message, &help));
            }
            // A title may be any text; hidden characters in it are written as escapes.
            if above == 0 && name == "title" && value.get_ref().is_str() {
                continue;
            }
            self.below(name);
            self.plain(name, key.span())?;
            self.value(value, depth)?;
            self.path.truncate(above);
        }
        Ok(())
    }

    /// Appends a key or an index to the path.
    fn below(&mut self, name: &str) {
        if !self.path.is_empty() {
            self.path.push('.');
        }
        self.path.push_str(name);
    }

    fn wrong(&self, bytes: Range<usize>, message: String, help: &str) -> ModelError {
        self.source.error_of_bytes(bytes, &self.path, message, help)
    }

    fn value(&mut self, value: &Spanned<DeValue<'_>>, depth: usize) -> Result<(), ModelError> {
        let deep =
            matches!(value.get_ref(), DeValue::Table(_) | DeValue::Array(_)) && depth == DEEPEST;
        let left = self.left.checked_sub(self.path.len());
        let (Some(left), false) = (left, deep) else {
            let (message, help) = if deep {
                (
                    format!("{DEEPEST} tables or lists within each other"),
                    "no key of a deck lies so deep",
                )
            } else {
                (
                    "the deck has too many keys".to_owned(),
                    "describe many blocks by `copies`, `stack` or [[imports]]",
                )
            };
            return Err(self.wrong(value.span(), message, help));
        };
        self.left = left;
        match value.get_ref() {
            DeValue::Table(table) => self.table(table, depth + 1),
            DeValue::Array(items) => {
                let above = self.path.len();
                for (i, item) in items.iter().enumerate() {
                    self.below(&i.to_string());
                    self.value(item, depth + 1)?;
                    self.path.truncate(above);
                }
                Ok(())
            }
            DeValue::String(text) => self.plain(text, value.span()),
            _ => Ok(()),
        }
    }

    /// Rejects a text with control characters that a terminal would obey: names appear in messages, columns and
    /// files.
    fn plain(&self, text: &str, bytes: Range<usize>) -> Result<(), ModelError> {
        if text.len() > LONGEST_TEXT {
            let message = format!("a text of {} bytes", text.len());
            let help = format!("names and paths have at most {LONGEST_TEXT} bytes");
            return Err(self.wrong(bytes, message, &help));
        }
        match text.chars().find(|c| is_hidden(*c)) {
            None => Ok(()),
            Some(c) => {
                let message = format!("the character {} stands in this text", c.escape_default());
                let help =
                    "names are of characters that can be seen; only the title may say anything";
                Err(self.wrong(bytes, message, help))
            }
        }
    }
}
