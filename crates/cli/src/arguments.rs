//! The command line.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

/// Pushes walls of bricks to collapse: the detailed micro-model of masonry.
///
/// Bricks and mortar are solids that crack and crush, joined by interfaces that open and slide. A
/// model is one TOML file (docs/deck.md lists every key). Units everywhere: N, mm, MPa, tonne, s.
#[derive(Debug, Parser)]
#[command(version, after_help = EXIT_CODES)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

const EXIT_CODES: &str = "\
Examples:
  wythe check examples/03_shear_wall_j7d.toml
  wythe run examples/03_shear_wall_j7d.toml --threads 4
  wythe drive material brick --model examples/03_shear_wall_j7d.toml --path tension.csv

Exit codes: 0 completed; 2 bad model or usage; 3 not converged, results kept; 4 input/output; \
130 interrupted; 1 a bug of wythe.";

const RUN_HELP: &str = "\
The folder then holds:
  history.csv            a row an increment [mm, kN, J], written as the run goes
  results.vtkhdf         displacements, stresses, damage: ParaView 5.12, VTK 9.3 or later
  model.toml, checkpoint.bin   for `wythe resume`, should the run be stopped
  load_displacement.svg, crack_pattern.svg
  summary.json           written last: a folder without it is not whole
Results of an earlier run in it are replaced. Ctrl-C finishes the increment and writes everything; \
a second Ctrl-C stops at once.

Examples:
  wythe run examples/03_shear_wall_j7d.toml
  wythe run wall.toml --out fine.out --set wall.mesh=fine --set steps.1.displacement='6 mm'";

const RESUME_HELP: &str = "\
A run writes checkpoint.bin as it goes. Whatever stopped it (Ctrl-C, a kill, the power), it goes on from \
there, and history.csv becomes what it would have been, to the last bit. Rows and frames after the \
checkpoint are computed again. The deck is DIR/model.toml; beside `title` and `output` it must be the one \
that the run began with. Only the last step may become longer: its displacement, angle or duration. It \
keeps its speed and its increments in mm, deg or s.

Examples:
  wythe resume wall.out
  wythe resume wall.out --threads 4 --set output.every=1
  wythe resume wall.out --set steps.1.displacement='6 mm'";

const CHECK_HELP: &str = "\
Prints warnings, what follows from the model (fracture energies, stiffnesses, lengths of elements, \
the bond), its sizes, and the memory [MB] that a run takes.

Examples:
  wythe check examples/03_shear_wall_j7d.toml
  wythe check wall.toml --set wall.mesh=fine";

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

const STABILITY_HELP: &str = "\
Every case is a case.toml with a deck (tests/stability/README.md lists the keys). A line a \
cell tells how it went; a cell that fails is a finding, not an error of the command.

DIR then holds stability.md and stability.svg. Without --out the whole atlas is written to docs, and a \
part of it (--only, --methods, --short) to standard output.

Examples:
  wythe study stability
  wythe study stability --only 1,17 --methods auto,secant --verbose
  wythe study stability --short --jobs 2 --out target/atlas";

/// The sub-commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Run a model through all its steps.
    #[command(after_help = RUN_HELP)]
    Run(Run),
    /// Go on with a run that stopped, from its last checkpoint.
    #[command(after_help = RESUME_HELP)]
    Resume(Resume),
    /// Check a model without running it: syntax, units, ranges, physics, sizes.
    #[command(after_help = CHECK_HELP)]
    Check(Check),
    /// Take one material or interface point along a prescribed path.
    Drive(Drive),
    /// Many runs side by side, judged and told on one page.
    #[command(subcommand)]
    Study(Study),
}

/// `wythe study`
#[derive(Debug, Subcommand)]
pub enum Study {
    /// Where each method fails: cases with known answers through all methods.
    #[command(after_help = STABILITY_HELP)]
    Stability(Stability),
}

/// `wythe study stability`
#[derive(Debug, Args)]
pub struct Stability {
    /// Folder of the cases.
    #[arg(long, value_name = "DIR", default_value = "tests/stability/cases")]
    pub cases: PathBuf,
    /// Cases of these numbers only, e.g. 1,5,10b.
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',')]
    pub only: Vec<String>,
    /// These methods only, e.g. auto,secant.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub methods: Vec<String>,
    /// Wall seconds that a cell may take, looked at after each increment.
    #[arg(long, value_name = "SECONDS", default_value = "600", value_parser = seconds)]
    pub limit: f64,
    /// Cells at a time, each on one thread [default: one a core].
    #[arg(long, value_name = "N")]
    pub jobs: Option<NonZeroUsize>,
    /// The short forms, as the tests run them.
    #[arg(long)]
    pub short: bool,
    /// Tell what was measured, too.
    #[arg(long)]
    pub verbose: bool,
    /// Folder for the page and its picture.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// A model and what is said anew of it.
#[derive(Debug, Args)]
pub struct ModelArguments {
    /// Say a key of the model anew, e.g. steps.1.increments.max=0.02 (repeatable). The path is
    /// dotted, arrays count from 0; the value is TOML or a bare string, checked like the file.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub overrides: Vec<(String, String)>,
}

/// `wythe run`
#[derive(Debug, Args)]
pub struct Run {
    /// The model, a TOML file.
    pub model: PathBuf,
    /// Folder for the results [default: MODEL.out beside the model].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Threads; results do not depend on them [default: all cores].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    #[command(flatten)]
    pub with: ModelArguments,
}

/// `wythe resume`
#[derive(Debug, Args)]
pub struct Resume {
    /// Folder of the run.
    #[arg(value_name = "DIR")]
    pub folder: PathBuf,
    /// Threads; results do not depend on them [default: all cores].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    #[command(flatten)]
    pub with: ModelArguments,
}

/// `wythe check`
#[derive(Debug, Args)]
pub struct Check {
    /// The model, a TOML file.
    pub model: PathBuf,
    #[command(flatten)]
    pub with: ModelArguments,
}

/// `wythe drive`
#[derive(Debug, Args)]
pub struct Drive {
    /// What kind of point.
    #[command(subcommand)]
    pub point: Point,
}

/// The kinds of points.
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
    /// The path: a CSV file with a header, a row a step; # begins a comment.
    #[arg(long, value_name = "PATH.csv")]
    pub path: PathBuf,
    /// Where the answer goes [default: standard output].
    #[arg(long, value_name = "OUT.csv")]
    pub out: Option<PathBuf>,
    /// Implicit steps a row.
    #[arg(long, value_name = "N", default_value = "1")]
    pub substeps: NonZeroUsize,
    /// Drive this component by its stress column and solve for its strain: xx yy zz xy yz zx of a
    /// material, normal tau1 tau2 of an interface (repeatable).
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

/// A time that a clock can hold: a year is longer than any run.
fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if seconds > 0.0 && seconds <= 3.2e7 => Ok(seconds),
        _ => Err("expected seconds above 0, e.g. 600".to_owned()),
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
