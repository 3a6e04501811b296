//! The command line.

mod results;
mod studies;

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::builder::PossibleValuesParser;
use clap::{Args, Parser, Subcommand, ValueEnum};
use wythe_core::deck::{Strategy, specimens, templates};

use results::{
    ANIMATE_HELP, COMPARE_HELP, EVALUATE_HELP, EXPORT_HELP, INFO_HELP, MODES_HELP, PLOT_HELP,
};
pub use results::{Animate, Compare, Evaluate, Export, Format, Frames, Info, Modes, Plot};
pub use studies::{AccuracySpeed, Stability, Strategies, Study, Validation, Zoo};

/// Computes the collapse of masonry walls by the detailed micro-model.
///
/// Bricks and mortar are solids that crack and crush, joined by interfaces that open and slide. A model is one TOML
/// file (docs/reference/deck.md lists every key). Units everywhere: N, mm, MPa, tonne, s.
#[derive(Debug, Parser)]
#[command(name = "wythe", version, after_help = EXIT_CODES)]
pub struct Arguments {
    /// The sub-command.
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "\
Examples:
  wythe new wall --template shear-wall
  wythe check wall.toml
  wythe run wall.toml --threads 4
  wythe drive material brick --model wall.toml --path tension.csv

Exit codes: 0 completed or collapsed; 2 bad model or usage; 3 not converged, results kept; 4 input/output; \
130 interrupted; 1 a bug of wythe.";

const RUN_HELP: &str = "\
The folder then holds:
  history.csv            a row an increment [mm, kN, J], written as the run goes
  results.vtkhdf         displacements, stresses, damage: ParaView 5.12, VTK 9.3 or later
  results.interfaces.vtkhdf  shows the joints beside them
  run.mcap               the same in time, with the deformed wall, for Foxglove
  model.toml, checkpoint.bin   for `wythe resume`, should the run be stopped
  load_displacement.svg, crack_pattern.svg
  summary.json           written last: a folder without it is not whole
  error/time, error/mesh the companions of --error, folders of the same kind
Results of an earlier run in it are replaced. Ctrl-C finishes the increment and writes everything; \
a second Ctrl-C stops at once. SIGTERM and SIGHUP do as the first Ctrl-C.

Progress goes to standard error: a bar with the force so far and the time left on a terminal, a line an \
increment elsewhere. With --progress json it goes to standard output, an object a line, its \
\"event\" one of begin, increment, note, end. NO_COLOR takes the colours away; where the locale is not \
UTF-8, all is drawn in ASCII.

Examples:
  wythe run wall.toml
  wythe run wall.toml --error
  wythe run wall.toml --progress json | jq .force_kN
  wythe run wall.toml --out fine.out --set wall.mesh=fine --set steps.1.displacement='6 mm'";

const RESUME_HELP: &str = "\
A run writes checkpoint.bin as it goes. Whatever stopped it (Ctrl-C, a kill, the power), it goes on from \
there, and history.csv becomes what it would have been, to the last bit. Rows and frames after the \
checkpoint are computed again; files that have changed since are reported and written again. The deck is DIR/model.toml; beside `title` and `output` it must be the one \
that the run began with. Only the last step may become longer (its displacement, angle or duration; it \
keeps its speed and its increments in mm, deg or s) or end elsewhere (its `stop`).

Examples:
  wythe resume wall.out
  wythe resume wall.out --threads 4 --set output.every=1
  wythe resume wall.out --set steps.1.displacement='6 mm'";

const CHECK_HELP: &str = "\
Two layers. The form: keys, types, units, ranges, names; and where that is right the physics: tables, \
snap-back, bodies that nothing holds, faces that do not meet. All errors of a layer are reported at once, with \
line, place and advice.

Where there are none: warnings, what follows from the model (fracture energies, stiffnesses, lengths of elements, \
the bond), its sizes, and an estimate of the memory [MB] and of the processor time [s] that a run takes.

With --json one object on standard output, errors or not: file, ok, layer (\"file\", \"form\" or \"physics\", \
where ok is false), errors [kind, file, key, line, column, message, help], warnings [key, line, column, message, \
others]; and \
where ok is true title, notes, sizes, memory_MB, processor_time_s.

Examples:
  wythe check wall.toml
  wythe check wall.toml --json | jq '.errors[] | [.line, .key, .message]'
  wythe check wall.toml --set wall.mesh=fine";

const SALVAGE_HELP: &str = "\
A run that was killed leaves a run.mcap without an end and an index, which viewers want. This reads it \
in its order up to the last whole record, which loses the increment that was under way, and writes a \
whole file. Not while the run goes on, unless with --out.

Examples:
  wythe salvage wall.out/run.mcap
  wythe salvage wall.out/run.mcap --out salvaged.mcap";
const NEW_HELP: &str = "\
Writes NAME.toml, a commented deck that runs as it is, and beside it deck.schema.json, by which editors \
complete and check it (any with a TOML language server, such as taplo or Even Better TOML).

--from writes a deck around a mesh of Abaqus or Gmsh that lies beside it: its materials as tables, its bodies, \
sets and surfaces in comments, and, in comments, the keys that are still missing.

--test writes the decks of a standard test, one for each precompression or direction: specimen, platens, gauges, \
loading. `wythe evaluate` gives what the test reports (docs/reference/standard-tests.md).

Examples:
  wythe new --list
  wythe new triplet --test en1052-3 --unit 250x120x55 --precompression '0.2, 0.6, 1.0 MPa'
  wythe new bridge --from bridge.inp --units 'N, m, s'
  wythe new wall --template shear-wall
  wythe new tests/arch --template arch --force";

const SCHEMA_HELP: &str = "\
Editors with a TOML language server complete and check a deck whose first line names the schema:
  #:schema ./deck.schema.json

Example:
  wythe schema > deck.schema.json";

const COMPLETIONS_HELP: &str = "\
Examples:
  wythe completions bash > ~/.local/share/bash-completion/completions/wythe
  wythe completions zsh > ~/.zfunc/_wythe
  wythe completions fish > ~/.config/fish/completions/wythe.fish";

const MAN_HELP: &str = "\
Examples:
  wythe man | man -l -
  wythe man --out ~/.local/share/man/man1";

const DRIVE_HELP: &str = "\
Examples:
  wythe drive material brick --model wall.toml --path tension.csv
  wythe drive interface joint --model wall.toml --path shear.csv --stress normal";

const STUDY_HELP: &str = "\
Example:
  wythe study stability --short --only 1,17";

const MATERIAL_HELP: &str = "\
PATH.csv has the columns eps_xx eps_yy eps_zz gam_xy gam_yz gam_zx [-] (engineering shear, tension \
positive) in any order; others are carried along. A component named by --stress takes sig_xx_MPa … \
sig_zx_MPa instead. A column time [s] matters for viscosity; without it a row takes 1 s. A point has \
no size: the tables of the material are taken as given.

OUT.csv repeats the path and adds sig_xx_MPa … sig_zx_MPa kt kc dt dc d: hardening in tension and \
compression [-], damage in tension, in compression, and of the stress [-].

Examples:
  wythe drive material brick --model wall.toml --path triaxial.csv --out answer.csv
  wythe drive material brick --model wall.toml --path uniaxial.csv --stress yy --stress zz";

const INTERFACE_HELP: &str = "\
PATH.csv has the columns u_mm d1_mm d2_mm (opening, slips [mm]) in any order; others are carried \
along. A component named by --stress takes sig_MPa, tau1_MPa, tau2_MPa instead (tension positive). \
The interface needs normal_stiffness and shear_stiffness [N/mm^3], in the model or by --set.

OUT.csv repeats the path and adds sig_MPa tau1_MPa tau2_MPa D: tractions and damage [-].

Example, shear at constant compression:
  wythe drive interface joint --model wall.toml --path shear.csv --stress normal \\
    --set interfaces.joint.normal_stiffness=34000 --set interfaces.joint.shear_stiffness=14783";

const REPORT_HELP: &str = "\
One file that needs no network: the curve (click to move through the run), the deformed wall in 3D \
with its damage, cracks and joints, key figures, energies, convergence, log, warnings, deck. It works \
while a run goes on or after it was killed, too, and says what is missing. Frames are left out where \
the page would exceed 2 MB (16 MB for large scenes).

EXPERIMENT.csv has a line of names with displacement_mm and force_kN (or names that end so) and a row a \
point [mm, kN]; # begins a comment.

Examples:
  wythe report examples/03_shear_wall_j7d.out
  wythe report wall.out --experiment measured.csv --out wall.html";

const VIEW_HELP: &str = "\
Serves the page of `wythe report` to browsers of this machine and prints its address. The page of a run is \
renewed at every frame while the run goes on. The page of a model shows its mesh at rest and is renewed \
whenever its file changes; errors of the file are shown in its place. Ctrl-C ends it.

Examples:
  wythe run wall.toml & wythe view wall.out
  wythe view wall.toml
  wythe view wall.toml --port 8000 --set wall.length=\"2 m\"";

const LIMIT_HELP: &str = "\
Units are rigid, joints are the polygons in which they touch. The factor multiplies the last step that drives, \
loads or tilts; what stands before it is dead load. Without --associated sliding has no dilatancy. A force along a \
drive is given in kN.

Examples:
  wythe limit examples/67_segmental_arch.toml --along x --picture arch.svg
  wythe limit wall.toml --bonded --strength '8 MPa' --json";

/// The sub-commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Write a commented deck that runs as it is.
    #[command(after_help = NEW_HELP)]
    New(New),
    /// Run a model through all its steps.
    #[command(after_help = RUN_HELP)]
    Run(Run),
    /// Continue a stopped run from its last checkpoint.
    #[command(after_help = RESUME_HELP)]
    Resume(Resume),
    /// Check a model without running it: syntax, units, ranges, physics, sizes.
    #[command(after_help = CHECK_HELP)]
    Check(Check),
    /// Find the largest load that rigid units on their joints carry, and the mechanism.
    #[command(after_help = LIMIT_HELP)]
    Limit(Limit),
    /// Drive one material or interface point along a prescribed path.
    #[command(after_help = DRIVE_HELP)]
    Drive(Drive),
    /// Repair the run.mcap of an interrupted run.
    #[command(after_help = SALVAGE_HELP)]
    Salvage(Salvage),
    /// Show a run on one HTML page.
    #[command(after_help = REPORT_HELP)]
    Report(ReportPage),
    /// Show a run, or a model before its run, in a browser, and keep the page up to date.
    #[command(after_help = VIEW_HELP)]
    View(ViewPage),
    /// Draw a run: curves beside experiments and other runs, columns of the history, cracks, deflections.
    #[command(after_help = PLOT_HELP)]
    Plot(Plot),
    /// Animate a run: the deformed wall with its cracks frame by frame, and the curve beside it.
    #[command(after_help = ANIMATE_HELP)]
    Animate(Animate),
    /// Compare a run with an experiment, in numbers.
    #[command(after_help = COMPARE_HELP)]
    Compare(Compare),
    /// Evaluate the runs of a standard test: what the test reports.
    #[command(after_help = EVALUATE_HELP)]
    Evaluate(Evaluate),
    /// Find keys of decks from measured curves: of the Python package.
    #[command(hide = true, disable_help_flag = true)]
    Calibrate(Calibrate),
    /// Describe a folder of results, a file of fields, or a model.
    #[command(after_help = INFO_HELP)]
    Info(Info),
    /// Write a run, or a model, in the format of another program.
    #[command(after_help = EXPORT_HELP)]
    Export(Export),
    /// Find natural frequencies, modal masses and mode shapes of a model, or of the damaged wall of a run.
    #[command(after_help = MODES_HELP)]
    Modes(Modes),
    /// Run many models, evaluate them and report them on one page.
    #[command(subcommand, after_help = STUDY_HELP)]
    Study(Study),
    /// Print the JSON schema of decks, with which editors complete and check them.
    #[command(after_help = SCHEMA_HELP)]
    Schema,
    /// Print a completion script of this command for a shell.
    #[command(after_help = COMPLETIONS_HELP)]
    Completions(Completions),
    /// Print the manual page, or write the pages of all sub-commands.
    #[command(after_help = MAN_HELP)]
    Man(Man),
}

/// Changes of a model on the command line.
#[derive(Debug, Args)]
pub struct ModelArguments {
    /// Replace a key of the model, e.g. steps.1.increments.max=0.02 (repeatable). The path is dotted, arrays count
    /// from 0; the value is TOML or a bare string, checked like the file.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    overrides: Vec<(String, String)>,
    /// How much of the walls is modelled; that of the model, or detailed, if not given.
    #[arg(long, value_name = "STRATEGY", value_parser = PossibleValuesParser::new(Strategy::ALL.map(Strategy::name)))]
    strategy: Option<String>,
}

impl ModelArguments {
    /// Keys that are replaced, and their values.
    pub fn overrides(&self) -> Vec<(String, String)> {
        let strategy = self.strategy.iter();
        let strategy = strategy.map(|name| ("strategy".to_owned(), name.clone()));
        self.overrides.iter().cloned().chain(strategy).collect()
    }
}

/// `wythe run`
#[derive(Debug, Args)]
pub struct Run {
    /// The model, a TOML file.
    pub model: PathBuf,
    /// Folder for the results [default: MODEL.out beside the model].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Number of threads; results do not depend on it [default: all cores].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// How progress is shown.
    #[arg(long, value_enum, value_name = "HOW", default_value = "auto")]
    pub progress: Progress,
    /// Print errors only.
    #[arg(long, short, conflicts_with = "progress")]
    pub quiet: bool,
    /// Run the model again with half the increments and with a finer mesh, and estimate the error of peak, area and
    /// displacement at the peak: takes four to six times as long.
    #[arg(long)]
    pub error: bool,
    #[command(flatten)]
    pub with: ModelArguments,
}

/// How progress is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Progress {
    /// A bar on a terminal, lines elsewhere.
    Auto,
    /// One line per increment, on standard error.
    Plain,
    /// One JSON object per increment, on standard output.
    Json,
}

