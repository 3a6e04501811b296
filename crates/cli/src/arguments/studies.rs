//! Command-line arguments of studies.

use std::num::NonZeroUsize;
use std::ops::RangeInclusive;
use std::path::PathBuf;

use crate::study::accuracy::SCENES;
use clap::{Args, Subcommand};
use wythe_core::deck::Strategy;

use super::key_value;

const STABILITY_HELP: &str = "\
Every case is a case.toml with a deck (tests/stability/README.md lists the keys). A line a \
cell tells how it went; a cell that fails is a finding, not an error of the command.

DIR then holds stability.md and stability.svg. Without --out the whole atlas is written to docs, and a \
part of it (--only, --methods, --short) to standard output.

Examples:
  wythe study stability
  wythe study stability --only 1,17 --methods auto,secant --verbose
  wythe study stability --short --jobs 2 --out target/atlas";

/// `wythe study`
#[derive(Debug, Subcommand)]
pub enum Study {
    /// Stability: cases with known answers, run by all methods.
    #[command(after_help = STABILITY_HELP)]
    Stability(Stability),
    /// Validation: results beside tests, exact solutions and other models.
    #[command(after_help = VALIDATION_HELP)]
    Validation(Validation),
    /// Error against time over the choices of a user: mesh, penalty, procedure, step …
    #[command(after_help = ACCURACY_HELP)]
    AccuracySpeed(AccuracySpeed),
    /// One deck by every modelling strategy: limit, rigid, simplified, detailed.
    #[command(after_help = STRATEGIES_HELP)]
    Strategies(Strategies),
    /// Random walls, run with defaults only: how many are solved, and at which cost.
    #[command(after_help = ZOO_HELP)]
    Zoo(Zoo),
}

const STRATEGIES_HELP: &str = "\
Each strategy is run in a process of its own, one after the other. DIR then holds strategies.md (forces, costs, \
differences to the detailed run), strategies.svg (the curves) and a folder for each strategy. The limit analysis has \
associated friction and dry joints; `wythe limit` has more choices.

Examples:
  wythe study strategies wall.toml
  wythe study strategies facade.toml --only simplified,detailed --limit 3600 --threads 2";

const ZOO_HELP: &str = "\
Each seed is a wall: units of eight formats, five bonds, dry to strong joints, pressed by 0.05 to 2 MPa, pushed, \
pushed to and fro, bent by an air bag, with no key of the solver. Each is run in a process of its own.

DIR then holds zoo.md (figures, histogram, the worst walls first), zoo.csv (a row a wall) and walls/ with the deck and \
the folder of each run. Walls that it holds already are not run again, unless with --fresh, so a study that was \
stopped goes on by the same command.

Examples:
  wythe study zoo --seeds 1..200 --out zoo
  wythe study zoo --seeds 1,4,25 --limit 60 --fresh
  wythe study zoo --seeds 1..20 --reference     each beside a careful run
  wythe study zoo --seeds 1..200 --strategy rigid --out zoo-rigid
  wythe study zoo --seeds 7 --decks-only";

const ACCURACY_HELP: &str = "\
Examples:
  wythe study accuracy-speed --repeats 3        all scenes, page and charts into docs
  wythe study accuracy-speed --only 1           one
  wythe study accuracy-speed --short            what the tests run, nothing is written
  wythe study accuracy-speed --only 2 --references   its reference made anew
  wythe study accuracy-speed wall.toml          a model of your own, page and chart into wall.accuracy";

const VALIDATION_HELP: &str = "\
Examples:
  wythe study validation                        all cases, pages into docs/validation
  wythe study validation --only 4               one
  wythe study validation --short                what the tests run, nothing is written";

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
    /// Largest wall time of a cell [s], checked after each increment.
    #[arg(long, value_name = "SECONDS", default_value = "600", value_parser = seconds)]
    pub limit: f64,
    /// Number of cells run at once, each on one thread [default: one per core].
    #[arg(long, value_name = "N")]
    pub jobs: Option<NonZeroUsize>,
    /// Run the short forms, as the tests do.
    #[arg(long)]
    pub short: bool,
    /// Print the measured values too.
    #[arg(long)]
    pub verbose: bool,
    /// Folder for the page and its picture.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `wythe study validation`
#[derive(Debug, Args)]
pub struct Validation {
    /// Folder of the cases, each in a folder with a case.toml.
    #[arg(long, value_name = "DIR", default_value = "docs/validation")]
    pub cases: PathBuf,
    /// Cases of these numbers only, e.g. 1,4.
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',')]
    pub only: Vec<u32>,
    /// Largest wall time of a run [s], checked after each increment.
    #[arg(long, value_name = "SECONDS", default_value = "3600", value_parser = seconds)]
    pub limit: f64,
    /// Number of runs at once, each on one thread [default: one per core].
    #[arg(long, value_name = "N")]
    pub jobs: Option<NonZeroUsize>,
    /// Run the short forms, as the tests do.
    #[arg(long)]
    pub short: bool,
    /// Folder for the folders of the runs.
    #[arg(long, value_name = "DIR", default_value = "target/validation")]
    pub runs: PathBuf,
    /// Folder for the pages [default: beside the cases; for short forms none, only the lines are printed].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `wythe study strategies`
