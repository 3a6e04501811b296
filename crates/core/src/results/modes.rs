//! Natural modes of a model or of a frame of a run, and their files.
//!
//! | File | Content |
//! |---|---|
//! | [`TABLE`] | frequencies, periods, participation, effective masses as JSON |
//! | [`SHAPES`] | the shapes, one step a mode, whose time is the number of the mode, for ParaView |
//! | `mode_NN.svg` | picture of a shape |

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use miette::Diagnostic;
use serde::Serialize;

use super::output::DECK;
use super::plotting::shape::shape;
use super::snapshot::{Snapshot, Snapshots};
use super::{FrameChoice, ReadError, RunFolder, VtkHdfWriter};
use crate::deck::Deck;
use crate::error::{DeckError, IoError};
use crate::files::write_whole;
use crate::model::Model;
use crate::model::scene::Step;
use crate::model::ties::{Installed, TieStage};
use crate::solve::vibration::{About, Mode, Modes, VibrationError, modes};
use crate::state::{Frame, InterfaceFrame, InterfaceState, OutputField};

/// File of the figures.
pub const TABLE: &str = "modes.json";
/// File of the shapes.
pub const SHAPES: &str = "modes.vtkhdf";

/// Errors of a search for modes.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum ModesError {
    /// The run cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Read(#[from] ReadError),
    /// The deck of the run is invalid.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Deck(#[from] DeckError),
    /// The folder has no deck.
    #[error("{}: there is no {DECK}, from which the model is made", .0.display())]
    #[diagnostic(help("a run from a deck keeps it there: put it back, or run the deck again"))]
    NoDeck(PathBuf),
    /// There are no modes.
    #[error(transparent)]
    #[diagnostic(help("{}", advice(.0)))]
    Vibration(#[from] VibrationError),
}

fn advice(why: &VibrationError) -> &'static str {
    match why {
        VibrationError::NoMass { .. } => "write it like this: density = \"1900 kg/m^3\"",
        VibrationError::TooMany { .. } => "ask for the lowest ones: --count 10",
        VibrationError::NothingMoves => "free some nodes: see [supports] and [beams]",
        VibrationError::OtherModel(_) => {
            "the deck in the folder must be the one that was run, with the files that it names"
        }
        VibrationError::Element(_) => {
            "see the sizes in [wall], wall.mesh and the tables of the material"
        }
        VibrationError::Local { .. } => "take an earlier frame",
        VibrationError::Eigen(_) => {
            "take an earlier frame, or fewer modes; stiff or distorted elements cost accuracy"
        }
    }
}

/// Frame of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct OfFrame {
    /// Its number, from 0.
    pub number: usize,
    /// Its step time [s].
    pub time: f64,
}

/// Modes of a model or of a frame of a run.
#[derive(Clone, Debug)]
pub struct FoundModes {
    /// The model.
    pub model: Model,
    /// Its modes.
    pub found: Modes,
    /// The frame; none: at rest.
    pub frame: Option<OfFrame>,
}

/// Figures of one mode, as in [`TABLE`].
#[derive(Clone, Debug, PartialEq, Serialize)]
#[expect(non_snake_case, reason = "units are written as they are")]
pub struct ModeRow {
    /// Number of the mode, from 1.
    pub mode: usize,
    /// Frequency [Hz].
    pub frequency_Hz: f64,
    /// Period [s]; none without frequency.
    pub period_s: Option<f64>,
    /// ω² [1/s²].
    pub eigenvalue: f64,
    /// Participation factors in x, y, z for a largest displacement of 1.
    pub participation: [f64; 3],
    /// Effective modal masses in x, y, z [tonne].
    pub effective_mass_t: [f64; 3],
    /// The same over the moving mass [-].
    pub effective_part: [f64; 3],
    /// Relative residual.
    pub residual: f64,
}

