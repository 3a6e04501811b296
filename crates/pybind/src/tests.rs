//! Standard tests: their decks, and the evaluation of their runs.

use std::path::PathBuf;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use wythe_core::deck::specimens::{self, Options, TESTS};
use wythe_core::results::evaluation::{self, TestRun};

/// Name and one-line description of every standard test.
#[pyfunction]
pub fn tests() -> Vec<(&'static str, &'static str)> {
    TESTS.iter().map(|test| (test.name, test.about)).collect()
}

/// Decks of a standard test: what sets each apart from the others, and its text.
#[pyfunction]
#[pyo3(signature = (name, unit, joint, precompression, size, materials))]
pub fn test_decks(
    name: &str,
    unit: Option<String>,
    joint: Option<String>,
    precompression: Option<String>,
    size: Option<String>,
    materials: Option<String>,
) -> PyResult<Vec<(String, String)>> {
    let options = Options {
        unit,
        joint,
        precompression,
        size,
        materials,
    };
    let unknown = || PyValueError::new_err(format!("name: there is no test {name:?}"));
    let test = specimens::find(name).ok_or_else(unknown)?;
    let wrong = |why: specimens::SpecimenError| {
        let option = why.option.trim_start_matches('-');
        PyValueError::new_err(format!("{option}: {}; {}", why.message, why.help))
    };
    let decks = test.decks(&options).map_err(wrong)?;
    Ok(decks
        .into_iter()
        .map(|deck| (deck.part, deck.text))
        .collect())
}

/// Evaluation of the runs in these folders, as JSON.
#[pyfunction]
pub fn evaluate(py: Python<'_>, folders: Vec<PathBuf>) -> PyResult<String> {
    let found = py.detach(|| {
        let runs = folders.iter().map(|folder| TestRun::read(folder));
        evaluation::evaluate(&runs.collect::<Result<Vec<_>, _>>()?)
    });
    let wrong = |why: String| PyValueError::new_err(why);
    let found = found.map_err(|why| wrong(format!("{why}; {}", why.help())))?;
    serde_json::to_string(&found).map_err(|why| wrong(why.to_string()))
}
