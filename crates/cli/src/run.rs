//! `wythe run`: runs a TOML file and writes its folder of results.

use std::io;
use std::num::NonZeroUsize;
use std::path::Path;

use serde_json::{Value, json};
use wythe_core::command::argument;
use wythe_core::deck::Strategy;
use wythe_core::model::Model;
use wythe_core::model::scene::Fidelity;
use wythe_core::results::{RunDirectory, SummaryFile};
use wythe_core::solve::Recorder;
use wythe_core::solve::{self, Checkpoint, RunError};
use wythe_core::state::{Frame, HistoryRow, Status, Summary};

use crate::arguments::Run;
use crate::error_estimate;
use crate::failure::Failure;
use crate::findings::{self, Sound};
use crate::interrupt::Interrupt;
use crate::limit;
use crate::say::print;
use crate::terminal::{Terminal, count};

/// Runs the model and writes its folder.
pub fn run(arguments: &Run) -> Result<(), Failure> {
    let read = findings::read(&arguments.model, &arguments.with);
    let Sound {
        mut deck,
        mut model,
        warnings,
    } = read.map_err(|unsound| unsound.tell(&arguments.model))?;
    take_threads(arguments.threads)?;
    let out = arguments
        .out
        .clone()
        .unwrap_or_else(|| arguments.model.with_extension("out"));
    if deck.strategy == Strategy::Limit {
        if arguments.error {
            return Err(Failure::Model(miette::miette!(
                help = "leave out --error; limit.json states the duality gap of the factor",
                "--error needs increments and a mesh, and limit analysis has none"
            )));
        }
        let sound = Sound {
            deck,
            model,
            warnings,
        };
        return limit::in_folder(sound, &out, arguments.quiet);
    }
    let warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    let terminal = Terminal::new(&model, arguments.progress, arguments.quiet);
    terminal.begin(&model, &warnings, &out);
    let interrupt = Interrupt::listen();
    let directory = RunDirectory::of_deck(&out, &model, &deck)?;
    let sinks = (directory, terminal);
    let solve = |recorder: &mut dyn Recorder| solve::run(&model, recorder);
    let mut ended = recorded(&model, &warnings, sinks, &interrupt, solve)?;
    if ended.lost_symmetry && deck.fidelity == Fidelity::Auto {
        (deck.fidelity, model.fidelity) = (Fidelity::Full, Fidelity::Full);
        let directory = RunDirectory::of_deck(&out, &model, &deck)?;
        let sinks = (directory, ended.terminal);
        let solve = |recorder: &mut dyn Recorder| solve::run_whole(&model, recorder);
        ended = recorded(&model, &warnings, sinks, &interrupt, solve)?;
    }
    let Recorded {
        summary, terminal, ..
    } = ended;
    if !arguments.error {
        return conclude(&summary, warnings.len(), &terminal, &out);
    }
    match error_estimate::add(arguments, (&deck, &model), &out, (&terminal, &interrupt)) {
        Ok(estimated) => {
            conclude(&estimated, warnings.len(), &terminal, &out)?;
            if interrupt.requested() {
                return Err(Failure::Interrupted);
            }
            Ok(())
        }
        // The run itself has its results.
        Err(failure) => conclude(&summary, warnings.len(), &terminal, &out).and(Err(failure)),
    }
}

/// Sets the number of threads; all cores if none is given.
pub fn take_threads(threads: Option<NonZeroUsize>) -> Result<(), Failure> {
    let Some(threads) = threads else {
        return Ok(());
    };
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let (taken, warning) = few_threads(threads.get(), cores);
    if let Some(warning) = warning {
        crate::say::tell!("warning: {warning}");
    }
    // Only a second call can fail, and there is only one.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(taken);
    pool.build_global()
        .map_err(|error| Failure::Model(miette::Report::msg(error)))
}

/// Largest number of threads per core; more only wait for each other.
const MOST_OF_A_CORE: usize = 4;

/// Number of threads to use on a machine with `cores` cores, and a warning if there are too many.
fn few_threads(threads: usize, cores: usize) -> (usize, Option<String>) {
    let taken = threads.min(MOST_OF_A_CORE * cores);
    let warning = (threads > cores).then(|| {
        format!(
            "--threads {threads}: there are {cores} cores for this process, and more threads than cores only slow it \
             down; {taken} are taken"
        )
    });
    (taken, warning)
}

/// Runs `solve`, writes the folder of the run, and prints how it ended.
pub fn record(
    model: &Model,
    warnings: &[String],
    (directory, terminal): (RunDirectory, Terminal),
    interrupt: &Interrupt,
    solve: impl FnOnce(&mut dyn Recorder) -> Result<Summary, RunError>,
) -> Result<(), Failure> {
    let out = directory.path().to_owned();
    let sinks = (directory, terminal);
    let Recorded {
        summary, terminal, ..
    } = recorded(model, warnings, sinks, interrupt, solve)?;
    conclude(&summary, warnings.len(), &terminal, &out)
}

