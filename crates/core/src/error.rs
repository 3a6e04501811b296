//! Errors and warnings of models, with the place, the reason and the remedy.

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode, SourceSpan};
use serde::Serialize;
use std::collections::HashSet;
use std::fmt;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;

/// Wrong input: a deck that cannot be read or is not consistent.
///
/// It contains the dotted path of the key (`materials.brick.E`, `steps.1.displacement`), the position in the text,
/// and the remedy. Further errors of the same deck are attached to it.
#[derive(Clone, Debug)]
pub struct ModelError(Box<Details>);

/// Kinds of errors of models. A program can tell errors apart by their kind, whatever their words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ErrorKind {
    /// The text is no TOML.
    Syntax,
    /// A key that the table does not have.
    UnknownKey,
    /// A key, table or entry that is missing.
    Missing,
    /// A value of the wrong type or unit, beyond its bounds, or against another value.
    #[default]
    Value,
    /// A name of a block, face, set, material, interface, probe, spring or load that is not there.
    UnknownName,
    /// Two entries that exclude each other.
    Conflict,
    /// Shapes that do not fit: gaps, overlaps, faces that do not meet, places without a node.
    Geometry,
    /// A body that nothing holds.
    Unheld,
    /// More elements, points, names or steps than can be treated.
    TooMany,
    /// A table of numbers in another file that cannot be read.
    Data,
    /// A mesh of another program that cannot be read or used.
    Mesh,
    /// A file that cannot be read.
    File,
}

impl ErrorKind {
    /// Name of the kind in JSON and Python, such as `unknown-key`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Syntax => "syntax",
            Self::UnknownKey => "unknown-key",
            Self::Missing => "missing",
            Self::Value => "value",
            Self::UnknownName => "unknown-name",
            Self::Conflict => "conflict",
            Self::Geometry => "geometry",
            Self::Unheld => "unheld",
            Self::TooMany => "too-many",
            Self::Data => "data",
            Self::Mesh => "mesh",
            Self::File => "file",
        }
    }
}

#[derive(Clone, Debug)]
struct Details {
    kind: ErrorKind,
    message: String,
    key: String,
    help: String,
    /// One text shared by all errors of a deck.
    source: NamedSource<Arc<str>>,
    span: Option<Range<usize>>,
    place: Place,
    others: Vec<ModelError>,
    warnings: Vec<Warning>,
}

/// Whether a character acts on a terminal instead of being visible: control characters other than line breaks and
/// tabs, and those that change the direction of writing.
pub(crate) fn is_hidden(c: char) -> bool {
    (c.is_control() && !matches!(c, '\n' | '\t'))
        || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// Makes a text printable on a terminal: hidden characters are written as escapes such as `\u{1b}`.
pub(crate) fn printable(text: String) -> String {
    if !text.contains(is_hidden) {
        return text;
    }
    let mut shown = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if is_hidden(c) {
            shown.extend(c.escape_default());
        } else {
            shown.push(c);
        }
    }
    shown
}

/// The same with an equal number of bytes, so that positions remain valid: hidden characters become question marks.
pub(crate) fn printable_in_place(text: &str) -> String {
    let shown = |c: char| (c, if is_hidden(c) { c.len_utf8() } else { 0 });
    let mut out = String::with_capacity(text.len());
    for (c, marks) in text.chars().map(shown) {
        match marks {
            0 => out.push(c),
            n => out.extend(std::iter::repeat_n('?', n)),
        }
    }
    out
}

/// Largest number of errors of one deck that are shown one by one.
pub const MOST_ERRORS: usize = 200;

