//! Command-line arguments of the commands that read results.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use wythe_core::results::FrameChoice;
use wythe_core::results::wall_picture::{Look, View};

use super::ModelArguments;

pub(super) const PLOT_HELP: &str = "\
Writes curves.svg (of a run without a drive: its probes over time), cracks_N.svg (deformed, with tensile \
damage, crushing, joints, crack widths, supports and loads), deflection_height.svg and, of a wall bent out \
of its plane, deflection_length.svg. With --x or --y it writes the picture of these columns only.

An experiment is a CSV file whose header names a column of displacement (mm, cm, m) and one of force \
(N, kN, MN); # begins a comment. A cyclic one is drawn with its envelope, several with the band \
between them.

Examples:
  wythe plot wall.out --frame peak --png
  wythe plot wall.out --x time --y external_work_J --y elastic_energy_J
  wythe plot wall.out --face back --scale 100
  wythe plot wall.out --section y=125
  wythe plot wall.out --view iso --png
  wythe plot wall.out --compare SW1001.csv --compare SW1002.csv
  wythe plot wall.out --against fine.out --against elastic.out --out pictures";

pub(super) const ANIMATE_HELP: &str = "\
Writes DIR/plots/animation.gif: the wall at every frame at one scale, with the curve and its present point \
beside it. --png writes the pictures instead, as DIR/plots/animation_N.png.

Examples:
  wythe animate wall.out
  wythe animate wall.out --view iso --scale 50 --out wall.gif
  wythe animate wall.out --section x=600 --width 640 --most 40
  wythe animate wall.out --png";

pub(super) const COMPARE_HELP: &str = "\
Peak, stiffness, area, displacement and drift at 80 % of the peak after it, of both and their ratio, \
and the root mean square of the difference over the displacements that both cover. Of a cyclic \
experiment the envelope counts, on the side to which the run goes; one that went the other way is \
mirrored.

Examples:
  wythe compare wall.out SW1001.csv
  wythe compare wall.out SW1001.csv --json > comparison.json
  wythe compare wall.out SW1001.csv --height 1000";

pub(super) const EVALUATE_HELP: &str = "\
Strengths, moduli and energies by the definitions of the standard (docs/reference/standard-tests.md), of \
runs of decks that `wythe new --test` wrote. Runs of one test at several precompressions give cohesion and \
friction together.

Examples:
  wythe evaluate prism.out
  wythe evaluate triplet-0.2.out triplet-0.6.out triplet-1.out
  wythe evaluate wall.out --json > wall.json";

pub(super) const INFO_HELP: &str = "\
Of a folder of results: how the run went, its answers (stiffness, bilinear curve, first damage, mode of \
failure, cracks, drift limits), sizes and files; of a file of fields: its frames and \
meshes; of a model: what it is made of.

Examples:
  wythe info wall.out
  wythe info wall.out --drifts '0.3 %, 0.6 %'
  wythe info wall.out/results.vtkhdf
  wythe info examples/03_shear_wall_j7d.toml";

pub(super) const MODES_HELP: &str = "\
Of a model: at rest without preload, elastic, joints that touch closed with their elastic stiffness. Of a folder of \
results: the secant stiffness at a frame, with damage and open joints. Supports hold; beams and driven faces \
are held or free as in the first step, also at a frame of a later one. Every material that can move needs a density.

The folder then holds:
  modes.json     frequency, period, participation factors, effective masses in x, y, z
  modes.vtkhdf   the shapes, one step a mode (its time is the number of the mode), for ParaView
  mode_NN.svg    a picture of each shape

Examples:
  wythe modes wall.toml
  wythe modes wall.out --frame peak --count 6
  wythe modes wall.toml --json | jq '.modes[].frequency_Hz'";

pub(super) const EXPORT_HELP: &str = "\
  vtu  frame_N.vtu and frame_N_interfaces.vtu for any VTK; of all frames with a series.pvd
  csv  frame_N_nodes.csv, frame_N_elements.csv, frame_N_interfaces.csv [mm, MPa]
  inp  model.inp for Abaqus, at rest: nodes, C3D8, sets of units, materials, supports and beams, the materials \
with their tables, surfaces with friction and stiffness, steps. The bond of the interfaces and what else Abaqus has no \
words for stand in comments.
  obj, ply, stl  model.obj, model.ply or model.stl: the bodies at rest as closed shells [mm], which [[blocks]] \
