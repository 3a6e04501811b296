//! A scene of the study: a deck, its reference, and the choices that it is run over.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::errors::Known;
use super::pattern::Pattern;
use super::peer::Peer;
use super::written::{self, SceneFile};
use crate::study::curve::Point;
use crate::study::written::{gathered, listed, parsed, text};
use crate::study::{Short, StudyError};
use wythe_core::command::argument;

/// Where the study looks for scenes unless it is told.
pub const SCENES: &str = "docs/accuracy-speed";

/// A folder with `scene.toml`; `docs/reference/studies.md` lists the keys.
#[derive(Clone, Debug)]
// More than 15 fields: one for each key of a scene.
pub struct Scene {
    /// Number of the scene.
    pub number: u32,
    /// Title.
    pub title: String,
    /// What happens, and what the choices are held against.
    pub what: String,
    /// What the chart says of it.
    pub says: String,
    /// Holds `scene.toml`, the reference and, later, chart and table.
    pub folder: PathBuf,
    /// The deck's file.
    pub deck: PathBuf,
    /// Keys of the deck and their values, of every run.
    pub set: Vec<(String, String)>,
    /// The form that the tests run.
    pub short: Short,
    /// Column of `history.csv` along which curves are compared.
    pub x: String,
    /// Column that is compared.
    pub y: String,
    /// What both are multiplied by: −1 where a minus stands before the column. `[x, y]`
    pub signs: [f64; 2],
    /// Rows of these steps only; of all without a choice.
    pub steps: Option<Vec<usize>>,
    /// Where the comparison begins and ends, in units of `x`.
    pub range: [f64; 2],
    /// Where that of the short form ends.
    pub short_to: f64,
    /// What is taken for right.
    pub reference: Reference,
    /// What it is run over; one of them is of the group [`Group::Default`].
    pub choices: Vec<Choice>,
    /// Other programs on the same scene.
    pub peers: Vec<Peer>,
}

/// The curve that is taken for right.
#[derive(Clone, Debug)]
pub struct Reference {
    /// In units of the columns; empty before it was made. `[point][x, y]`
    pub curve: Vec<Point>,
    /// The peak in closed form, where there is one.
    pub peak: Option<f64>,
    /// Its cracks at the end of the range; none where none were looked at.
    pub pattern: Option<Pattern>,
    /// The file of the curve.
    pub file: PathBuf,
    /// How far it can be trusted, and why.
    pub how: String,
    /// That as a number: part of the peak or of the energy [-].
    pub uncertainty: f64,
    /// What made it.
    pub origin: Origin,
}

impl Reference {
    /// Whether it was made.
    pub fn there(&self) -> bool {
        !self.curve.is_empty()
    }
}

/// What made a reference.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// A run of the scene with these keys besides its own, see [`renew`](super::renew()).
    Run(Choice),
    /// Something else: a command.
    Command(String),
}

/// One of the things that a user may choose.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Name in tables and charts.
    pub name: String,
    /// What is chosen.
    pub group: Group,
    /// Keys of the deck and their values.
    pub set: Vec<(String, String)>,
    /// Threads of the run.
    pub threads: usize,
    /// What the ordinate is multiplied by: 2 where symmetry leaves a half.
    pub factor: f64,
    /// Whether the short form runs it.
    pub short: bool,
}

/// What a choice is about: its colour in the chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Group {
    /// What a deck gets that says nothing; the times of the others are told over its.
    Default,
    /// Formulation of the elements.
    Element,
    /// Elements of a unit.
    Mesh,
    /// Points of contact.
    Points,
    /// Stiffness of the interfaces.
    Penalty,
    /// Procedure and tangent.
    Procedure,
    /// Size of the increments.
    Step,
    /// Tolerance of the balance.
    Tolerance,
    /// Plane of symmetry.
    Symmetry,
    /// How much of the model is modelled.
    Fidelity,
    /// Threads.
    Threads,
    /// Several of these at once.
    Several,
    /// Width of the band in which solids soften, on any mesh.
    CrackBand,
}

impl Group {
    /// All of them, in the order of the legend.
    pub const ALL: [Self; 13] = [
        Self::Default,
        Self::Element,
        Self::Mesh,
        Self::Points,
        Self::Penalty,
        Self::Procedure,
        Self::Step,
        Self::Tolerance,
        Self::Symmetry,
        Self::Fidelity,
        Self::Threads,
        Self::Several,
        Self::CrackBand,
    ];

