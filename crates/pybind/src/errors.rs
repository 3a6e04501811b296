//! Converts errors of the core to Python exceptions: `WytheError > ModelError, ConvergenceError, OutputError`.

use std::io;
use std::path::Path;

use miette::Diagnostic;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use wythe_core::error::{DeckError, ErrorKind, IoError, ModelError};
use wythe_core::limit::LimitError;
use wythe_core::results::mcap::salvage::SalvageError;
use wythe_core::results::{ExperimentError, ModesError, OutputError, ReadError, ResumeError};
use wythe_core::solve::RunError;

/// Creates an exception of `wythe._errors`.
fn raise<'py, A>(py: Python<'py>, name: &str, arguments: A) -> PyErr
where
    A: pyo3::call::PyCallArgs<'py>,
{
    let made = py
        .import("wythe._errors")
        .and_then(|module| module.getattr(name))
        .and_then(|class| class.call1(arguments));
    made.map_or_else(|error| error, PyErr::from_value)
}

/// One error of a model as arguments of `ModelError`: kind, file, line, column, key, message, fix.
type Told = (
    &'static str,
    Option<String>,
    Option<usize>,
    Option<usize>,
    String,
    String,
    String,
);

fn told(error: &ModelError, text: Text) -> Told {
    let (line, column) = place(error, text);
    // An error in an override is located by its key alone.
    let file = (text == Text::File && !is_override(error)).then(|| error.file().to_owned());
    (
        error.kind().name(),
        file,
        line,
        column,
        error.key().to_owned(),
        error.message().to_owned(),
        in_python(error.advice()),
    )
}

/// A failed law of Python.
pub fn of_law(py: Python<'_>, message: &str) -> PyErr {
    raise(py, "LawError", (message,))
}

/// A limit analysis without a factor.
pub fn of_limit(py: Python<'_>, why: &LimitError) -> PyErr {
    raise(py, "LimitError", (why.to_string(), in_python(why.advice())))
}

/// A run with `strategy = "limit"`, which has no steps.
pub fn of_strategy(py: Python<'_>) -> PyErr {
    let message = "strategy = \"limit\" has a factor and no run";
    raise(py, "LimitError", (message, "call Model.limit()"))
}

/// Line and column of the error, if the text was written by the user.
pub fn place(error: &ModelError, text: Text) -> (Option<usize>, Option<usize>) {
    if text == Text::Made || is_override(error) {
        (None, None)
    } else {
        (error.line(), error.column())
    }
}

/// Whether the error is in the value of an override, which has no line in the deck.
fn is_override(error: &ModelError) -> bool {
    error.file().starts_with("--set ")
}

/// Rewrites advice for the command line as advice for Python.
pub fn in_python(advice: &str) -> String {
    advice
        .replace("--set ", "")
        .replace("with --out", "by out")
        .replace("--out", "out")
        .replace("`wythe run`", "Model.run")
}

/// Origin of a deck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Text {
    /// A file.
    File,
    /// A text written by the user, with meaningful lines.
    Written,
    /// A generated text, whose lines mean nothing to the user.
    Made,
}

/// `ModelError` with all errors of the deck.
pub fn of_model(py: Python<'_>, error: &ModelError, text: Text) -> PyErr {
    let all: Vec<Told> = error.all().map(|error| told(error, text)).collect();
    raise(py, "_model_error", (all,))
}

/// `ModelError` without a position in a deck.
fn nowhere(py: Python<'_>, message: String, fix: String) -> PyErr {
    let kind = ErrorKind::default().name();
    let told: Told = (kind, None, None, None, String::new(), message, fix);
    raise(py, "_model_error", (vec![told],))
}

/// Advice of a diagnostic, or an empty text.
fn advice(error: &dyn Diagnostic) -> String {
    error
        .help()
        .map_or_else(String::new, |help| in_python(&help.to_string()))
}

/// `ModelError` from a diagnostic without a position.
fn wrong(py: Python<'_>, error: &dyn Diagnostic) -> PyErr {
    nowhere(py, error.to_string(), advice(error))
}

/// `OutputError`.
fn output(py: Python<'_>, error: &dyn Diagnostic, why: Option<&io::Error>) -> PyErr {
    let number = why.and_then(io::Error::raw_os_error);
    raise(
        py,
        "_output_error",
        (error.to_string(), advice(error), number),
    )
}

/// Exception for an error of reading a deck from disk.
pub fn of_deck(py: Python<'_>, error: &DeckError) -> PyErr {
    match error {
        DeckError::Io(error) => of_io(py, error),
        DeckError::Model(error) => of_model(py, error, Text::File),
    }
}

