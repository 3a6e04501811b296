//! A scene of the study: a deck, its reference, and the choices that are compared.

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

/// Default folder of the scenes.
pub const SCENES: &str = "docs/accuracy-speed";

/// A folder with `scene.toml`. `docs/reference/studies.md` lists the keys.
#[derive(Clone, Debug)]
// More than 15 fields: one for each key of a scene.
pub struct Scene {
    /// Number of the scene.
    pub number: u32,
    /// Title.
    pub title: String,
    /// Mechanics of the scene, and the kind of its reference.
    pub what: String,
    /// Conclusions from the chart.
    pub says: String,
    /// Folder of `scene.toml` and the reference; chart and table are written into it by default.
    pub folder: PathBuf,
    /// File of the deck.
    pub deck: PathBuf,
    /// Overrides of every run: keys of the deck and their values.
    pub set: Vec<(String, String)>,
    /// Short form of the scene, for the tests.
    pub short: Short,
    /// Column of `history.csv` for the abscissa of the curves.
    pub x: String,
    /// Column of the ordinate.
    pub y: String,
    /// Signs by which both columns are multiplied: −1 if the scene has a minus before the column. `[x, y]`
    pub signs: [f64; 2],
    /// Steps whose rows are compared, from 0; all if none are given.
    pub steps: Option<Vec<usize>>,
    /// Beginning and end of the comparison, in the unit of `x`.
    pub range: [f64; 2],
    /// End of the comparison in the short form, in the unit of `x`.
    pub short_to: f64,
    /// Reference of the scene.
    pub reference: Reference,
    /// Compared choices; one of them has the group [`Group::Default`].
    pub choices: Vec<Choice>,
    /// Other programs on the same scene.
    pub peers: Vec<Peer>,
}

/// The curve that the choices are compared with.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Curve in the units of the columns; empty until it is computed. `[point][x, y]`
    pub curve: Vec<Point>,
    /// Peak in closed form, if there is one.
    pub peak: Option<f64>,
    /// Crack pattern at the end of the range; none if it was not recorded.
    pub pattern: Option<Pattern>,
    /// File of the curve.
    pub file: PathBuf,
    /// Reliability of the reference, with reasons.
    pub how: String,
    /// Uncertainty of the reference relative to the peak or the energy [-].
    pub uncertainty: f64,
    /// Origin of the reference.
    pub origin: Origin,
}

impl Reference {
    /// Whether the reference exists.
    pub fn there(&self) -> bool {
        !self.curve.is_empty()
    }
}

/// Origin of a reference.
#[derive(Clone, Debug, PartialEq)]
pub enum Origin {
    /// A run of the scene with additional keys, see [`renew`](super::renew()).
    Run(Choice),
    /// Another source: a command.
    Command(String),
}

/// A choice that a user has.
#[derive(Clone, Debug, PartialEq)]
pub struct Choice {
    /// Name in tables and charts.
    pub name: String,
    /// Subject of the choice.
    pub group: Group,
    /// Overrides: keys of the deck and their values.
    pub set: Vec<(String, String)>,
    /// Number of threads of the run.
    pub threads: usize,
    /// Factor of the ordinate: 2 if symmetry reduces the model to a half.
    pub factor: f64,
    /// Whether the short form includes the choice.
    pub short: bool,
}

/// Subject of a choice; it determines the colour in the chart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Group {
    /// Settings of a deck without solver keys; other times are given relative to this choice.
    Default,
    /// Formulation of the elements.
    Element,
    /// Number of elements per unit.
    Mesh,
    /// Contact points.
    Points,
    /// Stiffness of the interfaces.
    Penalty,
    /// Procedure and tangent.
    Procedure,
    /// Increment size.
    Step,
    /// Tolerance of equilibrium.
    Tolerance,
    /// Plane of symmetry.
    Symmetry,
    /// Level of detail of the model.
    Fidelity,
    /// Number of threads.
    Threads,
    /// Several subjects at once.
    Several,
    /// Width of the crack band, on any mesh.
    CrackBand,
    /// Strategy with which walls are modelled.
    Strategy,
}

impl Group {
    /// All groups in the order of the legend.
    pub const ALL: [Self; 14] = [
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
        Self::Strategy,
    ];

    /// Name of this group of choices, as in the tables and charts of the study.
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
            Self::Strategy => "strategy",
        }
    }
}

impl Choice {
    /// A choice with one thread that the short form includes.
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
    /// [`StudyError`]: the file, its deck or its reference cannot be read or is invalid.
    pub fn load(path: &Path) -> Result<Self, StudyError> {
        let (text, file, folder) = text(path)?;
        Self::from_str(&text, &file, folder)
    }

    /// Reads a scene from a text. `file` is the name used in errors, `folder` the folder of its deck and
    /// reference.
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

    /// Command that runs the scenes of this folder.
    pub fn command(&self) -> String {
        let scenes = self.folder.parent().unwrap_or(Path::new("."));
        if scenes == Path::new(SCENES) {
            "wythe study accuracy-speed".to_owned()
        } else {
            format!("wythe study accuracy-speed --scenes {}", argument(scenes))
        }
    }

    /// Name of the scene's folder.
    pub fn folder_name(&self) -> String {
        let name = self.folder.file_name();
        name.map_or_else(String::new, |n| n.to_string_lossy().into_owned())
    }

    /// Deck keys with the values that this choice of numerics gives them, in the short or the full form of the study;
    /// none if this form leaves the choice out.
    pub fn overrides(&self, choice: &Choice, short: bool) -> Option<Vec<(String, String)>> {
        let mut set = self.set.clone();
        if !self.short.extend(&mut set, short) {
            return None;
        }
        set.extend(choice.set.iter().cloned());
        (choice.short || !short).then_some(set)
    }

    /// Crack pattern of the reference at the end of a form's range; none if the reference ends elsewhere.
    pub fn pattern(&self, short: bool) -> Option<&Pattern> {
        let pattern = self.reference.pattern.as_ref();
        pattern.filter(|_| !short || self.short_to == self.range[1])
    }

    /// Reference over the range of a form.
    ///
    /// # Errors
    /// In words: the curve does not cover that range.
    pub fn known(&self, short: bool) -> Result<Known, String> {
        let to = if short { self.short_to } else { self.range[1] };
        Known::new(
            &self.reference.curve,
            [self.range[0], to],
            self.reference.peak,
        )
    }
}

/// Advice for all scenes of a folder, the key `advice` of its `index.toml`; empty if there is no such file.
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

/// All scenes in the sub-folders of `folder`, sorted by number.
///
/// # Errors
/// [`StudyError`]: the folder cannot be read, holds no scene, or a scene is invalid.
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