/// All figures, as in [`TABLE`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModesTable {
    /// Title of the model.
    pub title: String,
    /// The frame; none: at rest.
    pub frame: Option<OfFrame>,
    /// State and stiffness in words.
    pub stiffness: &'static str,
    /// Mass of the model [tonne].
    pub total_mass_t: f64,
    /// Mass at free displacements in x, y, z [tonne].
    pub moving_mass_t: [f64; 3],
    /// Part of the area of the joints that carries stiffness [-].
    pub closed_joint_area: f64,
    /// The modes.
    pub modes: Vec<ModeRow>,
    /// Remarks.
    pub notes: Vec<String>,
}

/// Largest number of modes: the time grows with its square, and beyond some dozens shapes are those of single elements.
const MOST_MODES: usize = 100;

/// Rejects a larger number than [`MOST_MODES`].
fn require_few(count: usize) -> Result<(), VibrationError> {
    if count <= MOST_MODES {
        return Ok(());
    }
    let most = MOST_MODES;
    Err(VibrationError::TooMany { count, most })
}

impl FoundModes {
    /// The `count` lowest modes of a model at rest.
    ///
    /// # Errors
    /// [`ModesError::Vibration`].
    pub fn of_model(model: Model, count: usize) -> Result<Self, ModesError> {
        require_few(count)?;
        let found = modes(&model, About::Rest, count)?;
        Ok(Self {
            model,
            found,
            frame: None,
        })
    }

    /// The `count` lowest modes at a frame of a run, with beams and driven faces as in the first step.
    ///
    /// # Errors
    /// [`ModesError`].
    pub fn of_run(path: &Path, choice: FrameChoice, count: usize) -> Result<Self, ModesError> {
        require_few(count)?;
        let folder = RunFolder::open(path)?;
        let file = path.join(DECK);
        if !file.is_file() {
            return Err(ModesError::NoDeck(path.to_owned()));
        }
        let deck = folder.place(Deck::load(&file, &[])?);
        let (model, _) = Model::from_deck(&deck).map_err(DeckError::from)?;
        let snapshots = Snapshots::open(&folder)?;
        let snapshot = snapshots.at(choice)?;
        let starts = Starts::of(&model, &snapshots, &snapshot)?;
        let ties: Vec<Installed<'_>> = starts.ties.iter().map(|at| starts.since(*at)).collect();
        let about = About::Frame {
            frame: &snapshot.frame,
            // As at rest, so that frequencies compare: what a later step drives is let go.
            step: 0,
            ties: &ties,
        };
        let found = modes(&model, about, count)?;
        Ok(Self {
            found,
            frame: Some(OfFrame {
                number: snapshot.number,
                time: snapshot.frame.time,
            }),
            model,
        })
    }

    /// Whether a step prestresses ties; frames do not store it.
    fn has_stressed_ties(&self) -> bool {
        let mut stages = self.model.steps.iter().flat_map(|step| &step.ties);
        stages.any(|stage| matches!(stage, TieStage::Stressed(_)))
    }