/// Exception for an error of a file.
pub fn of_io(py: Python<'_>, error: &IoError) -> PyErr {
    output(py, error, Some(&error.why))
}

/// Exception for a file that cannot be written or read.
pub fn of_path(py: Python<'_>, path: &Path, why: io::Error) -> PyErr {
    let path = path.to_owned();
    of_io(py, &IoError { path, why })
}

/// Exception for an error of reading results.
pub fn of_reading(py: Python<'_>, error: &ReadError) -> PyErr {
    match error {
        ReadError::NoFrame { .. } => raise(py, "_no_frame", (error.to_string(), advice(error))),
        ReadError::Read { why, .. } => output(py, error, Some(why)),
        ReadError::NoColumn { .. } | ReadError::NoSection { .. } | ReadError::Undrawn(_) => {
            let advice = advice(error);
            pyo3::exceptions::PyValueError::new_err(format!("{error}; {advice}"))
        }
        error => output(py, error, None),
    }
}

/// Exception for an error of reading an experiment.
pub fn of_experiment(py: Python<'_>, error: &ExperimentError) -> PyErr {
    match error {
        ExperimentError::Read { why, .. } => output(py, error, Some(why)),
        ExperimentError::Content { .. } => wrong(py, error),
    }
}

/// Exception for an error of writing results.
pub fn of_output(py: Python<'_>, error: &OutputError) -> PyErr {
    match error {
        OutputError::Create { why, .. } | OutputError::Write { why, .. } => {
            output(py, error, Some(why))
        }
        error => output(py, error, None),
    }
}

/// Exception for an error of repairing a message file.
pub fn of_salvage(py: Python<'_>, error: &SalvageError) -> PyErr {
    match error {
        SalvageError::Io(error) => of_io(py, error),
        SalvageError::Locked(error) => of_output(py, error),
        error @ SalvageError::NotMcap(_) => output(py, error, None),
    }
}

/// Exception for an error of a run.
pub fn of_run(py: Python<'_>, error: RunError) -> PyErr {
    let fix = match &error {
        RunError::Bulk(_) => "see the sizes in wall, its mesh, and the tables of the material",
        RunError::Checkpoint(_) => "begin anew with Model.run",
        RunError::LimitOnly => "call Model.limit()",
        RunError::JointLaw { .. } => {
            "check the law alone, with the openings and slips of the message"
        }
        _ => "give every material a density, e.g. \"1900 kg/m^3\"",
    };
    match error {
        // An error of the recorder is wrapped; the inner one names the file.
        RunError::Output(error) => match error.downcast::<OutputError>() {
            Ok(error) => of_output(py, &error),
            Err(error) => {
                let message = format!("results could not be written: {error}");
                raise(py, "_output_error", (message, "", error.raw_os_error()))
            }
        },
        error => nowhere(py, error.to_string(), fix.to_owned()),
    }
}

/// Exception for an error of resuming a run, `with_laws` of Python or without.
pub fn of_resuming(py: Python<'_>, error: &ResumeError, with_laws: bool) -> PyErr {
    match error {
        ResumeError::OtherModel { .. } => {
            let laws = if with_laws {
                "; or it did not begin with these laws"
            } else {
                "; or the run has laws of Python, which resume(laws=...) takes again"
            };
            nowhere(py, error.to_string(), advice(error) + laws)
        }
        ResumeError::Output(error) => of_output(py, error),
        ResumeError::Deck(error) => of_deck(py, error),
        ResumeError::Read(error) => of_reading(py, error),
        ResumeError::Changed { .. } => wrong(py, error),
        error => output(py, error, None),
    }
}

/// Exception for an error of a search for modes.
pub fn of_modes(py: Python<'_>, error: &ModesError) -> PyErr {
    match error {
        ModesError::Read(error) => of_reading(py, error),
        ModesError::Deck(error) => of_deck(py, error),
        error @ ModesError::NoDeck(_) => output(py, error, None),
        error @ ModesError::Vibration(_) => wrong(py, error),
    }
}

/// Exception for an internal error.
pub fn bug(what: &str) -> PyErr {
    PyRuntimeError::new_err(format!(
        "this is a bug in wythe, not in your model; please report it with the model: {what}"
    ))
}

/// Calls `json.loads`, which is looked up only once.
pub fn from_json<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    static LOADS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let loads = LOADS.get_or_try_init(py, || -> PyResult<_> {
        Ok(py.import("json")?.getattr("loads")?.unbind())
    })?;
    loads.bind(py).call1((text,))
}
