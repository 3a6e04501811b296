//! `wythe compare`: compares a run with an experiment.

use wythe_core::results::comparison::{Comparison, Measures};
use wythe_core::results::{self, Experiment, RunFolder};

use crate::arguments::Compare;
use crate::failure::Failure;
use crate::say::print;

/// Compares the curves and prints the result.
pub fn compare(arguments: &Compare) -> Result<(), Failure> {
    let folder = RunFolder::open(&arguments.folder)?;
    let experiment = Experiment::read(&arguments.experiment)?;
    let curve = folder.history()?.curve();
    let height = arguments.height.or_else(|| folder.clear_height());
    let found = results::compare(&curve, &experiment, height);
    if !arguments.json {
        return print(&table(&found));
    }
    let json = serde_json::to_string_pretty(&found)
        .map_err(|error| Failure::InputOutput(miette::Report::msg(format!("no JSON: {error}"))))?;
    print(&format!("{json}\n"))
}

/// A row of the table: label, number of decimals, and value.
type Row = (&'static str, usize, fn(&Measures) -> Option<f64>);

const ROWS: [Row; 7] = [
    ("largest force [kN]", 2, |m| m.peak_force_kN),
    ("displacement there [mm]", 3, |m| m.displacement_at_peak_mm),
    ("initial stiffness [kN/mm]", 2, |m| {
        m.initial_stiffness_kN_per_mm
    }),
    ("secant stiffness at 70 % [kN/mm]", 2, |m| {
        m.secant_stiffness_kN_per_mm
    }),
    ("energy, common range [J]", 1, |m| m.energy_J),
    ("displacement at 80 % [mm]", 3, |m| {
        m.displacement_at_80_percent_mm
    }),
    ("drift at 80 % [%]", 3, |m| m.drift_at_80_percent),
];

fn table(found: &Comparison) -> String {
    let name = &found.experiment_name;
    let mut text = format!("{:34}{:>12}{:>12}{:>9}\n", "", "run", "experiment", "ratio");
    for (what, decimals, of) in ROWS {
        let cell = |value: Option<f64>, decimals: usize| match value {
            Some(value) => format!("{value:.decimals$}"),
            None => "–".to_owned(),
        };
        let [run, test] = [&found.run, &found.experiment].map(|m| cell(of(m), decimals));
        let ratio = cell(of(&found.ratio), 3);
        text += &format!("{what:34}{run:>12}{test:>12}{ratio:>9}\n");
    }
    match (found.common_range_mm, found.rms_difference_kN) {
        (Some([from, to]), Some(rms)) => {
            let share = found.rms_over_peak.map_or(String::new(), |share| {
                format!(", {:.1} % of the experiment's peak", 100.0 * share)
            });
            text += &format!("rms difference {rms:.2} kN{share}, from {from:.3} to {to:.3} mm\n");
        }
        _ => text += "the curves have no displacement in common\n",
    }
    text += &format!(
        "experiment: {name}{}\n",
        if found.mirrored { ", mirrored" } else { "" }
    );
    match found.height_mm {
        Some(height) => text + &format!("drift over {height:.1} mm\n"),
        None => text + "no clear height is known for the drift: say --height\n",
    }
}
