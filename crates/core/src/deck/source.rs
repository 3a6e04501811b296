//! Positions of the keys of a deck in its text, so that errors can point at them.

use super::keys;
use crate::error::{self as errors, ErrorKind, ModelError, Warning};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Text of a deck and the position of every key in it.
///
/// Overrides are appended to the text as lines of their own, so that one range of bytes identifies both the source
/// and the position in it.
#[derive(Clone, Default)]
pub struct Source {
    /// Name of the file.
    pub(super) file: String,
    /// Text of the file, then one line for each override.
    pub(super) text: String,
    /// Length of the text of the file [bytes].
    pub(super) file_length: usize,
    /// Text of the file, which all errors share.
    file_text: Arc<str>,
    /// First byte of each line.
    lines: Vec<usize>,
    /// Byte range of the line of each override, and its key. `[override]`
    pub(super) overrides: Vec<(Range<usize>, String)>,
    /// Byte ranges of the key and of its value, by dotted path.
    places: BTreeMap<String, Place>,
    /// Folder to which file names in the deck are relative; none: the folder of the file.
    pub(super) folder: Option<PathBuf>,
    /// Advice for the key at a path; none: the advice for decks.
    advice: Option<fn(&str) -> String>,
    /// Paths of generated tables, and the paths in the file from which they were made.
    written_out: Vec<(String, String)>,
}

/// Prints only the name: the text would make a printed deck unreadable.
impl std::fmt::Debug for Source {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Source({})", self.file)
    }
}

#[derive(Clone)]
struct Place {
    key: Range<usize>,
    value: Range<usize>,
    is_table: bool,
}

impl Source {
    /// A source without positions.
    pub(super) fn new(file: &str, text: &str) -> Self {
        let (file, text, file_length) = (file.to_owned(), text.to_owned(), text.len());
        Self {
            file,
            file_length,
            file_text: errors::printable_in_place(&text).into(),
            lines: std::iter::once(0)
                .chain(text.match_indices('\n').map(|(i, _)| i + 1))
                .collect(),
            text,
            overrides: Vec::new(),
            places: BTreeMap::new(),
            folder: None,
            advice: None,
            written_out: Vec::new(),
        }
    }

    /// Findings at `path` or below refer to the key `from` of the file.
    pub(super) fn stands_for(&mut self, path: String, from: String) {
        self.written_out.push((path, from));
    }

    /// Path in the file of a path that may have been generated.
    pub(super) fn said<'a>(&'a self, path: &'a str) -> &'a str {
        let is = |(table, _): &&(String, String)| {
            let below = path.strip_prefix(table.as_str());
            below.is_some_and(|below| below.is_empty() || below.starts_with('.'))
        };
        let from = self.written_out.iter().find(is);
        from.map_or(path, |(_, from)| from)
    }

