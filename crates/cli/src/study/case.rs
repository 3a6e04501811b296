//! A case of the atlas: a deck, its mechanics, and its expected results.

use std::path::{Path, PathBuf};

use miette::Diagnostic;
use serde::Deserialize;

use super::expect::Expectation;
use super::judge::Terms;
use super::written::{self, CaseFile};
use wythe_core::error::{DeckError, IoError, ModelError};

/// A deck, a description of its mechanics, and its expected results.
///
/// A case is a folder with `case.toml`, or with `case-a.toml`, `case-b.toml` … if several cases share a number.
/// `tests/stability/README.md` lists the keys.
#[derive(Clone, Debug)]
pub struct Case {
    /// Number of the case in the atlas.
    pub number: u32,
    /// Letter of the case if several cases share a folder and a number; else empty.
    pub part: String,
    /// Title.
    pub title: String,
    /// Mechanics of the case, and the reason why methods fail.
    pub mechanics: String,
    /// Source of the reference.
    pub source: String,
    /// File of the deck.
    pub deck: PathBuf,
    /// Steps of the deck that use the method, from 0; if none are given, all except preloads.
    pub steps: Option<Vec<usize>>,
    /// Short form of the case, for the tests.
    pub short: Short,
    /// Largest accepted energy imbalance (theory/energies.md, eq. 18) [-].
    pub energy: f64,
    /// Reason why the accepted energy imbalance differs from `ENERGY`.
    pub why: String,
    /// Required end of the run.
    pub status: End,
    /// Methods of the case itself, used instead of [`METHODS`](super::METHODS); empty if those apply.
    pub methods: Vec<CaseMethod>,
    /// Expected results, all of which must hold.
    pub expect: Vec<Expectation>,
}

/// Required end of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum End {
    /// All steps are completed.
    #[default]
    Completed,
    /// There is no equilibrium: loss of convergence is the right answer.
    NotConverged,
}

/// Short form of a case, for the tests.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Short {
    /// The whole case.
    Whole,
    /// The case with these overrides of the deck.
    Set(Vec<(String, String)>),
    /// No short form: the case takes too long for the tests.
    None,
}

impl Short {
    /// Adds the keys of the short form if it is requested. Returns false if there is no short form.
    pub fn extend(&self, set: &mut Vec<(String, String)>, short: bool) -> bool {
        match (self, short) {
            (Self::None, true) => return false,
            (Self::Set(more), true) => set.extend(more.iter().cloned()),
            _ => {}
        }
        true
    }
}

/// A method that belongs to one case: overrides of the deck.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CaseMethod {
    /// Label.
    pub name: String,
    /// Keys of the deck and their values.
    pub set: Vec<(String, String)>,
}

/// Accepted energy imbalance of a case that gives none [-].
pub const ENERGY: f64 = 0.01;

impl Case {
    /// Reads a case from its file.
    ///
    /// # Errors
    /// [`StudyError`]: the file, its deck or a reference cannot be read or is invalid.
    pub fn load(path: &Path) -> Result<Self, StudyError> {
        let (text, file, folder) = written::text(path)?;
        let mut case = Self::from_str(&text, &file, folder)?;
        case.part = part(path).unwrap_or_default();
        Ok(case)
    }

    /// Reads a case from a text. `file` is the name used in errors, `folder` the folder of its deck and
    /// references.
    ///
    /// # Errors
    /// As [`Case::load`].
    pub fn from_str(text: &str, file: &str, folder: &Path) -> Result<Self, StudyError> {
        let (source, case): (_, CaseFile) = written::parsed(text, file, written::advice)?;
        case.checked(&source, folder)
    }

    /// Criteria for the verdict on the runs of this case.
    pub fn terms(&self) -> Terms<'_> {
        Terms {
            status: self.status,
            energy: self.energy,
            expect: &self.expect,
        }
    }

    /// Number and letter, such as `10b`.
    pub fn id(&self) -> String {
        format!("{}{}", self.number, self.part)
    }

    /// Number, letter and title.
    pub fn name(&self) -> String {
        format!("{} {}", self.id(), self.title)
    }

    /// A case with empty texts and no expectations.
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

/// Letter of the case in this file, empty for `case.toml`; none if the file is not a case.
fn part(path: &Path) -> Option<String> {
    let name = path.file_name()?.to_str()?;
    let part = name.strip_prefix("case")?.strip_suffix(".toml")?;
    match part.strip_prefix('-') {
        Some(letter) if !letter.is_empty() => Some(letter.to_owned()),
        None if part.is_empty() => Some(String::new()),
        _ => None,
    }
}

/// All cases in the sub-folders of `folder`, sorted by number and letter.
///
/// # Errors
/// [`StudyError`]: the folder cannot be read, holds no case, or a case is invalid.
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

/// Reason why a study cannot start.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum StudyError {
    /// A `case.toml` is invalid.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Case(#[from] ModelError),
    /// A file cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Io(#[from] IoError),
    /// The deck of a case is invalid.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Deck(#[from] DeckError),
    /// The folder holds no cases.
    #[error("{} holds no case", .0.display())]
    #[diagnostic(help("a case is a folder with a case.toml: name the folder above them"))]
    NoCase(PathBuf),
    /// The folder holds no scenes.
    #[error("{} holds no scene", .0.display())]
    #[diagnostic(help("a scene is a folder with a scene.toml: name the folder above them"))]
    NoScene(PathBuf),
    /// The reference of a scene does not exist yet.
    #[error("there is no reference {}", file.display())]
    #[diagnostic(help("make it with `{command} --only {number} --references`"))]
    NoReference {
        /// File of the reference.
        file: PathBuf,
        /// Command that runs the scenes of this folder.
        command: String,
        /// Number of the scene.
        number: u32,
    },
    /// Two cases have the same number.
    #[error("{} and {} both have the number {number}", one.display(), other.display())]
    #[diagnostic(help("give one of them another number"))]
    SameNumber {
        /// The number.
        number: String,
        /// First file.
        one: PathBuf,
        /// Second file.
        other: PathBuf,
    },
    /// There is no case or method of this name.
    #[error("there is no {kind} `{name}`")]
    #[diagnostic(help("known: {known}"))]
    Unknown {
        /// Kind of the name: case or method.
        kind: &'static str,
        /// The requested name.
        name: String,
        /// The existing names.
        known: String,
    },
}
