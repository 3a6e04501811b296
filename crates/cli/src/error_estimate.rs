//! `wythe run --error`: the companions of a run, and the error of its figures.

use std::path::Path;

use wythe_core::deck::Deck;
use wythe_core::model::Model;
use wythe_core::results::SummaryFile;
use wythe_core::results::estimate::{ErrorEstimate, Part, Prepared, estimate_error};
use wythe_core::solve::{self, Recorder};

use crate::arguments::{Progress, Run};
use crate::failure::Failure;
use crate::interrupt::Interrupt;
use crate::run::recorded;
use crate::terminal::Terminal;
use crate::unicode;

/// Runs the companions of the run in the folder `out` and adds the estimate to its summary.
pub fn add(
    arguments: &Run,
    of_run: (&Deck, &Model),
    out: &Path,
    (terminal, interrupt): (&Terminal, &Interrupt),
) -> Result<SummaryFile, Failure> {
    // Increments of a companion are no events of the run.
    let quiet = arguments.quiet || arguments.progress == Progress::Json;
    let mut solve = |companion: Prepared| {
        let Prepared {
            part,
            model,
            warnings,
            directory,
        } = companion;
        terminal.note(&format!(
            "error by {}: {}",
            part.name(),
            purpose(part, &model)
        ));
        let own = Terminal::new(&model, arguments.progress, quiet);
        let sinks = (directory, own);
        let solve = |recorder: &mut dyn Recorder| solve::run(&model, recorder);
        recorded(&model, &warnings, sinks, interrupt, solve).map(|recorded| recorded.summary)
    };
    Ok(estimate_error(out, of_run, &mut solve)?)
}

/// The companion of a part, in words.
fn purpose(part: Part, model: &Model) -> String {
    match part {
        Part::Mesh => format!("the same with {} elements", model.mesh.elements.len()),
        _ => "the same with half the increments and half the tolerance".to_owned(),
    }
}

/// Lines of an estimate, with the characters of the terminal.
pub fn lines(estimate: &ErrorEstimate) -> Vec<String> {
    let lines = estimate.lines().into_iter();
    if unicode::is_on() {
        lines.collect()
    } else {
        lines.map(|line| line.replace('±', "+-")).collect()
    }
}
