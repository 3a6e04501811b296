//! A case of the atlas: a deck, what happens in it, and what must come out.

use std::path::{Path, PathBuf};

use miette::Diagnostic;
use serde::Deserialize;

use super::expect::Expectation;
use super::judge::Terms;
use super::written::{self, CaseFile};
use wythe_core::error::{DeckError, IoError, ModelError};

/// A deck, what happens in it and why methods fail there, and what must come out.
///
/// A case is a folder with `case.toml`, or with `case-a.toml`, `case-b.toml` … for several of one number; `tests/stability/README.md` lists the keys.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its number in the atlas.
    pub number: u32,
    /// Its letter, where several cases share a folder and a number.
    pub part: String,
    /// Title.
    pub title: String,
    /// What happens, and why methods fail here.
    pub mechanics: String,
    /// Where the reference comes from.
    pub source: String,
    /// The deck's file.
    pub deck: PathBuf,
    /// Steps of the deck that take the method; every one but preloads if not said.
    pub steps: Option<Vec<usize>>,
    /// The form that the tests run.
    pub short: Short,
    /// Largest energy imbalance (theory/energies.md, eq. 18) [-].
    pub energy: f64,
    /// Why the energy imbalance may be another than usual.
    pub why: String,
    /// How the run must end.
    pub status: End,
    /// Methods of its own in the place of [`METHODS`](super::METHODS); empty if those apply.
    pub methods: Vec<CaseMethod>,
    /// What must come out; all of it.
    pub expect: Vec<Expectation>,
}

/// How a run must end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// All steps done.
    #[default]
    Completed,
    /// There is no equilibrium: losing it is the right answer.
    NotConverged,
}

/// The form of a case that the tests run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Short {
    /// The whole case.
    Whole,
    /// With these overrides of the deck.
    Set(Vec<(String, String)>),
    /// None: too long for the tests.
    None,
}

impl Short {
    /// Adds the keys of the short form, if it is asked for; returns false if there is none.
    pub fn extend(&self, set: &mut Vec<(String, String)>, short: bool) -> bool {
        match (self, short) {
            (Self::None, true) => return false,
            (Self::Set(more), true) => set.extend(more.iter().cloned()),
            _ => {}
        }
        true
    }
}

/// A method that a case brings itself: overrides of the deck.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CaseMethod {
    /// Label.
    pub name: String,
    /// Keys of the deck and their values.
    pub set: Vec<(String, String)>,
}

/// Energy imbalance that a case does not name [-].
pub const ENERGY: f64 = 0.01;

impl Case {
    /// Reads a case from its file.
    ///
    /// # Errors
    /// [`StudyError`]: the file, its deck or a reference cannot be read, or says something impossible.
    pub fn load(path: &Path) -> Result<Self, StudyError> {
        let (text, file, folder) = written::text(path)?;
        let mut case = Self::from_str(&text, &file, folder)?;
        case.part = part(path).unwrap_or_default();
        Ok(case)
    }

    /// Reads a case from a text. `file` names it in errors, `folder` holds its deck and references.
    ///
    /// # Errors
    /// As [`Case::load`].
    pub fn from_str(text: &str, file: &str, folder: &Path) -> Result<Self, StudyError> {
        let (source, case): (_, CaseFile) = written::parsed(text, file, written::advice)?;
        case.checked(&source, folder)
    }

    /// What its runs are judged by.
    pub fn terms(&self) -> Terms<'_> {
        Terms {
            status: self.status,
            energy: self.energy,
            expect: &self.expect,
        }
    }

    /// Number and letter.
    pub fn id(&self) -> String {
        format!("{}{}", self.number, self.part)
    }

    /// Number, letter and title.
    pub fn name(&self) -> String {
        format!("{} {}", self.id(), self.title)
    }

    /// Says nothing and expects nothing.
    #[cfg(test)]
    pub(super) fn empty() -> Self {
        Self {
            number: 1,
            part: String::new(),
            title: String::new(),
            mechanics: String::new(),
            source: String::new(),
            deck: PathBuf::new(),
            steps: None,
            short: Short::Whole,
            energy: ENERGY,
            why: String::new(),
            status: End::Completed,
            methods: Vec::new(),
            expect: Vec::new(),
        }
    }
}

/// The letter of the case in this file, empty for `case.toml`; none if the file is no case.
fn part(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    let part = name.strip_prefix("case")?.strip_suffix(".toml")?;
    match part.strip_prefix('-') {
        Some(letter) if !letter.is_empty() => Some(letter.to_owned()),
        None if part.is_empty() => Some(String::new()),
        _ => None,
    }
}

/// All cases in the folders of `folder`, by number and letter.
///
/// # Errors
/// [`StudyError`]: the folder cannot be read, holds no case, or one of them is wrong.
pub fn cases(folder: &Path) -> Result<Vec<Case>, StudyError> {
    let folders = written::listed(folder)?.into_iter();
    let mut files = Vec::new();
    for path in folders.filter(|path| path.is_dir()) {
        files.extend(
            written::listed(&path)?
                .into_iter()
                .filter(|f| part(f).is_some()),
        );
    }
    let mut cases = written::gathered(folder, &files, Case::load, Case::id)?;
    cases.sort_by_key(|case| (case.number, case.part.clone()));
    Ok(cases)
}

/// A study that could not begin.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum StudyError {
    /// `case.toml` is wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Case(#[from] ModelError),
    /// A file cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Io(#[from] IoError),
    /// The deck of a case is wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Deck(#[from] DeckError),
    /// No cases.
    #[error("{} holds no case", .0.display())]
    #[diagnostic(help("a case is a folder with a case.toml: name the folder above them"))]
    NoCase(PathBuf),
    /// No scenes.
    #[error("{} holds no scene", .0.display())]
    #[diagnostic(help("a scene is a folder with a scene.toml: name the folder above them"))]
    NoScene(PathBuf),
    /// A scene whose reference was not made yet.
    #[error("there is no reference {}", file.display())]
    #[diagnostic(help("make it with `{command} --only {number} --references`"))]
    NoReference {
        /// Its file.
        file: PathBuf,
        /// What runs the scenes beside it.
        command: String,
        /// Number of the scene.
        number: u32,
    },
    /// Two of the same number.
    #[error("{} and {} both have the number {number}", one.display(), other.display())]
    #[diagnostic(help("give one of them another number"))]
    SameNumber {
        /// The number.
        number: String,
        /// A file.
        one: PathBuf,
        /// Another.
        other: PathBuf,
    },
    /// A number or a method that is not there.
    #[error("there is no {kind} `{name}`")]
    #[diagnostic(help("known: {known}"))]
    Unknown {
        /// Case or method.
        kind: &'static str,
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
}