    /// State and stiffness in words.
    pub fn stiffness(&self) -> &'static str {
        match self.frame {
            None => {
                "at rest without preload: elastic, joints that touch are closed with their elastic stiffness"
            }
            Some(_) if self.has_stressed_ties() => {
                "secant at the frame: damage of the solids, joints closed under pressure, by their secant in \
                 tension, without stiffness where open; ties WITHOUT their prestress: those that it keeps taut may \
                 count as slack"
            }
            Some(_) => {
                "secant at the frame: damage of the solids, joints closed under pressure, by their secant in \
                 tension, without stiffness where open"
            }
        }
    }

    /// All figures.
    pub fn table(&self) -> ModesTable {
        let found = &self.found;
        let row = |(i, mode): (usize, &Mode)| {
            let part = |i: usize| match found.moving_mass[i] {
                mass if mass > 0.0 => mode.effective_mass[i] / mass,
                _ => 0.0,
            };
            ModeRow {
                mode: i + 1,
                frequency_Hz: mode.frequency,
                period_s: (mode.frequency > 0.0).then(|| mode.period()),
                eigenvalue: mode.eigenvalue,
                participation: mode.participation,
                effective_mass_t: mode.effective_mass,
                effective_part: [0, 1, 2].map(part),
                residual: mode.residual,
            }
        };
        ModesTable {
            title: self.model.title.clone(),
            frame: self.frame,
            stiffness: self.stiffness(),
            total_mass_t: found.total_mass,
            moving_mass_t: found.moving_mass,
            closed_joint_area: found.closed_area,
            modes: found.modes.iter().enumerate().map(row).collect(),
            notes: self.notes(),
        }
    }

    fn notes(&self) -> Vec<String> {
        let (found, mut notes) = (&self.found, Vec::new());
        if found.free > 0 {
            notes.push(format!(
                "free motions, with frequency 0: {}; nothing holds a body, or all its joints are open: ask for more \
                 modes with --count",
                found.free
            ));
        }
        if found.unstable > 0 {
            notes.push(format!(
                "modes with a negative square of the frequency: {}; under its own stresses the state is unstable, the \
                 drive alone held it",
                found.unstable
            ));
        }
        if found.closed_area < 1.0 {
            let open = 100.0 * (1.0 - found.closed_area);
            notes.push(format!("{open:.2} % of the area of the joints is open"));
        }
        if self.model.contact.general.is_some() {
            notes
                .push("general contact has no stiffness here, only planned joints have".to_owned());
        }
        notes
    }

    /// All figures as text.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let told = self.tell(&mut text);
        debug_assert!(told.is_ok(), "writing to a string does not fail");
        text
    }

    fn tell(&self, text: &mut String) -> std::fmt::Result {
        let table = self.table();
        match self.frame {
            None => writeln!(text, "{}", table.title)?,
            Some(at) => writeln!(
                text,
                "{}, frame {}, t = {:.4} s",
                table.title, at.number, at.time
            )?,
        }
        writeln!(text, "stiffness {}", table.stiffness)?;
        let [x, y, z] = table.moving_mass_t;
        writeln!(
            text,
            "mass {:.4} t; moving in x, y, z {x:.4}, {y:.4}, {z:.4} t",
            table.total_mass_t
        )?;
        writeln!(
            text,
            "{:>4} {:>12} {:>12}   effective mass over moving mass in x, y, z [%]",
            "mode", "f [Hz]", "T [s]"
        )?;
        let mut sum = [0.0; 3];
        for row in &table.modes {
            let part = row.effective_part.map(|part| 100.0 * part);
            (0..3).for_each(|i| sum[i] += part[i]);
            let period = row.period_s.map_or("-".to_owned(), |t| format!("{t:.6}"));
            writeln!(
                text,
                "{:>4} {:>12.4} {period:>12}   {:>8.2} {:>8.2} {:>8.2}",
                row.mode, row.frequency_Hz, part[0], part[1], part[2]
            )?;
        }
        writeln!(
            text,
            "{:>30}   {:>8.2} {:>8.2} {:>8.2}",
            "sum", sum[0], sum[1], sum[2]
        )?;
        for note in &table.notes {
            writeln!(text, "note: {note}")?;
        }
        Ok(())
    }

    /// Writes figures, shapes and pictures into a folder, which is made if necessary, and returns their paths.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(&self, out: &Path) -> Result<Vec<PathBuf>, IoError> {
        let failed = |path: &Path| {
            let path = path.to_owned();
            move |why| IoError { path, why }
        };
        std::fs::create_dir_all(out).map_err(failed(out))?;
        let table = out.join(TABLE);
        let json = serde_json::to_string_pretty(&self.table()).map_err(std::io::Error::other);
        let json = json.map_err(failed(&table))? + "\n";
        write_whole(&table, json.as_bytes()).map_err(failed(&table))?;
        let shapes = out.join(SHAPES);
        self.write_shapes(&shapes).map_err(failed(&shapes))?;
        let mut written = vec![table, shapes];
        for i in 0..self.found.modes.len() {
            let path = out.join(format!("mode_{:02}.svg", i + 1));
            write_whole(&path, self.picture(i).as_bytes()).map_err(failed(&path))?;
            written.push(path);
        }
        Ok(written)
    }

    /// Picture of a mode, from 0, as SVG; empty if there is no such mode.
    pub fn picture(&self, mode: usize) -> String {
        let Some(of) = self.found.modes.get(mode) else {
            return String::new();
        };
        let caption = format!("mode {}, {:.3} Hz", mode + 1, of.frequency);
        shape(&self.model.title, &caption, &self.model.mesh, &of.shape)
    }

    /// One step a mode: its displacement is the shape, with a largest value of 1 mm; all other fields are zero.
    fn write_shapes(&self, path: &Path) -> std::io::Result<()> {
        // Probes and loads have no value in a shape.
        let model = Model {
            probes: Vec::new(),
            loads: Vec::new(),
            ..self.model.clone()
        };
        let mut writer = VtkHdfWriter::create(path, &model)?;
        for (i, mode) in self.found.modes.iter().enumerate() {
            writer.append(&frame(&model, (i + 1) as f64, &mode.shape))?;
        }
        writer.publish()
    }
}

