//! The errors of the core as those of Python: `WytheError > ModelError, ConvergenceError, OutputError`.

use std::io;
use std::path::Path;

use miette::Diagnostic;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use wythe_core::error::{DeckError, IoError, ModelError};
use wythe_core::results::mcap::salvage::SalvageError;
use wythe_core::results::{ExperimentError, OutputError, ReadError, ResumeError};
use wythe_core::solve::RunError;

/// An exception of `wythe._errors`.
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

/// One error of a model for the constructor of `ModelError`: file, line, column, key, message, fix.
type Told = (
    Option<String>,
    Option<usize>,
    Option<usize>,
    String,
    String,
    String,
);

fn told(error: &ModelError, text: Text) -> Told {
    let (line, column) = place(error, text);
    // Of an override the key says all.
    let file = (text == Text::File && !is_override(error)).then(|| error.file().to_owned());
    (
        file,
        line,
        column,
        error.key().to_owned(),
        error.message().to_owned(),
        in_python(error.advice()),
    )
}

/// Line and column in the text, where someone has written one.
pub fn place(error: &ModelError, text: Text) -> (Option<usize>, Option<usize>) {
    if text == Text::Made || is_override(error) {
        (None, None)
    } else {
        (error.line(), error.column())
    }
}

/// Whether the error lies in a value of an override, whose lines are not those of the deck.
fn is_override(error: &ModelError) -> bool {
    error.file().starts_with("--set ")
}

/// Advice for the command in the words of Python.
pub fn in_python(advice: &str) -> String {
    advice
        .replace("--set ", "")
        .replace("with --out", "by out")
        .replace("--out", "out")
        .replace("`wythe run`", "Model.run")
}

/// Where a deck comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Text {
    /// A file.
    File,
    /// A text with lines that someone has written.
    Written,
    /// A text that was made of something else: its lines say nothing.
    Made,
}

/// `ModelError` with all errors of the deck.
pub fn of_model(py: Python<'_>, error: &ModelError, text: Text) -> PyErr {
    let all: Vec<Told> = error.all().map(|error| told(error, text)).collect();
    raise(py, "_model_error", (all,))
}

/// `ModelError` without a place in a deck.
fn nowhere(py: Python<'_>, message: String, fix: String) -> PyErr {
    let told: Told = (None, None, None, String::new(), message, fix);
    raise(py, "_model_error", (vec![told],))
}

/// Advice of a diagnostic, or nothing.
fn advice(error: &dyn Diagnostic) -> String {
    error
        .help()
        .map_or_else(String::new, |help| in_python(&help.to_string()))
}

/// The same of a diagnostic.
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

/// Of reading a deck from disk.
pub fn of_deck(py: Python<'_>, error: &DeckError) -> PyErr {
    match error {
        DeckError::Io(error) => of_io(py, error),
        DeckError::Model(error) => of_model(py, error, Text::File),
    }
}

/// Of a file.
pub fn of_io(py: Python<'_>, error: &IoError) -> PyErr {
    output(py, error, Some(&error.why))
}

/// Of a file that could not be written or read.
pub fn of_path(py: Python<'_>, path: &Path, why: io::Error) -> PyErr {
    let path = path.to_owned();
    of_io(py, &IoError { path, why })
}

/// Of results.
pub fn of_reading(py: Python<'_>, error: &ReadError) -> PyErr {
    match error {
        ReadError::NoFrame { .. } => raise(py, "_no_frame", (error.to_string(), advice(error))),
        ReadError::Read { why, .. } => output(py, error, Some(why)),
        error => output(py, error, None),
    }
}

/// Of a measured curve.
pub fn of_experiment(py: Python<'_>, error: &ExperimentError) -> PyErr {
    match error {
        ExperimentError::Read { why, .. } => output(py, error, Some(why)),
        ExperimentError::Content { .. } => wrong(py, error),
    }
}

/// Of writing results.
pub fn of_output(py: Python<'_>, error: &OutputError) -> PyErr {
    match error {
        OutputError::Create { why, .. } | OutputError::Write { why, .. } => {
            output(py, error, Some(why))
        }
        error => output(py, error, None),
    }
}

/// Of messages that cannot be rescued.
pub fn of_salvage(py: Python<'_>, error: &SalvageError) -> PyErr {
    match error {
        SalvageError::Io(error) => of_io(py, error),
        SalvageError::Locked(error) => of_output(py, error),
        error @ SalvageError::NotMcap(_) => output(py, error, None),
    }
}

/// Of a run.
pub fn of_run(py: Python<'_>, error: RunError) -> PyErr {
    let fix = match &error {
        RunError::Bulk(_) => "see the sizes in wall, its mesh, and the tables of the material",
        RunError::Checkpoint(_) => "begin anew with Model.run",
        RunError::JointLaw { .. } => {
            "check the law alone, with the openings and slips of the message"
        }
        _ => "give every material a density, e.g. \"1900 kg/m^3\"",
    };
    match error {
        // The recorder's own error comes back wrapped: it names the file.
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

/// Of going on with a run.
pub fn of_resuming(py: Python<'_>, error: &ResumeError) -> PyErr {
    match error {
        ResumeError::Output(error) => of_output(py, error),
        ResumeError::Deck(error) => of_deck(py, error),
        ResumeError::Read(error) => of_reading(py, error),
        ResumeError::Changed { .. } | ResumeError::OtherModel { .. } => wrong(py, error),
        error => output(py, error, None),
    }
}

/// Ours, not the user's.
pub fn bug(what: &str) -> PyErr {
    PyRuntimeError::new_err(format!(
        "this is a bug in wythe, not in your model; please report it with the model: {what}"
    ))
}

/// `json.loads`, looked up once.
pub fn from_json<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    static LOADS: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let loads = LOADS.get_or_try_init(py, || -> PyResult<_> {
        Ok(py.import("json")?.getattr("loads")?.unbind())
    })?;
    loads.bind(py).call1((text,))
}
