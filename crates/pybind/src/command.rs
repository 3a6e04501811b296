//! The command line program, its templates and its schema.

use std::ffi::OsString;

use pyo3::prelude::*;
use wythe_core::deck::templates::TEMPLATES;

/// Runs the command with these arguments, of which the first is the name of the program; returns its exit code.
#[pyfunction]
pub fn command(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    let interpreter = || {
        py.import("sys")?
            .getattr("executable")?
            .extract::<OsString>()
    };
    match interpreter() {
        // Studies that run decks in separate processes call the package as `python -m wythe`.
        Ok(python) if !python.is_empty() => {
            let program = [python, "-m".into(), "wythe".into()];
            py.detach(|| wythe_cli::command_of(&program, arguments))
        }
        _ => py.detach(|| wythe_cli::command(arguments)),
    }
}

/// Name, one-line description and text of every template.
#[pyfunction]
pub fn templates() -> Vec<(&'static str, &'static str, &'static str)> {
    TEMPLATES
        .iter()
        .map(|t| (t.name, t.about, t.text))
        .collect()
}

/// The JSON schema of decks.
#[pyfunction]
pub fn schema() -> String {
    wythe_core::deck::json_schema::text()
}