/// `wythe new`
#[derive(Debug, Args)]
pub struct New {
    /// Name of the deck: NAME.toml is written.
    #[arg(required_unless_present = "list")]
    pub name: Option<PathBuf>,
    /// Template of the deck, see --list.
    #[arg(long, value_name = "TEMPLATE", value_parser = PossibleValuesParser::new(templates::NAMES), default_value = "couplet")]
    pub template: String,
    /// Mesh to import: an .inp of Abaqus or a .msh of Gmsh.
    #[arg(long, value_name = "FILE", conflicts_with = "template")]
    pub from: Option<PathBuf>,
    /// Units of force, length and time in that file.
    #[arg(
        long,
        value_name = "UNITS",
        default_value = "N, mm, s",
        requires = "from"
    )]
    pub units: String,
    /// Standard test: its specimen, gauges and loading, see --list.
    #[arg(long, value_name = "TEST", value_parser = PossibleValuesParser::new(specimens::NAMES), conflicts_with_all = ["template", "from"])]
    pub test: Option<String>,
    #[command(flatten)]
    pub specimen: Specimen,
    /// Overwrite NAME.toml.
    #[arg(long)]
    pub force: bool,
    /// List the templates and the standard tests.
    #[arg(long, conflicts_with_all = ["name", "template", "force", "from", "test"])]
    pub list: bool,
}

