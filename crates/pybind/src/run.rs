//! Runs on a separate thread. Meanwhile the calling thread watches for Ctrl-C and serves callbacks.
//!
//! ```text
//! calling thread (Python)                    solving thread and its pool (no Python)
//!   every 50 ms: signals? ──────stop──────▶  take(row): write, send, continue?
//!   callback(row) ◀────────────rows────────
//!                 ─────────────answers────▶
//! ```

use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use pyo3::types::PyDict;
use wythe_core::deck::Strategy;
use wythe_core::model::Model;
use wythe_core::model::scene::Fidelity;
use wythe_core::results::estimate::{self, Prepared};
use wythe_core::results::{ResumeError, Resumed, RunDirectory, StoppedRun, SummaryFile};
use wythe_core::solve::Recorder;
use wythe_core::solve::{self, Checkpoint, RunError};
use wythe_core::state::{Frame, HistoryRow, Status, Summary};

use crate::errors::{self, from_json};
use crate::laws::{Failure, Laws};
use crate::model::Deck;

/// Longest time until Ctrl-C is noticed.
const PATIENCE: Duration = Duration::from_millis(50);

/// Event of a run.
enum Event {
    /// An increment, which waits for an answer.
    Row(Box<HistoryRow>),
    /// A change of procedure.
    Note(String),
}

/// Recorder that writes the folder, sends events, and asks whether to continue.
struct Told<'a> {
    directory: RunDirectory,
    events: Sender<Event>,
    /// Answers to rows; `None` without a callback.
    answers: Option<Receiver<bool>>,
    stop: &'a AtomicBool,
}

impl Recorder for Told<'_> {
    fn take(
        &mut self,
        model: &Model,
        row: &HistoryRow,
        frame: Option<&Frame>,
    ) -> std::io::Result<bool> {
        let go_on = self.directory.take(model, row, frame)?;
        let mut wanted = true;
        if let Some(answers) = &self.answers {
            // The receiver is closed only if the calling thread has ended; the run stops then.
            let sent = self.events.send(Event::Row(Box::new(row.clone())));
            wanted = sent.is_ok() && answers.recv().unwrap_or(false);
        }
        Ok(go_on && wanted && !self.stop.load(Ordering::SeqCst))
    }

    fn wants_fields(&self) -> bool {
        self.directory.wants_fields()
    }

    fn keep(&mut self, model: &Model, fields: Frame) {
        self.directory.keep(model, fields);
    }

    fn checkpoint(&mut self, last: bool, make: &dyn Fn() -> Checkpoint) -> std::io::Result<()> {
        self.directory.checkpoint(last, make)
    }

    fn note(&mut self, text: &str) {
        self.directory.note(text);
        // The same holds here; nothing is left to report to.
        let _ = self.events.send(Event::Note(text.to_owned()));
    }

    fn progress(&mut self, step: usize, time: f64, iterations: usize) {
        self.directory.progress(step, time, iterations);
    }
}

/// Python callbacks of a run: `on_row(json)` returns whether to continue, `on_note(text)`.
struct Listener<'py> {
    /// Number of threads of the solver; none: all processors.
    threads: Option<NonZeroUsize>,
    on_row: Option<Bound<'py, PyAny>>,
    on_note: Option<Bound<'py, PyAny>>,
}

/// Runs the deck into the folder `out`. Ctrl-C and errors of callbacks are raised after the folder is complete.
#[pyfunction]
#[pyo3(signature = (deck, out, threads, on_row, on_note, laws=None))]
#[expect(clippy::too_many_arguments, reason = "its keywords in Python")]
pub fn run<'py>(
    py: Python<'py>,
    deck: &Deck,
    out: PathBuf,
    threads: Option<NonZeroUsize>,
    on_row: Option<Bound<'py, PyAny>>,
    on_note: Option<Bound<'py, PyAny>>,
    laws: Option<Laws>,
) -> PyResult<()> {
    if deck.deck().strategy == Strategy::Limit {
        return Err(errors::of_strategy(py));
    }
    let built = deck.sound(py)?;
    let Ok((model, warnings)) = &*built else {
        return Err(errors::bug("a sound model is not"));
    };
    let mut warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    let failure = Failure::default();
    let changed = match laws {
        None => None,
        Some(laws) => {
            laws.require_no_scatter(deck.deck())?;
            let mut model = model.clone();
            warnings.extend(laws.put_into(py, &mut model, &failure)?);
            Some(model)
        }
    };
    let model = changed.as_ref().unwrap_or(model);
    let created = py.detach(|| RunDirectory::of_deck(&out, model, deck.deck()));
    let directory = created.map_err(|error| errors::of_output(py, &error))?;
    let listener = Listener {
        threads,
        on_row,
        on_note,
    };
    let output = Output {
        directory,
        warnings: warnings.clone(),
    };
    let ended = record(py, model, output, &listener, |recorder| {
        solve::run(model, recorder)
    });
    // The failure of a law is the cause of how the run ended.
    failure.raised(py)?;
    let lost_symmetry = ended?.lost_symmetry;
    if !lost_symmetry || deck.deck().fidelity != Fidelity::Auto {
        return Ok(());
    }
    let (mut whole, mut deck) = (model.clone(), deck.deck().clone());
    (whole.fidelity, deck.fidelity) = (Fidelity::Full, Fidelity::Full);
    let created = py.detach(|| RunDirectory::of_deck(&out, &whole, &deck));
    let output = Output {
        directory: created.map_err(|error| errors::of_output(py, &error))?,
        warnings,
    };
    let ended = record(py, &whole, output, &listener, |recorder| {
        solve::run_whole(&whole, recorder)
    });
    failure.raised(py)?;
    ended.map(|_| ())
}