file = \"model.obj\" reads back

Of a model that was not run: inp, obj, ply and stl; and vtu, as model.vtu (materials, units, courses, supports, beams) and \
model_surfaces.vtu (what may meet), into MODEL.export.

Examples:
  wythe export wall.toml --to inp
  wythe export wall.toml --to obj
  wythe export wall.toml --to vtu --set wall.mesh=fine
  wythe export wall.out --to vtu --frame all
  wythe export wall.out --to csv --frame peak --out tables
  wythe export wall.out --to inp";

/// `wythe plot`
#[derive(Debug, Args)]
pub struct Plot {
    /// Folder of the run.
    pub folder: PathBuf,
    /// Measured curve to draw beside it (repeatable).
    #[arg(long, value_name = "CSV", num_args = 1..)]
    pub compare: Vec<PathBuf>,
    /// Another run to draw beside it (repeatable).
    #[arg(long, value_name = "DIR", num_args = 1..)]
    pub against: Vec<PathBuf>,
    /// Frame of cracks and deflections: its number from 0, peak, or last.
    #[arg(long, value_name = "FRAME", default_value = "last")]
    pub frame: FrameChoice,
    /// Column of history.csv along x [default: displacement_mm; time without a drive].
    #[arg(long, value_name = "COLUMN")]
    pub x: Option<String>,
    /// Column of history.csv along y (repeatable) [default: force_kN; the probes without a drive].
    #[arg(long, value_name = "COLUMN", num_args = 1..)]
    pub y: Vec<String>,
    #[command(flatten)]
    pub view: ViewArguments,
    /// Folder for the pictures [default: DIR/plots].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Also write PNG, twice as large.
    #[arg(long)]
    pub png: bool,
}

/// Face, section or direction of a picture of the wall.
#[derive(Clone, Debug, Args)]
pub struct ViewArguments {
    /// Face of the wall: front (y = min), back, left, right or top.
    #[arg(long, value_name = "FACE", value_parser = face, group = "seen")]
    pub face: Option<View>,
    /// Section normal to an axis at rest [mm], e.g. y=125.
    #[arg(long, value_name = "AXIS=MM", value_parser = View::section, group = "seen")]
    pub section: Option<View>,
    /// Direction of the view: iso, or degrees around from the front and above, e.g. 35,25.
    #[arg(long, value_name = "VIEW", group = "seen", allow_hyphen_values = true)]
    pub view: Option<View>,
    /// Magnification of the displacements [default: a round one].
    #[arg(long, value_name = "FACTOR", value_parser = factor)]
    pub scale: Option<f64>,
}

impl ViewArguments {
    /// How to draw the wall.
    pub fn look(&self) -> Look {
        let view = self.face.or(self.section).or(self.view);
        Look {
            view: view.unwrap_or_default(),
            scale: self.scale,
            window: None,
        }
    }
}

/// Reads a face by its name.
fn face(text: &str) -> Result<View, String> {
    if ["front", "back", "left", "right", "top"].contains(&text) {
        return text.parse();
    }
    Err("expected front, back, left, right or top".to_owned())
}

fn factor(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(factor) if factor >= 0.0 && f64::is_finite(factor) => Ok(factor),
        _ => Err("expected a number from 0, e.g. 50".to_owned()),
    }
}

/// `wythe animate`
#[derive(Debug, Args)]
pub struct Animate {
    /// Folder of the run.
    pub folder: PathBuf,
    #[command(flatten)]
    pub view: ViewArguments,
    /// File to write [default: DIR/plots/animation.gif]; a folder with --png.
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Width of the picture [px].
    #[arg(long, value_name = "PX", default_value_t = 960, value_parser = clap::value_parser!(u32).range(50..=4000))]
    pub width: u32,
    /// Time that each frame is shown [s].
    #[arg(long, value_name = "S", default_value = "0.15", value_parser = positive)]
    pub delay: f64,
    /// Largest number of frames, at even distances.
    #[arg(long, value_name = "N", default_value_t = 120, value_parser = clap::value_parser!(u32).range(1..=2000))]
    pub most: u32,
    /// Leave out the curve.
    #[arg(long)]
    pub no_curve: bool,
    /// Write a PNG for each frame instead.
    #[arg(long)]
    pub png: bool,
}