/// A run that has ended and its folder is written.
pub struct Recorded {
    /// Its summary.
    pub summary: SummaryFile,
    /// The terminal, whose bar is cleared.
    terminal: Terminal,
    /// Whether a part was solved and lost the symmetry of the whole.
    lost_symmetry: bool,
}

/// Runs `solve` and writes the folder of the run.
pub fn recorded(
    model: &Model,
    warnings: &[String],
    (directory, terminal): (RunDirectory, Terminal),
    interrupt: &Interrupt,
    solve: impl FnOnce(&mut dyn Recorder) -> Result<Summary, RunError>,
) -> Result<Recorded, RunError> {
    let mut watched = Watched {
        directory,
        terminal,
        interrupt,
    };
    let ended = solve(&mut watched);
    watched.terminal.finish();
    let ended = ended?;
    let summary = watched.directory.finish(model, &ended, warnings);
    Ok(Recorded {
        summary: summary.map_err(io::Error::from)?,
        terminal: watched.terminal,
        lost_symmetry: ended.lost_symmetry,
    })
}

/// Prints how a run ended. The first `told` of its warnings were printed at the start.
fn conclude(
    summary: &SummaryFile,
    told: usize,
    terminal: &Terminal,
    out: &Path,
) -> Result<(), Failure> {
    let new_warnings = &summary.warnings[told.min(summary.warnings.len())..];
    let printed = print(&terminal.conclude(
        || conclusion(summary, new_warnings, out),
        || end(summary, new_warnings, out),
    ));
    // The end of the run matters more than a failure of standard output.
    match summary.status {
        Status::Completed | Status::Collapsed => printed,
        Status::Interrupted | Status::Stopped => Err(Failure::Interrupted),
        Status::NotConverged => Err(Failure::NotConverged(miette::miette!(
            help = "everything up to there is in the folder of results",
            "not converged: {}",
            summary.message
        ))),
    }
}

/// Recorder that writes the folder, shows progress and stops on signals.
struct Watched<'a> {
    directory: RunDirectory,
    terminal: Terminal,
    interrupt: &'a Interrupt,
}

impl Recorder for Watched<'_> {
    fn take(&mut self, model: &Model, row: &HistoryRow, frame: Option<&Frame>) -> io::Result<bool> {
        let go_on = self.directory.take(model, row, frame)?;
        self.terminal.increment(row);
        Ok(go_on && !self.interrupt.requested())
    }

    fn wants_fields(&self) -> bool {
        self.directory.wants_fields()
    }

    fn keep(&mut self, model: &Model, fields: Frame) {
        self.directory.keep(model, fields);
    }

    fn checkpoint(&mut self, last: bool, make: &dyn Fn() -> Checkpoint) -> io::Result<()> {
        self.directory.checkpoint(last, make)
    }

    fn note(&mut self, text: &str) {
        self.directory.note(text);
        self.terminal.note(text);
    }

    fn progress(&mut self, step: usize, time: f64, iterations: usize) {
        self.directory.progress(step, time, iterations);
        self.terminal.iteration(step, iterations);
    }
}

/// Last JSON object of a run.
fn end(summary: &SummaryFile, new_warnings: &[String], out: &Path) -> Value {
    let mut end = json!({
        "event": "end",
        "status": summary.status,
        "verdict": summary.verdict,
        "verdict_kind": summary.verdict_kind,
        "message": summary.message,
        "peak_force_kN": summary.peak_force_kN,
        "displacement_at_peak_mm": summary.displacement_at_peak_mm,
        "increments": summary.increments,
        "iterations": summary.iterations,
        "cutbacks": summary.cutbacks,
        "wall_s": summary.wall_s,
        "energy_balance_error": summary.energy_balance_error,
        "warnings": new_warnings,
        "out": out.display().to_string(),
    });
    if let Some(estimate) = &summary.error_estimate {
        end["error_estimate"] = json!(estimate);
    }
    end
}

/// Final text of a run, below the progress.
fn conclusion(summary: &SummaryFile, new_warnings: &[String], out: &Path) -> String {
    let mut lines: Vec<String> = new_warnings
        .iter()
        .map(|w| format!("warning: {w}"))
        .collect();
    if let Some(stiffness) = summary.initial_stiffness_kN_per_mm {
        lines.push(format!("initial stiffness {stiffness:.2} kN/mm"));
    }
    lines.push(format!(
        "{}, {}, {} in {:.1} s",
        count(summary.increments, "increment"),
        count(summary.iterations, "iteration"),
        count(summary.cutbacks, "cut-back"),
        summary.wall_s
    ));
    lines.push(format!(
        "energy balance closes to {:.1e}",
        summary.energy_balance_error
    ));
    lines.push(format!("results in {}", out.display()));
    if summary.status == Status::Interrupted {
        lines.push(format!("to go on: wythe resume {}", argument(out)));
    }
    lines.push(summary.verdict.clone());
    if let Some(estimate) = &summary.error_estimate {
        lines.extend(error_estimate::lines(estimate));
    }
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests;