/// Resumes the run in `folder`, with the laws of Python that it began with. Returns false if it is complete.
#[pyfunction]
#[pyo3(signature = (folder, overrides, threads, on_row, on_note, laws=None))]
#[expect(clippy::too_many_arguments, reason = "its keywords in Python")]
pub fn resume<'py>(
    py: Python<'py>,
    folder: PathBuf,
    overrides: Vec<(String, String)>,
    threads: Option<NonZeroUsize>,
    on_row: Option<Bound<'py, PyAny>>,
    on_note: Option<Bound<'py, PyAny>>,
    laws: Option<Laws>,
) -> PyResult<bool> {
    let refused = |error: ResumeError| errors::of_resuming(py, &error, laws.is_some());
    let read = py.detach(|| {
        let mut stopped = StoppedRun::open(&folder)?;
        let deck = stopped.deck(&overrides)?;
        let (model, warnings) = Model::from_deck(&deck)?;
        Ok((stopped, deck, model, warnings))
    });
    let (stopped, deck, mut model, warnings) = read.map_err(refused)?;
    let mut warnings: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    let failure = Failure::default();
    if let Some(laws) = &laws {
        laws.require_no_scatter(&deck)?;
        warnings.extend(laws.put_into(py, &mut model, &failure)?);
    }
    let begun = py.detach(|| {
        if stopped.is_complete(&model)? {
            return Ok(None);
        }
        let mut resumed = stopped.resume(&model)?;
        // Stores the deck that is valid from here on.
        resumed.directory.keep_deck(&deck)?;
        Ok(Some(resumed))
    });
    let Some(resumed) = begun.map_err(refused)? else {
        return Ok(false);
    };
    let Resumed {
        directory,
        checkpoint,
        warnings: of_files,
    } = resumed;
    warnings.extend(of_files);
    let output = Output {
        directory,
        warnings,
    };
    let listener = Listener {
        threads,
        on_row,
        on_note,
    };
    let ended = record(py, &model, output, &listener, |recorder| match checkpoint {
        Some(checkpoint) => solve::resume(&model, checkpoint, recorder),
        None => solve::run(&model, recorder),
    });
    // The failure of a law is the cause of how the run ended.
    failure.raised(py)?;
    ended.map(|_| true)
}

/// Folder of a run, and warnings for its summary.
struct Output {
    directory: RunDirectory,
    warnings: Vec<String>,
}

/// Solves on another thread while the calling thread listens.
fn record<'py>(
    py: Python<'py>,
    model: &Model,
    output: Output,
    listener: &Listener<'py>,
    solve: impl FnOnce(&mut dyn Recorder) -> Result<Summary, RunError> + Send,
) -> PyResult<Summary> {
    let pool = pool(listener.threads)?;
    let columns = model.columns();
    let stop = AtomicBool::new(false);
    let (events, told) = channel();
    let (answer, answers) = channel();
    let mut sink = Told {
        directory: output.directory,
        events,
        answers: listener.on_row.is_some().then_some(answers),
        stop: &stop,
    };
    let (ended, directory, raised) = std::thread::scope(|scope| {
        let solving = scope.spawn(|| {
            let ended = pool.install(|| solve(&mut sink));
            // The sink is dropped here, which ends the listener.
            (ended, sink.directory)
        });
        let raised = listen(py, (listener, &columns), told, &answer, &stop);
        let joined = py.detach(|| solving.join());
        joined
            .map(|(ended, directory)| (ended, directory, raised))
            .map_err(|_| errors::bug("the solver panicked"))
    })?;
    let mut summary = ended.map_err(|error| errors::of_run(py, error))?;
    // Without a signal or an exception, only the answer of the callback ends a run early.
    if summary.status == Status::Interrupted && !stop.load(Ordering::SeqCst) {
        summary.status = Status::Stopped;
        "stopped by the callback".clone_into(&mut summary.message);
    }
    py.detach(|| directory.finish(model, &summary, &output.warnings))
        .map_err(|error| errors::of_output(py, &error))?;
    raised.map_or(Ok(summary), Err)
}

