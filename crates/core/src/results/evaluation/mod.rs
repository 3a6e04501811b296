//! Evaluation of standard tests: what the test reports, from the runs of its decks (docs/reference/standard-tests.md).
//!
//! A deck says by its table `[test]` which test it models and with which sizes.

mod flat_jack;
mod formulas;
mod line;
mod run;

pub use run::{EvaluationError, TestRun};

use crate::deck::schema::TestKind;
use serde::Serialize;

/// Results of a standard test.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evaluation {
    /// The test.
    pub test: TestKind,
    /// Results of each run.
    pub runs: Vec<RunValues>,
    /// Results of all runs together; empty if the test has none.
    pub together: Vec<TestValue>,
    /// Remarks on how far the results can be trusted.
    pub notes: Vec<String>,
}

/// Results of one run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunValues {
    /// Name of its folder, without the ending.
    pub run: String,
    /// Results.
    pub values: Vec<TestValue>,
}

/// A result of a test.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TestValue {
    /// Symbol, such as `f_v0`.
    pub name: &'static str,
    /// Value in its unit.
    pub value: f64,
    /// Unit; empty for ratios.
    pub unit: &'static str,
    /// Meaning and definition.
    pub about: &'static str,
}

impl TestValue {
    const fn new(name: &'static str, value: f64, unit: &'static str, about: &'static str) -> Self {
        Self {
            name,
            value,
            unit,
            about,
        }
    }
}

/// Evaluates the runs of one test.
///
/// # Errors
/// No run, runs of different tests, a run without a curve.
pub fn evaluate(runs: &[TestRun]) -> Result<Evaluation, EvaluationError> {
    let first = runs.first().ok_or(EvaluationError::NoRuns)?;
    let kind = first.test.kind;
    if let Some(other) = runs.iter().find(|run| run.test.kind != kind) {
        return Err(EvaluationError::Mixed {
            first: first.name.clone(),
            other: other.name.clone(),
        });
    }
    let of_run = |run: &TestRun| {
        Ok(RunValues {
            run: run.name.clone(),
            values: formulas::values(run)?,
        })
    };
    let values = runs
        .iter()
        .map(of_run)
        .collect::<Result<Vec<_>, EvaluationError>>()?;
    let mut notes = Vec::new();
    for run in runs {
        run.remarks(&mut notes);
    }
    Ok(Evaluation {
        test: kind,
        together: formulas::together(runs, &values, &mut notes),
        runs: values,
        notes,
    })
}

#[cfg(test)]
mod tests;