/// Options of the specimen of `wythe new --test`.
#[derive(Debug, Args)]
pub struct Specimen {
    /// Length, thickness and height of a unit [mm] [default: 250x120x55].
    #[arg(
        long,
        value_name = "LxTxH",
        requires = "test",
        allow_hyphen_values = true
    )]
    pub unit: Option<String>,
    /// Thickness of the joints [mm] [default: 10].
    #[arg(long, value_name = "MM", requires = "test", allow_hyphen_values = true)]
    pub joint: Option<String>,
    /// Precompressions, such as "0.2, 0.6, 1.0 MPa": a deck for each.
    #[arg(
        long,
        value_name = "LIST",
        requires = "test",
        allow_hyphen_values = true
    )]
    pub precompression: Option<String>,
    /// Length and height of a wall [mm], such as 1200x1200; the nearest whole units and courses are taken.
    #[arg(
        long,
        value_name = "LxH",
        requires = "test",
        allow_hyphen_values = true
    )]
    pub size: Option<String>,
    /// TOML file with [materials.unit], [materials.mortar] and [interfaces.joint] [default: of the catalogue].
    #[arg(long, value_name = "FILE", requires = "test")]
    pub materials: Option<PathBuf>,
}

/// `wythe calibrate`, which only the Python package has
#[derive(Debug, Args)]
pub struct Calibrate {
    /// Arguments, passed on.
    #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
    pub said: Vec<String>,
}

