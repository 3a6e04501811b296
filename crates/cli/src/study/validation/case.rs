//! A validation case: runs, what is known of them, and what is to be drawn.

use std::path::{Path, PathBuf};

use super::point::PointTest;
use super::written::{self, CaseFile};
use crate::study::judge::Terms;
use crate::study::written::{gathered, listed, parsed, text};
use crate::study::{End, Expectation, Short, StudyError};
use wythe_core::results::plotting::Line;
use wythe_core::results::snapshot::FrameChoice;

/// One page of the validation: a folder with `case.toml`; `docs/reference/studies.md` lists the keys.
#[derive(Clone, Debug)]
pub struct Case {
    /// Number of the page.
    pub number: u32,
    /// Title.
    pub title: String,
    /// What happens and what carries.
    pub what: String,
    /// Where the data come from, and how far they can be trusted.
    pub data: String,
    /// What agrees.
    pub agrees: String,
    /// What does not, and why as far as it is known.
    pub differs: String,
    /// Holds `case.toml`, references and, later, the page.
    pub folder: PathBuf,
    /// Its runs.
    pub runs: Vec<Run>,
    /// Its charts.
    pub charts: Vec<Chart>,
}

/// A run of a case.
#[derive(Clone, Debug)]
pub struct Run {
    /// Name of its files and in the tables.
    pub name: String,
    /// What it is, in a few words.
    pub about: String,
    /// The deck's file.
    pub deck: PathBuf,
    /// The single point that is run in place of the deck's scene, if it is one.
    pub point: Option<PointTest>,
    /// Keys of the deck and their values.
    pub set: Vec<(String, String)>,
    /// The form that the tests run.
    pub short: Short,
    /// How it must end.
    pub status: End,
    /// Largest energy imbalance (theory/energies.md, eq. 18) [-].
    pub energy: f64,
    /// The frame whose cracks are drawn, if any.
    pub cracks: Option<FrameChoice>,
    /// Whether the scene is drawn.
    pub drawing: bool,
    /// What must come out, and what is told.
    pub expect: Vec<Expectation>,
}

/// A chart of a case.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Name of its file.
    pub name: String,
    /// Title.
    pub title: String,
    /// Abscissa.
    pub x: Axis,
    /// Ordinate.
    pub y: Axis,
    /// What is drawn.
    pub content: Content,
    /// What is known, in the units of the axes.
    pub references: Vec<Line>,
}

/// An axis of a chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// With its unit.
    pub label: String,
    /// Column of `history.csv`; none where measures are drawn.
    pub column: Option<String>,
    /// From the column's unit to that of the axis.
    pub factor: f64,
}

/// What a chart shows of the runs.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// One column over another. Names of runs.
    Curves(Vec<String>),
    /// One measure of each run over a number given with it.
    Measures {
        /// Name of the expectation.
        expect: String,
        /// Run and abscissa.
        at: Vec<(String, f64)>,
    },
}

impl Case {
    /// Reads a case from its file.
    ///
    /// # Errors
    /// [`StudyError`]: the file, a deck or a reference cannot be read, or says something impossible.
    pub fn load(path: &Path) -> Result<Self, StudyError> {
        let (text, file, folder) = text(path)?;
        Self::from_str(&text, &file, folder)
    }

    /// Reads a case from a text. `file` names it in errors, `folder` holds its decks and references.
    ///
    /// # Errors
    /// As [`Case::load`].
    pub fn from_str(text: &str, file: &str, folder: &Path) -> Result<Self, StudyError> {
        let (source, case): (_, CaseFile) = parsed(text, file, written::advice)?;
        case.checked(&source, folder)
    }

    /// Number and title.
    pub fn name(&self) -> String {
        format!("{} {}", self.number, self.title)
    }

    /// Name of its folder.
    pub fn folder_name(&self) -> String {
        let name = self.folder.file_name();
        name.map_or_else(String::new, |n| n.to_string_lossy().into_owned())
    }
}

impl Run {
    /// What it is judged by.
    pub fn terms(&self) -> Terms<'_> {
        Terms {
            status: self.status,
            energy: self.energy,
            expect: &self.expect,
        }
    }

    /// Keys of the deck and their values in the short or the full form; none if there is no short form.
    pub fn overrides(&self, short: bool) -> Option<Vec<(String, String)>> {
        let mut set = self.set.clone();
        if !self.short.extend(&mut set, short) {
            return None;
        }
        Some(set)
    }
}

/// All cases in the folders of `folder`, by number.
///
/// # Errors
/// [`StudyError`]: the folder cannot be read, holds no case, or one of them is wrong.
pub fn cases(folder: &Path) -> Result<Vec<Case>, StudyError> {
    let folders = listed(folder)?.into_iter();
    let files = folders.map(|path| path.join("case.toml"));
    let files: Vec<PathBuf> = files.filter(|file| file.is_file()).collect();
    let mut cases = gathered(folder, &files, Case::load, |case| case.number.to_string())?;
    cases.sort_by_key(|case| case.number);
    Ok(cases)
}
