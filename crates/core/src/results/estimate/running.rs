//! Runs the companions of a run that has ended, below its folder, and adds the estimate to its summary.

use std::io;
use std::path::Path;

use super::companions::{Set, Sketch, sketches};
use super::{Companion, Compared, ErrorEstimate, Figures, NotEstimated, Part};
use crate::deck::Deck;
use crate::error::Warning;
use crate::files;
use crate::model::Model;
use crate::results::lock::{lock, writing};
use crate::results::output::{DECK, HISTORY, OF_A_RUN, SUMMARY};
use crate::results::{Curve, OutputError, ReadError, RunDirectory, RunFolder, SummaryFile};
use crate::solve::RunError;
use crate::state::Status;

/// Name of the folder of the companions, in that of the run.
pub const FOLDER: &str = "error";

/// Largest number of increments between frames of a companion: it has those at the ends of steps.
const FRAMES: u32 = 1_000_000;

/// A companion that is ready to run.
#[derive(Debug)]
pub struct Prepared {
    /// Part of the error that it shows.
    pub part: Part,
    /// Its model.
    pub model: Model,
    /// Warnings of the model.
    pub warnings: Vec<String>,
    /// Folder of its results.
    pub directory: RunDirectory,
}

/// Runs the companions of a run and writes the estimate of its error into its `summary.json`. `folder` has the
/// results of the run, which has ended, of this deck and its model. `solve` runs a companion, with `solve::run`, and
/// finishes its directory.
///
/// A companion that does not end, or that has no model, leaves its part out of the estimate, which says why. After one
/// that was interrupted no other is begun.
///
/// # Errors
/// [`RunError::Output`]: results cannot be read or written. The results of the run remain as they were.
pub fn estimate_error(
    folder: &Path,
    (deck, model): (&Deck, &Model),
    solve: &mut dyn FnMut(Prepared) -> Result<SummaryFile, RunError>,
) -> Result<SummaryFile, RunError> {
    let _lock = lock(folder).map_err(io::Error::from)?;
    let (mut summary, curve) = read(folder)?;
    let mut found = Found::default();
    let end = match summary.status {
        Status::Completed | Status::Collapsed => None,
        Status::NotConverged => Some("the run itself did not converge".to_owned()),
        Status::Interrupted => Some("the run itself was interrupted".to_owned()),
        Status::Stopped => Some("the run itself was stopped by a callback".to_owned()),
    };
    let flat = || {
        curve
            .peak()
            .is_none()
            .then(|| "nothing was driven or loaded".to_owned())
    };
    let mut stopped = end.or_else(flat);
    for sketch in sketches(deck, model) {
        let part = sketch.part;
        let outcome = match &stopped {
            Some(why) => Err(why.clone()),
            None => found.run(sketch, (deck, model, folder), solve)?,
        };
        let compared = outcome.and_then(|(ended, refinement)| {
            if ended.status == Status::Interrupted {
                stopped = Some("it was not run, because the user stopped".to_owned());
            }
            found.compare((&curve, folder), part, &ended, refinement)
        });
        match compared {
            Ok(compared) => found.compared.push(compared),
            Err(why) => found.missing.push(NotEstimated { part, why }),
        }
    }
    let mut estimate = ErrorEstimate::of(&curve, &found.compared, found.companions);
    estimate.not_estimated = found.missing;
    estimate.not_estimated.push(NotEstimated {
        part: Part::Penalty,
        why: PENALTY.to_owned(),
    });
    summary.error_estimate = Some(estimate);
    writing(folder, SUMMARY, |file| summary.write(file)).map_err(io::Error::from)?;
    Ok(summary)
}

/// Why no companion has other joints.
const PENALTY: &str = "stiffnesses of joints are those of the deck in all companions";

/// Summary and curve of a run.
fn read(folder: &Path) -> Result<(SummaryFile, Curve), RunError> {
    let of_reading = |error: ReadError| RunError::Output(io::Error::other(error));
    let open = RunFolder::open(folder).map_err(of_reading)?;
    let summary = open.summary().map_err(of_reading)?;
    let none = || RunError::Output(io::Error::other(format!("there is no {SUMMARY}")));
    let curve = open.history().map_err(of_reading)?.curve();
    Ok((summary.ok_or_else(none)?, curve))
}

/// Companions so far.
#[derive(Default)]
struct Found {
    companions: Vec<Companion>,
    compared: Vec<Compared>,
    missing: Vec<NotEstimated>,
}

/// Summary of a companion and its refinement, or the reason why there is none.
type Outcome = Result<(SummaryFile, f64), String>;

