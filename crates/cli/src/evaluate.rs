//! `wythe evaluate`: what a standard test reports.

use wythe_core::results::evaluation::{self, Evaluation, EvaluationError, TestRun, TestValue};

use crate::arguments::Evaluate;
use crate::failure::Failure;
use crate::say::print;

/// Evaluates the runs of a standard test and prints the result.
pub fn evaluate(arguments: &Evaluate) -> Result<(), Failure> {
    let runs = arguments.folders.iter().map(|folder| TestRun::read(folder));
    let runs = runs.collect::<Result<Vec<_>, _>>().map_err(failure)?;
    let found = evaluation::evaluate(&runs).map_err(failure)?;
    if !arguments.json {
        return print(&table(&found));
    }
    let json = serde_json::to_string_pretty(&found)
        .map_err(|error| Failure::InputOutput(miette::Report::msg(format!("no JSON: {error}"))))?;
    print(&format!("{json}\n"))
}

/// The failure of an evaluation: files and decks have errors of their own.
fn failure(why: EvaluationError) -> Failure {
    match why {
        EvaluationError::Read(why) => why.into(),
        EvaluationError::Deck(why) => (*why).into(),
        EvaluationError::Model(why) => (*why).into(),
        other => Failure::Model(miette::miette!(help = other.help(), "{other}")),
    }
}

/// The results as text: a block for each run, one for all together, and the notes.
fn table(found: &Evaluation) -> String {
    let mut text = String::new();
    for run in &found.runs {
        text += &format!("{}\n", run.run);
        run.values.iter().for_each(|value| text += &line(value));
    }
    if !found.together.is_empty() {
        text += "all runs\n";
        found.together.iter().for_each(|value| text += &line(value));
    }
    for note in &found.notes {
        text += &format!("note: {note}\n");
    }
    text
}

fn line(value: &TestValue) -> String {
    let number = digits(value.value);
    let TestValue {
        name, unit, about, ..
    } = value;
    format!("  {name:20}{number:>12} {unit:6} {about}\n")
}

/// A value with four significant digits.
fn digits(value: f64) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let decimals = (3.0 - value.abs().log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{value:.decimals$}")
}

#[cfg(test)]
mod tests {
    use super::digits;

    #[test]
    fn values_have_four_digits() {
        let all = [
            (0.213_456, "0.2135"),
            (12_345.6, "12346"),
            (-1.0, "-1.000"),
            (0.0, "0"),
            (0.002_5, "0.002500"),
        ];
        for (value, text) in all {
            assert_eq!(digits(value), text);
        }
    }
}
