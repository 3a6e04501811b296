//! The command line of studies.

use std::num::NonZeroUsize;
use std::ops::RangeInclusive;
use std::path::PathBuf;

use crate::study::accuracy::SCENES;
use clap::{Args, Subcommand};

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
    /// Where each method fails: cases with known answers through all methods.
    #[command(after_help = STABILITY_HELP)]
    Stability(Stability),
    /// What comes out beside what is known: tests, exact solutions, other models.
    #[command(after_help = VALIDATION_HELP)]
    Validation(Validation),
    /// Error against time over the choices that a user has: mesh, penalty, procedure, step …
    #[command(after_help = ACCURACY_HELP)]
    AccuracySpeed(AccuracySpeed),
    /// Random walls, run as a newcomer would: how many come to an answer, and at which cost.
    #[command(after_help = ZOO_HELP)]
    Zoo(Zoo),
}

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

/// `wythe study validation`
#[derive(Debug, Args)]
pub struct Validation {
    /// Folder of the cases, each in a folder with a case.toml.
    #[arg(long, value_name = "DIR", default_value = "docs/validation")]
    pub cases: PathBuf,
    /// Cases of these numbers only, e.g. 1,4.
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',')]
    pub only: Vec<u32>,
    /// Wall seconds that a run may take, looked at after each increment.
    #[arg(long, value_name = "SECONDS", default_value = "3600", value_parser = seconds)]
    pub limit: f64,
    /// Runs at a time, each on one thread [default: one a core].
    #[arg(long, value_name = "N")]
    pub jobs: Option<NonZeroUsize>,
    /// The short forms, as the tests run them.
    #[arg(long)]
    pub short: bool,
    /// Folder for the folders of the runs.
    #[arg(long, value_name = "DIR", default_value = "target/validation")]
    pub runs: PathBuf,
    /// Folder for the pages [default: beside the cases; of short forms: none, only the lines].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `wythe study accuracy-speed`
#[derive(Debug, Args)]
pub struct AccuracySpeed {
    /// A model of your own: a scene of it is drafted, over all that may be chosen of it, its reference made, and the choices run.
    #[arg(value_name = "MODEL", conflicts_with_all = ["scenes", "only", "short", "references", "redraw"])]
    pub model: Option<PathBuf>,
    /// Say a key of MODEL anew, for all of its runs (repeatable).
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = key_value, requires = "model")]
    pub overrides: Vec<(String, String)>,
    /// Folder of the scenes, each in a folder with a scene.toml.
    #[arg(long, value_name = "DIR", default_value = SCENES)]
    pub scenes: PathBuf,
    /// Scenes of these numbers only, e.g. 1,3.
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',')]
    pub only: Vec<u32>,
    /// How often each choice is run, by turns; times are medians.
    #[arg(long, value_name = "N", default_value = "1")]
    pub repeats: NonZeroUsize,
    /// Wall seconds that a run may take, looked at after each increment.
    #[arg(long, value_name = "SECONDS", default_value = "3600", value_parser = seconds)]
    pub limit: f64,
    /// Runs at a time; more than one disturb each other's times.
    #[arg(long, value_name = "N", default_value = "1")]
    pub jobs: NonZeroUsize,
    /// The short forms, as the tests run them.
    #[arg(long)]
    pub short: bool,
    /// Make the references anew that come from runs, and nothing else.
    #[arg(long, conflicts_with_all = ["short", "out"])]
    pub references: bool,
    /// Run nothing: page and charts anew from the tables that stand there, after a change of texts.
    #[arg(long, conflicts_with_all = ["short", "references"])]
    pub redraw: bool,
    /// Folder for charts and tables; the page stands beside it [default: that of the scenes; of short forms: none, only
    /// the lines]. Of a model: folder for the page, and in it `scenes` [default: MODEL.accuracy beside the model].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `wythe study zoo`
#[derive(Debug, Args)]
pub struct Zoo {
    /// Seeds, e.g. 1,4,25 or 1..200 (both ends included).
    #[arg(long, value_name = "SEEDS", value_delimiter = ',', default_value = "1..200", value_parser = seeds)]
    pub seeds: Vec<RangeInclusive<u64>>,
    /// Folder for all of it.
    #[arg(long, value_name = "DIR", default_value = Zoo::OUT)]
    pub out: PathBuf,
    /// CPU seconds that a wall may take; its reference may take ten times as many.
    #[arg(long, value_name = "SECONDS", default_value = "300", value_parser = seconds)]
    pub limit: f64,
    /// Walls at a time [default: as many as there are cores for their threads].
    #[arg(long, value_name = "N")]
    pub jobs: Option<NonZeroUsize>,
    /// Threads of a wall.
    #[arg(long, value_name = "N", default_value = "1")]
    pub threads: NonZeroUsize,
    /// Compare each wall with a careful run: increments a tenth, consistent tangents, a tenth of their tolerance.
    #[arg(long)]
    pub reference: bool,
    /// Run walls again that were run before.
    #[arg(long)]
    pub fresh: bool,
    /// Write decks and run nothing.
    #[arg(long, conflicts_with_all = ["limit", "jobs", "threads", "reference", "fresh"])]
    pub decks_only: bool,
}

impl Zoo {
    /// Where it goes unless it is said.
    pub const OUT: &str = "zoo";
}

/// A seed, or the first and the last of several.
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

    #[test]
    fn seeds_are_numbers_or_ranges_with_both_ends() {
        assert_eq!(seeds("7"), Ok(7..=7));
        assert_eq!(seeds("1..200"), Ok(1..=200));
        for wrong in ["", "a", "-1", "5..4", "1..", "1...3", "1.5"] {
            assert!(seeds(wrong).is_err(), "{wrong}");
        }
    }
}
