//! A validation case: runs, reference data and charts.

use std::path::{Path, PathBuf};

use super::point::PointTest;
use super::written::{self, CaseFile};
use crate::study::judge::Terms;
use crate::study::written::{gathered, listed, parsed, text};
use crate::study::{End, Expectation, Short, StudyError};
use wythe_core::results::plotting::Line;
use wythe_core::results::snapshot::FrameChoice;

/// A page of the validation: a folder with `case.toml`. `docs/reference/studies.md` lists the keys.
#[derive(Clone, Debug)]
pub struct Case {
    /// Number of the page.
    pub number: u32,
    /// Title.
    pub title: String,
    /// Mechanics of the case.
    pub what: String,
    /// Source of the data, and their reliability.
    pub data: String,
    /// Agreement with the data.
    pub agrees: String,
    /// Differences from the data, with their causes as far as they are known.
    pub differs: String,
    /// Folder of `case.toml` and the references; pages are written into it by default.
    pub folder: PathBuf,
    /// Its runs.
    pub runs: Vec<Run>,
    /// Its charts.
    pub charts: Vec<Chart>,
}

/// A run of a case.
#[derive(Clone, Debug)]
pub struct Run {
    /// Name of the run in the tables and of its files.
    pub name: String,
    /// Description in a few words.
    pub about: String,
    /// File of the deck.
    pub deck: PathBuf,
    /// Single material point to run instead of the model; none for a run of the model.
    pub point: Option<PointTest>,
    /// Overrides: keys of the deck and their values.
    pub set: Vec<(String, String)>,
    /// Short form of the run, for the tests.
    pub short: Short,
    /// Required end of the run.
    pub status: End,
    /// Largest accepted energy imbalance (theory/energies.md, eq. 18) [-].
    pub energy: f64,
    /// Frame whose cracks are drawn, if any.
    pub cracks: Option<FrameChoice>,
    /// Whether the model is drawn.
    pub drawing: bool,
    /// Expected results, and values that are only reported.
    pub expect: Vec<Expectation>,
}

/// A chart of a case.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Name of the chart's file.
    pub name: String,
    /// Title.
    pub title: String,
    /// Abscissa.
    pub x: Axis,
    /// Ordinate.
    pub y: Axis,
    /// Curves or points of the chart.
    pub content: Content,
    /// Reference curves in the units of the axes.
    pub references: Vec<Line>,
}

/// An axis of a chart.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Axis {
    /// Label with unit.
    pub label: String,
    /// Column of `history.csv`; none if measures are drawn.
    pub column: Option<String>,
    /// Factor from the unit of the column to that of the axis.
    pub factor: f64,
}

/// Content of a chart.
#[derive(Clone, Debug, PartialEq)]
pub enum Content {
    /// One column over another, for the runs of these names.
    Curves(Vec<String>),
    /// One measured value of each run over a given number.
    Measures {
        /// Name of the expectation that measures the value.
        expect: String,
        /// Name of the run and its abscissa.
        at: Vec<(String, f64)>,
    },
}

impl Case {
    /// Reads a case from its file.
    ///
    /// # Errors
    /// [`StudyError`]: the file, a deck or a reference cannot be read or is invalid.
    pub fn load(path: &Path) -> Result<Self, StudyError> {
        let (text, file, folder) = text(path)?;
        Self::from_str(&text, &file, folder)
    }

    /// Reads a case from a text. `file` is the name used in errors, `folder` the folder of its decks and
    /// references.
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

    /// Name of the case's folder.
    pub fn folder_name(&self) -> String {
        let name = self.folder.file_name();
        name.map_or_else(String::new, |n| n.to_string_lossy().into_owned())
    }
}

impl Run {
    /// Criteria for the verdict on this run.
    pub fn terms(&self) -> Terms<'_> {
        Terms {
            status: self.status,
            energy: self.energy,
            expect: &self.expect,
        }
    }

    /// Overrides of the short or the full form: keys of the deck and their values; none if there is no short form.
    pub fn overrides(&self, short: bool) -> Option<Vec<(String, String)>> {
        let mut set = self.set.clone();
        if !self.short.extend(&mut set, short) {
            return None;
        }
        Some(set)
    }
}

/// All cases in the sub-folders of `folder`, sorted by number.
///
/// # Errors
/// [`StudyError`]: the folder cannot be read, holds no case, or a case is invalid.
pub fn cases(folder: &Path) -> Result<Vec<Case>, StudyError> {
    let folders = listed(folder)?.into_iter();
    let files = folders.map(|path| path.join("case.toml"));
    let files: Vec<PathBuf> = files.filter(|file| file.is_file()).collect();
    let mut cases = gathered(folder, &files, Case::load, |case| case.number.to_string())?;
    cases.sort_by_key(|case| case.number);
    Ok(cases)
}