#[derive(Debug, Args)]
pub struct Strategies {
    /// The model.
    #[arg(value_name = "MODEL")]
    pub model: PathBuf,
    /// Replace a key of MODEL, for all strategies (repeatable).
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value)]
    pub overrides: Vec<(String, String)>,
    /// These strategies only: limit, rigid, simplified, detailed.
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub only: Vec<String>,
    /// Largest CPU time of a strategy [s].
    #[arg(long, value_name = "SECONDS", default_value = "600", value_parser = seconds)]
    pub limit: f64,
    /// Number of threads of a run [default: one per core].
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Folder for page, chart and runs [default: MODEL with .strategies].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `wythe study accuracy-speed`
#[derive(Debug, Args)]
pub struct AccuracySpeed {
    /// A model of your own: the study drafts a scene with all its choices, computes its reference, and runs the
    /// choices.
    #[arg(value_name = "MODEL", conflicts_with_all = ["scenes", "only", "short", "references", "redraw"])]
    pub model: Option<PathBuf>,
    /// Replace a key of MODEL, for all of its runs (repeatable).
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value, requires = "model")]
    pub overrides: Vec<(String, String)>,
    /// Folder of the scenes, each in a folder with a scene.toml.
    #[arg(long, value_name = "DIR", default_value = SCENES)]
    pub scenes: PathBuf,
    /// Scenes of these numbers only, e.g. 1,3.
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',')]
    pub only: Vec<u32>,
    /// How often each choice is run, in alternation; times are medians.
    #[arg(long, value_name = "N", default_value = "1")]
    pub repeats: NonZeroUsize,
    /// Largest wall time of a run [s], checked after each increment.
    #[arg(long, value_name = "SECONDS", default_value = "3600", value_parser = seconds)]
    pub limit: f64,
    /// Number of runs at once; more than one disturb each other's times.
    #[arg(long, value_name = "N", default_value = "1")]
    pub jobs: NonZeroUsize,
    /// Run the short forms, as the tests do.
    #[arg(long)]
    pub short: bool,
    /// Only recompute the references that come from runs.
    #[arg(long, conflicts_with_all = ["short", "out"])]
    pub references: bool,
    /// Run nothing: write page and charts from the existing tables, after a change of texts.
    #[arg(long, conflicts_with_all = ["short", "references"])]
    pub redraw: bool,
    /// Folder for charts and tables, with the page beside it [default: that of the scenes; for short forms none, only
    /// the lines are printed]. For a model: folder for the page, and in it `scenes` [default: MODEL.accuracy beside
    /// the model].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `wythe study zoo`
#[derive(Debug, Args)]
pub struct Zoo {
    /// Seeds, e.g. 1,4,25 or 1..200 (both ends included).
    #[arg(long, value_name = "SEEDS", value_delimiter = ',', default_value = "1..200", value_parser = seeds)]
    pub seeds: Vec<RangeInclusive<u64>>,
    /// Folder for decks, runs and the page.
    #[arg(long, value_name = "DIR", default_value = Zoo::OUT)]
    pub out: PathBuf,
    /// Largest CPU time of a wall [s]; its reference may take ten times as long.
    #[arg(long, value_name = "SECONDS", default_value = "300", value_parser = seconds)]
    pub limit: f64,
    /// Number of walls run at once [default: as many as there are cores for their threads].
    #[arg(long, value_name = "N")]
    pub jobs: Option<NonZeroUsize>,
    /// Number of threads per wall.
    #[arg(long, value_name = "N", default_value = "1")]
    pub threads: NonZeroUsize,
    /// Modelling strategy of all walls.
    #[arg(long, value_name = "NAME", default_value = "detailed", value_parser = strategy)]
    pub strategy: Strategy,
    /// Compare each wall with a careful run of the same strategy, except limit: a tenth of the increments, consistent tangents, a tenth of their
    /// tolerance.
    #[arg(long)]
    pub reference: bool,
    /// Repeat the runs of walls that were run before.
    #[arg(long)]
    pub fresh: bool,
    /// Write decks only, without runs.
    #[arg(long, conflicts_with_all = ["limit", "jobs", "threads", "strategy", "reference", "fresh"])]
    pub decks_only: bool,
}

impl Zoo {
    /// Default folder.
    pub const OUT: &str = "zoo";
}

/// Parses the name of a strategy.
fn strategy(text: &str) -> Result<Strategy, String> {
    let known = Strategy::ALL.into_iter();
    let found = known.clone().find(|strategy| strategy.name() == text);
    found.ok_or_else(|| {
        let names: Vec<&str> = known.map(Strategy::name).collect();
        format!("one of {}", names.join(", "))
    })
}

/// Parses a seed, or the first and the last of a range.
fn seeds(text: &str) -> Result<RangeInclusive<u64>, String> {
    let number = |text: &str| text.trim().parse::<u64>();
    let range = match text.split_once("..") {
        Some((first, last)) => number(first).and_then(|f| Ok(f..=number(last)?)),
        None => number(text).map(|seed| seed..=seed),
    };
    match range {
        Ok(range) if !range.is_empty() => Ok(range),
        _ => Err("expected whole numbers, e.g. 1,4,25 or 1..200".to_owned()),
    }
}

/// Parses a time limit [s]; the bound of a year keeps it within the range of clocks.
fn seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if seconds > 0.0 && seconds <= 3.2e7 => Ok(seconds),
        _ => Err("expected seconds above 0, e.g. 600".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_are_numbers_or_ranges_with_both_ends() {
        assert_eq!(seeds("7"), Ok(7..=7));
        assert_eq!(seeds("1..200"), Ok(1..=200));
        for wrong in ["", "a", "-1", "5..4", "1..", "1...3", "1.5"] {
            assert!(seeds(wrong).is_err(), "{wrong}");
        }
    }
}