impl ModelError {
    /// An error at `span` (bytes) of a file, of which name and text are given.
    pub fn new(
        (file, text): (&str, impl Into<Arc<str>>),
        span: Option<Range<usize>>,
        key: impl Into<String>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> Self {
        let text = text.into();
        let length = text.len();
        Self(Box::new(Details {
            kind: ErrorKind::default(),
            message: printable(message.into()),
            key: printable(key.into()),
            help: printable(help.into()),
            source: NamedSource::new(printable(file.to_owned()), text),
            span: span.map(|s| s.start.min(length)..s.end.min(length)),
            place: Place::default(),
            others: Vec::new(),
            warnings: Vec::new(),
        }))
    }

    /// Sets the kind.
    #[must_use]
    pub fn of_kind(mut self, kind: ErrorKind) -> Self {
        self.0.kind = kind;
        self
    }

    /// Replaces the advice.
    pub(crate) fn advise(&mut self, help: String) {
        self.0.help = help;
    }

    /// Sets the position of this error in the order of all errors.
    #[must_use]
    pub(crate) fn at(mut self, place: Place) -> Self {
        self.0.place = place;
        self
    }

    /// Joins several errors. The first leads and the others follow, each once. Errors beyond [`MOST_ERRORS`] are
    /// counted in a last one. `None` if there is no error.
    pub fn gather(errors: Vec<Self>) -> Option<Self> {
        let mut seen = HashSet::new();
        let mut warnings = Vec::new();
        let mut all = Vec::new();
        for mut error in errors {
            let others = std::mem::take(&mut error.0.others);
            warnings.append(&mut error.0.warnings);
            for error in std::iter::once(error).chain(others) {
                let where_and_what = (error.0.span.clone(), error.key().to_owned());
                let said = (where_and_what, error.message().to_owned());
                if seen.insert(said) {
                    all.push(error);
                }
            }
        }
        if all.len() > MOST_ERRORS {
            let left = all.len() - MOST_ERRORS;
            let message = format!("{left} more errors are not shown");
            let mut rest = all[MOST_ERRORS].alone();
            (rest.0.key, rest.0.span, rest.0.message) = (String::new(), None, message);
            rest.0.help =
                String::from("correct those above first: many errors often have one cause");
            all.truncate(MOST_ERRORS);
            all.push(rest);
        }
        let mut all = all.into_iter();
        let mut first = all.next()?;
        first.0.others.extend(all);
        first.0.warnings = warnings;
        Some(first)
    }

    /// Adds warnings for the author of the deck.
    #[must_use]
    pub fn with_warnings(mut self, warnings: Vec<Warning>) -> Self {
        self.0.warnings.extend(warnings);
        self
    }

    /// Kind of the error.
    pub fn kind(&self) -> ErrorKind {
        self.0.kind
    }

    /// Description of the error, without its position.
    pub fn message(&self) -> &str {
        &self.0.message
    }

    /// Dotted path of the key, with array indices from zero. Empty for the file as a whole.
    pub fn key(&self) -> &str {
        &self.0.key
    }

    /// Remedy.
    pub fn advice(&self) -> &str {
        &self.0.help
    }

    /// Name of the file, or `--set KEY` for an override.
    pub fn file(&self) -> &str {
        self.0.source.name()
    }

    /// Line from 1, if the error has a position.
    pub fn line(&self) -> Option<usize> {
        self.position().map(|p| p.0)
    }

    /// Column from 1, in characters.
    pub fn column(&self) -> Option<usize> {
        self.position().map(|p| p.1)
    }

    /// Other errors of the same deck.
    pub fn others(&self) -> &[Self] {
        &self.0.others
    }

    /// This error and the others of the same deck.
    pub fn all(&self) -> impl Iterator<Item = &Self> {
        std::iter::once(self).chain(&self.0.others)
    }

    /// This error without the others.
    #[must_use]
    pub fn alone(&self) -> Self {
        let mut alone = self.clone();
        alone.0.others.clear();
        alone.0.warnings.clear();
        alone
    }

    /// Warnings of the same deck.
    pub fn warnings(&self) -> &[Warning] {
        &self.0.warnings
    }

    fn position(&self) -> Option<(usize, usize)> {
        let start = self.0.span.as_ref()?.start;
        let before = self.0.source.inner().get(..start)?;
        let line_start = before.rfind('\n').map_or(0, |i| i + 1);
        let line = before.matches('\n').count() + 1;
        Some((line, before[line_start..].chars().count() + 1))
    }
}

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.key().is_empty() {
            write!(f, "{}", self.message())
        } else {
            write!(f, "{}: {}", self.key(), self.message())
        }
    }
}

impl std::error::Error for ModelError {}

impl Diagnostic for ModelError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        (!self.0.help.is_empty()).then(|| Box::new(&self.0.help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.0.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let span = self.0.span.clone()?;
        let label = LabeledSpan::new_with_span(Some("here".to_owned()), SourceSpan::from(span));
        Some(Box::new(std::iter::once(label)))
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn Diagnostic> + 'a>> {
        if self.0.others.is_empty() {
            return None;
        }
        Some(Box::new(self.0.others.iter().map(|e| e as &dyn Diagnostic)))
    }
}

