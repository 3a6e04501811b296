//! Runs the validation cases.

use std::path::{Path, PathBuf};
use std::time::Duration;

use super::case::{Case, Run};
use super::point::PointTest;
use crate::study::History;
use crate::study::cell::{Cost, Verdict};
use crate::study::expect::Measured;
use crate::study::judge::{Ended, compare, judge};
use crate::study::parallel::{on_one_thread, side_by_side};
use crate::study::run::{self, Watch};
use wythe_core::deck::Deck;
use wythe_core::model::Model;
use wythe_core::results::elevation::crack_pattern_of;
use wythe_core::results::plotting::scene;
use wythe_core::results::snapshot::{FrameChoice, Snapshots};
use wythe_core::results::{RunDirectory, RunFolder};

/// Options of the validation.
#[derive(Clone, Debug)]
pub struct Options {
    /// Whether the short forms are run instead of the full ones.
    pub short: bool,
    /// Largest wall time of a run, checked after each increment.
    pub limit: Duration,
    /// Number of runs at a time, each on one thread.
    pub jobs: usize,
    /// Folder for the results of the runs, with a sub-folder per case.
    pub folder: PathBuf,
}

/// Result of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Name of the run.
    pub name: String,
    /// Verdict on the run.
    pub verdict: Verdict,
    /// Measured values of the expectations of this form, in their order.
    pub measured: Vec<Measured>,
    /// Cost of the run.
    pub cost: Cost,
    /// Energy imbalance [-].
    pub energy: f64,
    /// Columns of the history.
    pub history: History,
    /// Deck with its overrides as TOML; none if the run failed before it was built.
    pub deck: Option<String>,
    /// Picture of the model as SVG, if requested.
    pub scene: Option<String>,
    /// Picture of the cracks as SVG, if requested.
    pub cracks: Option<String>,
}

/// A case with the results of its runs.
#[derive(Clone, Debug)]
pub struct Validated {
    /// The case.
    pub case: Case,
    /// Whether the results are those of the short forms.
    pub short: bool,
    /// Results in the order of the runs; runs without the requested form are missing.
    pub outcomes: Vec<Outcome>,
}

impl Validated {
    /// Result of the run of this name.
    pub fn outcome(&self, name: &str) -> Option<&Outcome> {
        self.outcomes.iter().find(|o| o.name == name)
    }
}

/// Runs the cases. `progress` is called with each finished run, on any thread. `stop` is called after each
/// increment; runs that have not begun when it returns true are missing.
pub fn validate(
    cases: &[Case],
    options: &Options,
    progress: &(dyn Fn(&Case, &Outcome) + Sync),
    stop: &(dyn Fn() -> bool + Sync),
) -> Vec<Validated> {
    let jobs: Vec<(usize, &Run)> = cases
        .iter()
        .enumerate()
        .flat_map(|(i, case)| case.runs.iter().map(move |run| (i, run)))
        .filter(|(_, run)| run.overrides(options.short).is_some())
        .collect();
    let run = |(i, run): (usize, &Run)| {
        let case = &cases[i];
        let outcome = outcome(case, run, options, stop);
        progress(case, &outcome);
        (i, outcome)
    };
    let mut all: Vec<Validated> = cases
        .iter()
        .map(|case| Validated {
            case: case.clone(),
            short: options.short,
            outcomes: Vec::new(),
        })
        .collect();
    for (i, outcome) in side_by_side(jobs, options.jobs, stop, &run)
        .into_iter()
        .flatten()
    {
        all[i].outcomes.push(outcome);
    }
    all
}