/// A pool per run: the global pool would not survive a fork and has a fixed number of threads.
fn pool(threads: Option<NonZeroUsize>) -> PyResult<rayon::ThreadPool> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.map_or(0, NonZeroUsize::get))
        .thread_name(|i| format!("wythe-{i}"))
        .build()
        .map_err(|error| errors::bug(&format!("no threads: {error}")))
}

/// Runs the companions of the run of this deck in `folder` and adds the estimate of its error to the summary. Ctrl-C
/// is raised after the summary is written.
#[pyfunction]
#[pyo3(signature = (deck, folder, threads, on_note))]
pub fn estimate_error<'py>(
    py: Python<'py>,
    deck: &Deck,
    folder: PathBuf,
    threads: Option<NonZeroUsize>,
    on_note: Option<Bound<'py, PyAny>>,
) -> PyResult<()> {
    let built = deck.sound(py)?;
    let Ok((model, _)) = &*built else {
        return Err(errors::bug("a sound model is not"));
    };
    let of_run = (deck.deck(), model);
    let listener = Listener {
        threads,
        on_row: None,
        on_note,
    };
    let pool = pool(threads)?;
    let stop = AtomicBool::new(false);
    let (events, told) = channel();
    let (answer, _) = channel();
    let (ended, raised) = std::thread::scope(|scope| {
        let (stop, folder) = (&stop, &folder);
        let solving = scope.spawn(move || {
            let mut solve = |companion| companion_solved(companion, &events, stop);
            pool.install(|| estimate::estimate_error(folder, of_run, &mut solve))
        });
        let raised = listen(py, (&listener, &[]), told, &answer, stop);
        let joined = py.detach(|| solving.join());
        joined
            .map(|ended| (ended, raised))
            .map_err(|_| errors::bug("the solver panicked"))
    })?;
    ended.map_err(|error| errors::of_run(py, error))?;
    raised.map_or(Ok(()), Err)
}

/// Runs a companion and writes its folder.
fn companion_solved(
    companion: Prepared,
    events: &Sender<Event>,
    stop: &AtomicBool,
) -> Result<SummaryFile, RunError> {
    let Prepared {
        part,
        model,
        warnings,
        directory,
    } = companion;
    // A closed receiver has no more use for it.
    let _ = events.send(Event::Note(format!("error by {}", part.name())));
    let mut sink = Told {
        directory,
        events: events.clone(),
        answers: None,
        stop,
    };
    let ended = solve::run(&model, &mut sink)?;
    let finished = sink.directory.finish(&model, &ended, &warnings);
    finished.map_err(|error| RunError::Output(error.into()))
}

/// Serves callbacks and checks signals until the solver closes the channel; returns the first exception.
fn listen(
    py: Python<'_>,
    (listener, columns): (&Listener<'_>, &[String]),
    mut told: Receiver<Event>,
    answer: &Sender<bool>,
    stop: &AtomicBool,
) -> Option<PyErr> {
    let mut raised: Option<PyErr> = None;
    let mut looked = Instant::now();
    loop {
        // Exclusive access, because a receiver belongs to one thread.
        let told = &mut told;
        let event = py.detach(move || told.recv_timeout(PATIENCE));
        let mut outcome = Ok(true);
        match event {
            Ok(Event::Row(row)) => {
                outcome = match &listener.on_row {
                    Some(on_row) if raised.is_none() => show(py, on_row, &row, columns),
                    _ => Ok(raised.is_none()),
                };
                // The solver waits for the answer or has ended.
                let _ = answer.send(*outcome.as_ref().unwrap_or(&false));
            }
            Ok(Event::Note(text)) => {
                if let (Some(on_note), None) = (&listener.on_note, &raised) {
                    outcome = on_note.call1((text,)).map(|_| true);
                }
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => return raised,
        }
        if outcome.is_ok() && looked.elapsed() >= PATIENCE {
            outcome = py.check_signals().map(|()| true);
            looked = Instant::now();
        }
        if let Err(error) = outcome {
            stop.store(true, Ordering::SeqCst);
            // The first error is the cause of the others.
            raised.get_or_insert(error);
        }
    }
}

/// Calls the callback with an increment and the values of its further columns by name; returns whether to continue.
fn show(
    py: Python<'_>,
    on_row: &Bound<'_, PyAny>,
    row: &HistoryRow,
    columns: &[String],
) -> PyResult<bool> {
    let text = serde_json::to_string(row)
        .map_err(|error| errors::bug(&format!("an increment as JSON: {error}")))?;
    let values = PyDict::new(py);
    for (name, value) in columns.iter().zip(&row.probes) {
        values.set_item(name, value)?;
    }
    on_row.call1((from_json(py, &text)?, values))?.extract()
}