/// Steps in which ties are installed, and the displacements before them.
struct Starts {
    /// Step in which each tie is installed. `[tie]`
    ties: Vec<usize>,
    /// Step of the frame.
    now: usize,
    /// Displacements as each of these steps begins [mm]. `[step][node][xyz]`
    before: Vec<(usize, Vec<[f64; 3]>)>,
}

impl Starts {
    /// Reads the displacements at which ties were installed before a frame. Without a step of the frame in the history all
    /// count as installed at rest.
    fn of(model: &Model, snapshots: &Snapshots, at: &Snapshot) -> Result<Self, ReadError> {
        let absent = |tie: usize, step: &Step| step.ties.get(tie) == Some(&TieStage::Absent);
        let start = |tie: usize| model.steps.iter().take_while(|s| absent(tie, s)).count();
        let mut starts = Self {
            ties: (0..model.ties.len()).map(start).collect(),
            now: 0,
            before: Vec::new(),
        };
        let Some(now) = snapshots.step_of(at.number) else {
            starts.ties.clear();
            return Ok(starts);
        };
        starts.now = now;
        let mut steps = starts.ties.clone();
        steps.sort_unstable();
        steps.dedup();
        for step in steps.into_iter().filter(|step| (1..=now).contains(step)) {
            if let Some(frame) = snapshots.last_before(step) {
                let before = snapshots.at(FrameChoice::Number(frame))?;
                starts.before.push((step, before.frame.displacement));
            }
        }
        Ok(starts)
    }

    /// When a tie was installed whose step this is.
    fn since(&self, step: usize) -> Installed<'_> {
        if step > self.now {
            return Installed::Later;
        }
        let before = self.before.iter().find(|(of, _)| *of == step);
        before.map_or(Installed::AtRest, |(_, u)| Installed::At(u))
    }
}

/// A frame with displacements and without anything else.
fn frame(model: &Model, time: f64, displacement: &[[f64; 3]]) -> Frame {
    let (nodes, elements) = (model.mesh.nodes.len(), model.mesh.elements.len());
    let points = 4 * model.contact.slave_facets.len();
    let field = |name: &str, count: usize| OutputField {
        name: name.to_owned(),
        values: vec![0.0; count],
    };
    Frame {
        time,
        displacement: displacement.to_vec(),
        velocity: vec![[0.0; 3]; if model.may_move() { nodes } else { 0 }],
        stress: vec![[0.0; 6]; elements],
        plastic_strain: vec![[0.0; 6]; elements],
        tensile_damage: vec![0.0; elements],
        compressive_damage: vec![0.0; elements],
        yielded: vec![false; elements],
        crack_width: vec![0.0; elements],
        outputs: model
            .outputs()
            .iter()
            .map(|of| field(of.name, elements))
            .collect(),
        interfaces: InterfaceFrame {
            opening: vec![0.0; points],
            slip: vec![[0.0; 2]; points],
            traction: vec![[0.0; 3]; points],
            damage: vec![0.0; points],
            state: vec![InterfaceState::Intact; points],
            outputs: model
                .contact
                .outputs()
                .iter()
                .map(|of| field(of.name, points))
                .collect(),
        },
        probes: vec![0.0; model.columns().len()],
        ..Frame::default()
    }
}