fn outcome(case: &Case, run: &Run, options: &Options, stop: &(dyn Fn() -> bool + Sync)) -> Outcome {
    let mut outcome = Outcome {
        name: run.name.clone(),
        verdict: Verdict::Broken(String::new()),
        measured: Vec::new(),
        cost: Cost::default(),
        energy: 0.0,
        history: History::default(),
        deck: None,
        scene: None,
        cracks: None,
    };
    if let Some(test) = &run.point {
        match on_one_thread(|| point(run, test, options.short)) {
            Err(why) => outcome.verdict = Verdict::Broken(why),
            Ok((history, deck, verdict, measured)) => {
                outcome.cost.increments = history.rows(None).len();
                (outcome.history, outcome.deck) = (history, Some(deck));
                (outcome.verdict, outcome.measured) = (verdict, measured);
            }
        }
        return outcome;
    }
    let folder = options.folder.join(case.folder_name()).join(&run.name);
    match on_one_thread(|| solved(run, options, &folder, stop)) {
        Err(why) => outcome.verdict = Verdict::Broken(why),
        Ok(solved) => {
            let Solved {
                ended,
                cost,
                deck,
                scene,
            } = solved;
            (outcome.verdict, outcome.measured) = judge(run.terms(), options.short, &ended);
            outcome.cost = cost;
            outcome.energy = ended.energy;
            outcome.history = History::new(&ended.rows, &ended.probes);
            outcome.deck = Some(deck);
            outcome.scene = scene;
        }
    }
    if let (Some(frame), false) = (run.cracks, matches!(outcome.verdict, Verdict::Broken(_))) {
        match cracks(&folder, frame) {
            Ok(svg) => outcome.cracks = Some(svg),
            Err(why) => outcome.verdict = Verdict::Broken(why),
        }
    }
    outcome
}

/// History, deck, verdict and measured values of a single point.
type OfPoint = (History, String, Verdict, Vec<Measured>);

fn point(run: &Run, test: &PointTest, short: bool) -> Result<OfPoint, String> {
    let overrides = run.overrides(short).unwrap_or_default();
    let deck = Deck::load(&run.deck, &overrides).map_err(|e| e.to_string())?;
    let (history, why) = test.run(&deck)?;
    let mut wrong: Vec<String> = why.into_iter().collect();
    let (error, measured) = compare(&run.expect, short, &history, &mut wrong);
    let verdict = if wrong.is_empty() {
        Verdict::Completed(error)
    } else {
        Verdict::Wrong(wrong)
    };
    let deck = deck.to_toml().map_err(|e| e.to_string())?;
    Ok((history, deck, verdict, measured))
}

/// A finished run, whatever its status.
struct Solved {
    ended: Ended,
    cost: Cost,
    deck: String,
    scene: Option<String>,
}

fn solved(
    of: &Run,
    options: &Options,
    folder: &Path,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Solved, String> {
    let overrides = of.overrides(options.short).unwrap_or_default();
    let deck = Deck::load(&of.deck, &overrides).map_err(|e| e.to_string())?;
    let (mut model, _) = Model::from_deck(&deck).map_err(|e| e.to_string())?;
    // The message file is many times larger than the other files, and a study does not replay it.
    model.output.mcap = false;
    let directory = RunDirectory::create(folder, &model).map_err(|e| e.to_string())?;
    let watch = Watch {
        limit: options.limit,
        stop,
    };
    let ran = run::run(&model, directory, watch)?;
    ran.recorder
        .finish(&model, &ran.summary, &[])
        .map_err(|e| e.to_string())?;
    Ok(Solved {
        ended: ran.ended,
        cost: ran.cost,
        deck: deck.to_toml().map_err(|e| e.to_string())?,
        scene: of.drawing.then(|| scene(&model)),
    })
}

fn cracks(folder: &Path, frame: FrameChoice) -> Result<String, String> {
    let folder = RunFolder::open(folder).map_err(|e| e.to_string())?;
    let snapshots = Snapshots::open(&folder).map_err(|e| e.to_string())?;
    let snapshot = snapshots.at(frame).map_err(|e| e.to_string())?;
    Ok(crack_pattern_of(&snapshot, folder.model().as_ref()))
}

impl Outcome {
    /// Whether the run ended as required and every expectation holds.
    pub fn holds(&self) -> bool {
        matches!(self.verdict, Verdict::Completed(_))
    }
}