/// `wythe completions`
#[derive(Debug, Args)]
pub struct Completions {
    /// The shell.
    pub shell: clap_complete::Shell,
}

/// `wythe man`
#[derive(Debug, Args)]
pub struct Man {
    /// Folder for the pages of all sub-commands: wythe.1, wythe-run.1, ...
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `wythe resume`
#[derive(Debug, Args)]
pub struct Resume {
    /// Folder of the run.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Number of threads; results do not depend on it [default: all cores].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// How progress is shown.
    #[arg(long, value_enum, value_name = "HOW", default_value = "auto")]
    pub progress: Progress,
    /// Print errors only.
    #[arg(long, short, conflicts_with = "progress")]
    pub quiet: bool,
    #[command(flatten)]
    pub with: ModelArguments,
}

/// `wythe check`
#[derive(Debug, Args)]
pub struct Check {
    /// The model, a TOML file.
    pub model: PathBuf,
    /// Print one JSON object.
    #[arg(long)]
    pub json: bool,
    /// Draw the model, as SVG or PNG by the file's extension.
    #[arg(long, value_name = "FILE")]
    pub picture: Option<PathBuf>,
    #[command(flatten)]
    pub with: ModelArguments,
}

/// `wythe limit`
#[derive(Debug, Args)]
pub struct Limit {
    /// The model, a TOML file.
    pub model: PathBuf,
    /// Let sliding joints open by the friction times the slip: an upper bound.
    #[arg(long)]
    pub associated: bool,
    /// Give joints their tensile strength and cohesion; without, they are dry.
    #[arg(long)]
    pub bonded: bool,
    /// Compressive strength of the joints, such as '8 MPa'; without, it is infinite.
    #[arg(long, value_name = "PRESSURE", allow_hyphen_values = true)]
    pub strength: Option<String>,
    /// Body force over the weight along this direction, in place of the live step.
    #[arg(long, value_name = "DIRECTION", allow_hyphen_values = true)]
    pub along: Option<String>,
    /// Draw the mechanism and the forces, as SVG or PNG by the file's extension.
    #[arg(long, value_name = "FILE")]
    pub picture: Option<PathBuf>,
    /// Folder for figures, mechanism and forces as JSON, VTKHDF and SVG; without, nothing is written.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print one JSON object.
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub with: ModelArguments,
}

/// `wythe salvage`
#[derive(Debug, Args)]
pub struct Salvage {
    /// The file, run.mcap in the folder of a run.
    pub file: PathBuf,
    /// File to write [default: replace the file].
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// `wythe report`
#[derive(Debug, Args)]
pub struct ReportPage {
    /// Folder of a run.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// File of the page [default: DIR/report.html].
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
    /// Measured curve to draw over the computed one.
    #[arg(long, value_name = "FILE.csv")]
    pub experiment: Option<PathBuf>,
}

/// `wythe view`
#[derive(Debug, Args)]
pub struct ViewPage {
    /// Folder of a run, or a model, a TOML file.
    #[arg(value_name = "DIR|MODEL")]
    pub path: PathBuf,
    /// Port on 127.0.0.1; any free one if not given.
    #[arg(long, default_value_t = 0, hide_default_value = true)]
    pub port: u16,
    #[command(flatten)]
    pub with: ModelArguments,
}

/// `wythe drive`
#[derive(Debug, Args)]
pub struct Drive {
    /// Kind of point.
    #[command(subcommand)]
    pub point: Point,
}

/// Kinds of points.
#[derive(Debug, Subcommand)]
pub enum Point {
    /// A point of a solid, driven by strains or stresses.
    #[command(after_help = MATERIAL_HELP)]
    Material(DrivePoint),
    /// A point of an interface, driven by opening and slips or by tractions.
    #[command(after_help = INTERFACE_HELP)]
    Interface(DrivePoint),
}

/// `wythe drive material` and `wythe drive interface`
#[derive(Debug, Args)]
pub struct DrivePoint {
    /// Name of the material or interface in the model.
    pub name: String,
    /// The model, a TOML file.
    #[arg(long, value_name = "MODEL.toml")]
    pub model: PathBuf,
    /// The path: a CSV file with a header and one row per step; # begins a comment.
    #[arg(long, value_name = "PATH.csv")]
    pub path: PathBuf,
    /// File of the response [default: standard output].
    #[arg(long, value_name = "OUT.csv")]
    pub out: Option<PathBuf>,
    /// Implicit steps per row.
    #[arg(long, value_name = "N", default_value = "1")]
    pub substeps: NonZeroUsize,
    /// Drive this component by its stress column and solve for its strain: xx yy zz xy yz zx of a material, normal
    /// tau1 tau2 of an interface (repeatable).
    #[arg(long, value_name = "COMPONENT")]
    pub stress: Vec<String>,
    #[command(flatten)]
    pub with: ModelArguments,
}

fn key_value(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((key, value)) if !key.trim().is_empty() && !value.trim().is_empty() => {
            Ok((key.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("expected KEY=VALUE, e.g. steps.1.increments.max=0.02".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn overrides_split_at_the_first_equals_sign() {
        let parse = |text: &str| key_value(text).map(|(k, v)| format!("{k}|{v}"));
        assert_eq!(parse("a.b = 2.12 MPa").as_deref(), Ok("a.b|2.12 MPa"));
        assert_eq!(parse("title=a=b").as_deref(), Ok("title|a=b"));
        for wrong in ["a.b", "=1", "a="] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}