impl Found {
    /// Runs a companion. Its reasons not to run are an outcome; files that cannot be written are an error.
    fn run(
        &mut self,
        sketch: Sketch,
        (deck, model, folder): (&Deck, &Model, &Path),
        solve: &mut dyn FnMut(Prepared) -> Result<SummaryFile, RunError>,
    ) -> Result<Outcome, RunError> {
        let within = format!("{FOLDER}/{}", sketch.part.name());
        let sets = match sketch.sets {
            Ok(sets) => sets,
            Err(why) => return Ok(Err(why)),
        };
        let mut why = String::new();
        for set in &sets {
            let (deck, of_companion, warnings) = match companion(deck, set) {
                Ok(made) => made,
                Err(error) => {
                    why = format!("{}: {error}", said(set).join(" "));
                    continue;
                }
            };
            let sizes = [&of_companion, model].map(|m| m.mesh.elements.len() as f64);
            let refinement = sketch
                .refinement
                .unwrap_or_else(|| (sizes[0] / sizes[1]).cbrt());
            self.companions.push(Companion {
                part: sketch.part,
                folder: within.clone(),
                set: said(set),
                refinement: Some(refinement),
                status: None,
                figures: None,
            });
            let directory = RunDirectory::of_deck(&folder.join(&within), &of_companion, &deck)
                .map_err(io::Error::from)?;
            let ended = solve(Prepared {
                part: sketch.part,
                model: of_companion,
                warnings: warnings.iter().map(ToString::to_string).collect(),
                directory,
            });
            return match ended {
                Ok(summary) => Ok(Ok((summary, refinement))),
                Err(RunError::Output(error)) => Err(RunError::Output(error)),
                Err(error) => Ok(Err(error.to_string())),
            };
        }
        Ok(Err(why))
    }

    /// Compares the last companion with the run.
    fn compare(
        &mut self,
        (curve, folder): (&Curve, &Path),
        part: Part,
        ended: &SummaryFile,
        refinement: f64,
    ) -> Result<Compared, String> {
        let Some(companion) = self.companions.last_mut() else {
            return Err("there is no companion".to_owned());
        };
        companion.status = Some(ended.status);
        match ended.status {
            Status::Completed | Status::Collapsed => {}
            Status::Interrupted | Status::Stopped => {
                return Err("its companion was interrupted".to_owned());
            }
            Status::NotConverged => return Err(format!("its companion has {}", ended.verdict)),
        }
        let of_companion = RunFolder::open(&folder.join(&companion.folder))
            .and_then(|open| open.history())
            .map_err(|error| error.to_string())?
            .curve();
        companion.figures = Figures::of(&of_companion);
        let differences = Figures::differences(curve, &of_companion)
            .ok_or_else(|| "nothing moved in its companion".to_owned())?;
        Ok(Compared {
            part,
            refinement,
            differences,
        })
    }
}

/// Deck and model of a companion.
fn companion(deck: &Deck, set: &Set) -> Result<(Deck, Model, Vec<Warning>), String> {
    let output = [
        ("output.every", FRAMES.to_string()),
        ("output.mcap", "false".to_owned()),
    ];
    let output = output.map(|(key, value)| (key.to_owned(), value));
    let set: Set = set.iter().cloned().chain(output).collect();
    let text = deck.to_toml().map_err(|error| error.to_string())?;
    let folder = deck.folder().to_owned();
    let deck = Deck::from_str_with(&text, DECK, &set).map_err(|error| error.to_string())?;
    let deck = deck.in_folder(folder);
    let (model, warnings) = Model::from_deck(&deck).map_err(|error| error.to_string())?;
    Ok((deck, model, warnings))
}

/// Changes of a deck as `--set` has them.
fn said(set: &Set) -> Vec<String> {
    set.iter()
        .map(|(key, value)| format!("{key}={value}"))
        .collect()
}

/// Removes the companions of an earlier run from its folder. Other files stay.
///
/// # Errors
/// [`OutputError::Write`].
pub fn remove_companions(folder: &Path) -> Result<(), OutputError> {
    for part in [Part::Time, Part::Mesh] {
        let path = folder.join(FOLDER).join(part.name());
        let is_own = |path: &Path| path.symlink_metadata().is_ok_and(|there| there.is_dir());
        if !is_own(&folder.join(FOLDER)) || !is_own(&path) || !path.join(HISTORY).is_file() {
            continue;
        }
        for name in OF_A_RUN {
            writing(&path, name, files::remove)?;
        }
        // A folder that has other files stays.
        let _ = std::fs::remove_dir(&path);
        let _ = std::fs::remove_dir(folder.join(FOLDER));
    }
    Ok(())
}