/// Position of an error in the order of all errors of its deck: section by section, and in each section existing keys
/// before missing ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Place {
    /// First byte of the section.
    pub(crate) section: usize,
    /// Whether the key is missing.
    pub(crate) absent: bool,
    /// Byte of the error.
    pub(crate) start: usize,
}

/// Errors of a pass that continues after each of them.
#[derive(Debug, Default)]
pub(crate) struct Errors(Vec<ModelError>);

impl Errors {
    pub(crate) fn push(&mut self, error: ModelError) {
        self.0.push(error);
    }

    /// The value. An error is stored for later.
    pub(crate) fn keep<T>(&mut self, result: Result<T, ModelError>) -> Option<T> {
        result.map_err(|error| self.push(error)).ok()
    }

    /// The value if there was no error, else all errors as one, in the order of the text.
    pub(crate) fn end<T>(self, value: T) -> Result<T, ModelError> {
        self.gather().map_or(Ok(value), Err)
    }

    /// All errors with this one.
    pub(crate) fn and(mut self, error: ModelError) -> ModelError {
        self.push(error.clone());
        self.gather().unwrap_or(error)
    }

    fn gather(self) -> Option<ModelError> {
        let mut errors: Vec<ModelError> = Vec::new();
        for mut error in self.0 {
            let others = std::mem::take(&mut error.0.others);
            errors.push(error);
            errors.extend(others);
        }
        errors.sort_by_key(|error| error.0.place);
        ModelError::gather(errors)
    }
}

/// A file that could not be read or written (exit code 4 of the command).
#[derive(Debug, thiserror::Error, Diagnostic)]
#[error("{}: {why}", path.display())]
#[diagnostic(help("{}", io_advice(why)))]
pub struct IoError {
    /// The file.
    pub path: PathBuf,
    /// Error of the system.
    pub why: std::io::Error,
}

fn io_advice(error: &std::io::Error) -> &'static str {
    match error.kind() {
        std::io::ErrorKind::NotFound => "check the path; it is relative to the current folder",
        std::io::ErrorKind::PermissionDenied => "check the permissions of the file and its folder",
        std::io::ErrorKind::InvalidData => "this file must be text in UTF-8: save it so",
        std::io::ErrorKind::IsADirectory => "this is a folder: name a file",
        std::io::ErrorKind::StorageFull => "the disk is full: make room, or write elsewhere",
        _ => "the file system refused",
    }
}

/// Error of reading a deck from disk: in the file or in its content.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum DeckError {
    /// The file could not be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Io(#[from] IoError),
    /// The deck is wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Model(#[from] ModelError),
}

/// A valid property of a model of which its author should know.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Warning {
    /// Dotted path of the key concerned.
    pub key: String,
    /// Line of the deck, from 1, if the key is there.
    pub line: Option<usize>,
    /// Its column, from 1, in characters.
    pub column: Option<usize>,
    /// Description and its consequences.
    pub message: String,
    /// Number of further warnings of this kind in other places.
    pub others: usize,
}

impl Warning {
    /// Keeps the first of several warnings of one kind, with the number of the others. Warnings are of one kind if
    /// their keys and messages differ in numbers and names only.
    pub(crate) fn counted(all: Vec<Self>) -> Vec<Self> {
        let mut kinds: Vec<(String, Self)> = Vec::new();
        for warning in all {
            let key: String = kind_of(&warning.key.replace('.', " "));
            let kind = format!("{key}: {}", kind_of(&warning.message));
            match kinds.iter_mut().find(|(known, _)| *known == kind) {
                Some((_, first)) => first.others += 1 + warning.others,
                None => kinds.push((kind, warning)),
            }
        }
        kinds.into_iter().map(|(_, warning)| warning).collect()
    }
}

/// Text with a placeholder for words that contain digits or are quoted.
fn kind_of(text: &str) -> String {
    let mut quoted = false;
    let mut words = Vec::new();
    for word in text.split_whitespace() {
        let quotes = word.matches('`').count();
        let names = quoted || quotes > 0 || word.contains(|c: char| c.is_ascii_digit());
        quoted ^= quotes % 2 == 1;
        words.push(if names { "#" } else { word });
    }
    words.dedup();
    words.join(" ")
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            Some(line) => write!(f, "{} (line {line}): {}", self.key, self.message)?,
            None => write!(f, "{}: {}", self.key, self.message)?,
        }
        match self.others {
            0 => Ok(()),
            others => write!(f, " (and {others} more of this kind)"),
        }
    }
}