/// `wythe compare`
#[derive(Debug, Args)]
pub struct Compare {
    /// Folder of the run.
    pub folder: PathBuf,
    /// The measured curve, a CSV file.
    pub experiment: PathBuf,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
    /// Clear height for the drift [mm] [default: between supports and driven faces].
    #[arg(long, value_name = "MM", value_parser = millimetres)]
    pub height: Option<f64>,
}

/// `wythe evaluate`
#[derive(Debug, Args)]
pub struct Evaluate {
    /// Folders of the runs of one test.
    #[arg(required = true, value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// Print JSON.
    #[arg(long)]
    pub json: bool,
}

/// `wythe info`
#[derive(Debug, Args)]
pub struct Info {
    /// A folder of results, a results.vtkhdf, or a model.
    pub path: PathBuf,
    /// Drifts at which force and displacement are printed, as in "0.3 %, 0.6 %" or 0.003,0.006.
    #[arg(long, value_name = "DRIFTS", value_parser = drifts)]
    pub drifts: Option<Drifts>,
    /// Clear height for these drifts [mm] [default: that of the model].
    #[arg(long, value_name = "MM", requires = "drifts", value_parser = positive)]
    pub height: Option<f64>,
}

/// Limits of drift [-].
#[derive(Clone, Debug, PartialEq)]
pub struct Drifts(pub Vec<f64>);

/// Reads limits of drift: numbers, in percent where a % follows, with commas between.
fn drifts(text: &str) -> Result<Drifts, String> {
    let one = |word: &str| {
        let word = word.trim();
        let (number, unit) = match word.strip_suffix('%') {
            Some(number) => (number.trim_end(), 0.01),
            None => (word, 1.0),
        };
        positive(number).map(|number| unit * number)
    };
    text.split(',')
        .map(one)
        .collect::<Result<_, _>>()
        .map(Drifts)
}

fn positive(text: &str) -> Result<f64, String> {
    let number: Option<f64> = text.parse().ok();
    let number = number.filter(|number| *number > 0.0 && number.is_finite());
    number.ok_or_else(|| format!("`{text}` is no number above 0"))
}

/// `wythe modes`
#[derive(Debug, Args)]
pub struct Modes {
    /// A model, a TOML file, or the folder of a run.
    #[arg(value_name = "MODEL.toml|DIR")]
    pub path: PathBuf,
    /// Number of modes, the lowest first.
    #[arg(long, value_name = "N", default_value = "10")]
    pub count: NonZeroUsize,
    /// Frame of the run: its number from 0, peak, or last [default: last].
    #[arg(long, value_name = "FRAME")]
    pub frame: Option<FrameChoice>,
    /// Folder for the files [default: MODEL.modes, DIR/modes].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the figures as JSON.
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub with: ModelArguments,
}

/// `wythe export`
#[derive(Debug, Args)]
pub struct Export {
    /// Folder of the run, or a model, a TOML file.
    #[arg(value_name = "DIR|MODEL.toml")]
    pub folder: PathBuf,
    /// Format to write.
    #[arg(long, value_name = "FORMAT")]
    pub to: Format,
    /// Frame: its number from 0, peak, last, or all [default: last].
    #[arg(long, value_name = "FRAME")]
    pub frame: Option<Frames>,
    /// Folder for the files [default: DIR/export, MODEL.export].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    #[command(flatten)]
    pub with: ModelArguments,
}

/// Formats of other programs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// XML files of VTK.
    Vtu,
    /// CSV tables.
    Csv,
    /// Input file of Abaqus.
    Inp,
    /// Closed shells of the bodies, Wavefront.
    Obj,
    /// Closed shells of the bodies, PLY.
    Ply,
    /// Closed shells of the bodies, STL.
    Stl,
}

/// One frame or all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frames {
    /// Every frame of the file.
    All,
    /// One frame.
    One(FrameChoice),
}

impl std::str::FromStr for Frames {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        if text == "all" {
            return Ok(Self::All);
        }
        let wrong = |_| "expected a number from 0, `peak`, `last` or `all`".to_owned();
        text.parse().map(Self::One).map_err(wrong)
    }
}

fn millimetres(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(height) if height > 0.0 && f64::is_finite(height) => Ok(height),
        _ => Err("expected millimetres above 0, e.g. 1000".to_owned()),
    }
}