    /// In words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Default => "default",
            Self::Element => "element",
            Self::Mesh => "mesh",
            Self::Points => "contact points",
            Self::Penalty => "penalty",
            Self::Procedure => "procedure",
            Self::Step => "step",
            Self::Tolerance => "tolerance",
            Self::Symmetry => "symmetry",
            Self::Fidelity => "fidelity",
            Self::Threads => "threads",
            Self::Several => "several",
            Self::CrackBand => "crack band",
        }
    }
}

impl Choice {
    /// On one thread, in the short form too.
    pub fn new(name: &str, group: Group, set: Vec<(String, String)>) -> Self {
        Self {
            name: name.to_owned(),
            group,
            set,
            threads: 1,
            factor: 1.0,
            short: true,
        }
    }
}

impl Scene {
    /// Reads a scene from its file.
    ///
    /// # Errors
    /// [`StudyError`]: the file, its deck or its reference cannot be read, or says something impossible.
    pub fn load(path: &Path) -> Result<Self, StudyError> {
        let (text, file, folder) = text(path)?;
        Self::from_str(&text, &file, folder)
    }

    /// Reads a scene from a text. `file` names it in errors, `folder` holds its deck and reference.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn from_str(text: &str, file: &str, folder: &Path) -> Result<Self, StudyError> {
        let (source, scene): (_, SceneFile) = parsed(text, file, written::advice)?;
        scene.checked(&source, folder)
    }

    /// Number and title.
    pub fn name(&self) -> String {
        format!("{} {}", self.number, self.title)
    }

    /// The command that runs the scenes beside it.
    pub fn command(&self) -> String {
        let scenes = self.folder.parent().unwrap_or(Path::new("."));
        if scenes == Path::new(SCENES) {
            "wythe study accuracy-speed".to_owned()
        } else {
            format!("wythe study accuracy-speed --scenes {}", argument(scenes))
        }
    }

    /// Name of its folder.
    pub fn folder_name(&self) -> String {
        let name = self.folder.file_name();
        name.map_or_else(String::new, |n| n.to_string_lossy().into_owned())
    }

    /// Keys of the deck and their values in the short or the full form of a choice; none if the form does not run it.
    pub fn overrides(&self, choice: &Choice, short: bool) -> Option<Vec<(String, String)>> {
        let mut set = self.set.clone();
        if !self.short.extend(&mut set, short) {
            return None;
        }
        set.extend(choice.set.iter().cloned());
        (choice.short || !short).then_some(set)
    }

    /// Cracks of the reference at the end of a form's range; none where that is not the end of the reference's.
    pub fn pattern(&self, short: bool) -> Option<&Pattern> {
        let pattern = self.reference.pattern.as_ref();
        pattern.filter(|_| !short || self.short_to == self.range[1])
    }

    /// The reference over the range of a form.
    ///
    /// # Errors
    /// In words: the curve does not go along that range.
    pub fn known(&self, short: bool) -> Result<Known, String> {
        let to = if short { self.short_to } else { self.range[1] };
        Known::new(
            &self.reference.curve,
            [self.range[0], to],
            self.reference.peak,
        )
    }
}

/// The advice of a folder of scenes: `advice` of its `index.toml`, nothing where there is no such file.
///
/// # Errors
/// [`StudyError`]: the file cannot be read or has other keys.
pub fn advice(folder: &Path) -> Result<String, StudyError> {
    let file = folder.join("index.toml");
    if !file.exists() {
        return Ok(String::new());
    }
    written::advice_of(&file)
}

/// All scenes in the folders of `folder`, by number.
///
/// # Errors
/// [`StudyError`]: the folder cannot be read, holds no scene, or one of them is wrong.
pub fn scenes(folder: &Path) -> Result<Vec<Scene>, StudyError> {
    let folders = listed(folder)?.into_iter();
    let files = folders.map(|path| path.join("scene.toml"));
    let files: Vec<PathBuf> = files.filter(|file| file.is_file()).collect();
    if files.is_empty() {
        return Err(StudyError::NoScene(folder.to_owned()));
    }
    let mut scenes = gathered(folder, &files, Scene::load, |s| s.number.to_string())?;
    scenes.sort_by_key(|scene| scene.number);
    Ok(scenes)
}