    /// Parses a file other than a deck, with the positions of all its keys and with its own advice for keys.
    ///
    /// # Errors
    /// Syntax errors.
    pub fn other<'t>(
        file: &str,
        text: &'t str,
        advice: fn(&str) -> String,
    ) -> Result<(Self, Spanned<DeTable<'t>>), ModelError> {
        let mut source = Self::new(file, text);
        source.advice = Some(advice);
        let root = DeTable::parse(text).map_err(|e| source.toml_error(&e))?;
        source.locate(root.get_ref());
        Ok((source, root))
    }

    fn advice(&self, path: &str) -> String {
        self.advice
            .map_or_else(|| keys::example_at(path), |of| of(path))
    }

    /// Appends the line of an override; returns the first byte of its value.
    pub(super) fn append_override(&mut self, key: &str, value: &str) -> usize {
        self.text.push('\n');
        let start = self.text.len();
        self.text.push_str(key);
        self.text.push('=');
        let value_start = self.text.len();
        self.text.push_str(value);
        self.overrides
            .push((start..self.text.len(), key.to_owned()));
        value_start
    }

    /// Stores the position of every key below `table`.
    pub(super) fn locate(&mut self, table: &DeTable<'_>) {
        self.places.clear();
        self.locate_table(table, "");
    }

    fn locate_table(&mut self, table: &DeTable<'_>, prefix: &str) {
        for (key, value) in table {
            self.locate_value(value, join(prefix, key.get_ref()), key.span());
        }
    }

    fn locate_value(&mut self, value: &Spanned<DeValue<'_>>, path: String, key: Range<usize>) {
        match value.get_ref() {
            DeValue::Table(table) => self.locate_table(table, &path),
            DeValue::Array(array) => {
                for (i, item) in array.iter().enumerate() {
                    self.locate_value(item, join(&path, &i.to_string()), item.span());
                }
            }
            _ => {}
        }
        let is_table = value.get_ref().is_table();
        self.places.insert(
            path,
            Place {
                key,
                value: value.span(),
                is_table,
            },
        );
    }

    /// Returns whether the key `path` is written, in the file or in an override.
    pub(super) fn has(&self, path: &str) -> bool {
        self.places.contains_key(path)
    }

    /// Byte range of the value at `path`, or of the nearest table above it that is written.
    fn span(&self, path: &str) -> Option<Range<usize>> {
        let mut path = path;
        loop {
            if let Some(place) = self.places.get(path) {
                return Some(place.value.clone());
            }
            path = path.rsplit_once('.')?.0;
        }
    }

    /// Line and column of `path` in the file, from 1.
    fn position(&self, path: &str) -> Option<(usize, usize)> {
        let start = self.places.get(path)?.value.start;
        let line = self.line_of(start);
        let begin = *self.lines.get(line - 1)?;
        let before = self.text[..self.file_length].get(begin..start)?;
        Some((line, before.chars().count() + 1))
    }

    /// Line of the file, from 1, that contains a byte.
    pub(super) fn line_of(&self, byte: usize) -> usize {
        self.lines.partition_point(|begin| *begin <= byte).max(1)
    }

    /// Dotted path of the key or value at these bytes: the smallest one that contains them.
    fn path_at(&self, span: &Range<usize>) -> Option<&str> {
        let contains = |r: &Range<usize>| r.start <= span.start && span.end <= r.end;
        self.places
            .iter()
            .filter_map(|(path, place)| {
                let hit = [&place.key, &place.value]
                    .into_iter()
                    .filter(|r| contains(r));
                hit.map(|r| r.end - r.start)
                    .min()
                    .map(|width| (width, path))
            })
            .min_by_key(|(width, path)| (*width, std::cmp::Reverse(path.len())))
            .map(|(_, path)| path.as_str())
    }

    /// Dotted path of the table at these bytes; empty for the root.
    fn table_at(&self, span: &Range<usize>) -> &str {
        let found = self
            .places
            .iter()
            .find(|(_, p)| p.is_table && p.value == *span);
        found.map_or("", |(path, _)| path.as_str())
    }

    /// An error about the key `path`; if no key is found, it points at the start of the file.
    pub fn error(&self, path: &str, message: impl Into<String>, help: &str) -> ModelError {
        let path = self.said(path);
        let span = self.span(path).unwrap_or(0..0);
        self.error_at(Some(span), path, message.into(), help)
    }

    /// An error about a range of bytes, before the positions of keys are known.
    pub(super) fn error_of_bytes(
        &self,
        bytes: Range<usize>,
        path: &str,
        message: String,
        help: &str,
    ) -> ModelError {
        self.error_in(Some(bytes), path, message, help)
    }

    /// A warning about the key `path`.
    pub fn warning(&self, path: &str, message: impl Into<String>) -> Warning {
        let path = self.said(path);
        let (line, column) = self.position(path).unzip();
        Warning {
            key: errors::printable(path.to_owned()),
            line,
            column,
            message: errors::printable(message.into()),
            others: 0,
        }
    }

    fn error_at(
        &self,
        span: Option<Range<usize>>,
        path: &str,
        message: String,
        help: &str,
    ) -> ModelError {
        let start = span.as_ref().map_or(0, |span| span.start);
        let section = self.span(keys::section_of(path));
        let place = errors::Place {
            section: match section {
                Some(section) if start < self.file_length => section.start.min(start),
                _ => start,
            },
            absent: !path.is_empty() && !self.places.contains_key(path),
            start,
        };
        self.error_in(span, path, message, help).at(place)
    }

    /// Builds the error with the text of the file, or with that of the override which sets the key.
    fn error_in(
        &self,
        span: Option<Range<usize>>,
        path: &str,
        message: String,
        help: &str,
    ) -> ModelError {
        if let Some(span) = &span
            && let Some((line, key)) = self.overrides.iter().find(|(l, _)| {
                l.start <= span.start && span.start <= l.end && span.end <= l.end.max(span.start)
            })
        {
            let within = span.start - line.start..span.end - line.start;
            let text = errors::printable_in_place(&self.text[line.clone()]);
            return ModelError::new(
                (&format!("--set {key}"), text),
                Some(within),
                path,
                message,
                help,
            );
        }
        ModelError::new(
            (&self.file, Arc::clone(&self.file_text)),
            span,
            path,
            message,
            help,
        )
    }

    /// Byte range of the key of the `i`-th override.
    pub(super) fn override_key(&self, i: usize) -> Range<usize> {
        let (line, key) = &self.overrides[i];
        line.start..line.start + key.len()
    }

    /// An error: the `i`-th override cannot be applied.
    pub(super) fn override_error(&self, i: usize, message: String) -> ModelError {
        let help = "the path is dotted, arrays count from 0: --set steps.1.increments.max=0.02";
        self.error_at(
            Some(self.override_key(i)),
            &self.overrides[i].1,
            message,
            help,
        )
    }

    /// Converts an error of serde or of the TOML parser; adds the path of the key and advice.
    pub fn toml_error(&self, error: &toml::de::Error) -> ModelError {
        if self.places.is_empty() {
            // Positions are unknown until the text is parsed.
            return self.syntax_error(error);
        }
        self.misread(error).error
    }

    /// Converts an error of the TOML parser.
    pub(super) fn syntax_error(&self, error: &toml::de::Error) -> ModelError {
        let help = "the text is no TOML here: strings want quotes, each key its own line";
        let error = self.error_at(error.span(), "", in_a_line(error), help);
        error.of_kind(ErrorKind::Syntax)
    }

    /// Converts an error of serde, and classifies it.
    pub(super) fn misread(&self, error: &toml::de::Error) -> Misread {
        let span = error.span();
        let message = in_a_line(error);
        // The message names Rust's integer types.
        let message = ["u64", "u32", "usize"].iter().fold(message, |text, name| {
            text.replace(
                &format!("expected {name}"),
                "expected a whole number from 0",
            )
        });
        let at = span
            .as_ref()
            .and_then(|s| self.path_at(s))
            .unwrap_or_default();
        if let Some(name) = quoted(&message).filter(|_| message.starts_with("missing field")) {
            let path = join(span.as_ref().map_or("", |s| self.table_at(s)), name);
            let message = format!("the key `{name}` is missing");
            let help = self.advice(&path);
            return Misread {
                trouble: Trouble::Missing,
                error: (self.error_at(span, &path, message, &help)).of_kind(ErrorKind::Missing),
            };
        }
        if let Some(name) = quoted(&message).filter(|_| message.starts_with("unknown")) {
            let known = message.split('`').skip(3).step_by(2);
            let near = keys::nearest(name, known.clone());
            let help = match near {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("known here: {}", known.collect::<Vec<_>>().join(", ")),
            };
            let is_key = message.starts_with("unknown field");
            let (kind, trouble) = if is_key {
                let meant = near.map(str::to_owned);
                ("key", Trouble::UnknownKey { meant })
            } else {
                ("choice", Trouble::Value)
            };
            let message = format!("`{name}` is not a known {kind}");
            let error = self.error_at(span, at, message, &help);
            let error = match &trouble {
                Trouble::UnknownKey { .. } => error.of_kind(ErrorKind::UnknownKey),
                _ => error,
            };
            return Misread { trouble, error };
        }
        Misread {
            trouble: Trouble::Value,
            error: self.error_at(span, at, message, &self.advice(at)),
        }
    }

    /// Treats the value at `path` as a table from now on.
    pub(super) fn stands_as_table(&mut self, path: &str) {
        if let Some(place) = self.places.get_mut(path) {
            place.is_table = true;
        }
    }
}

/// A classified error of serde.
pub(super) struct Misread {
    pub(super) trouble: Trouble,
    pub(super) error: ModelError,
}

/// Kinds of errors of serde.
pub(super) enum Trouble {
    /// An unknown key, and the known one that was probably meant.
    UnknownKey { meant: Option<String> },
    /// A missing key.
    Missing,
    /// A value of the wrong type or unit, or an unknown choice.
    Value,
}

/// Message of an error, without line breaks.
fn in_a_line(error: &toml::de::Error) -> String {
    let message = error.message().trim_end();
    // Serde accepts a table for a choice; decks write choices as strings only.
    let message = message.replace(
        "wanted string or table",
        "expected one of the choices, in quotes",
    );
    message.replace('\n', ", ")
}

/// `prefix.key`, or `key` at the root.
pub(super) fn join(prefix: &str, key: &str) -> String {
    if prefix.is_empty() {
        key.to_owned()
    } else {
        format!("{prefix}.{key}")
    }
}

/// First word of a message in back quotes.
fn quoted(message: &str) -> Option<&str> {
    message.split('`').nth(1)
}
