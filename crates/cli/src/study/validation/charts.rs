//! The charts of a case.

use super::case::{Chart, Content};
use super::outcome::{Outcome, Validated};
use wythe_core::results::plotting::{Line, curves};

/// A chart as SVG text. Runs without results are left out.
///
/// # Errors
/// The message of plotters if it cannot draw.
pub fn chart(chart: &Chart, validated: &Validated) -> Result<String, String> {
    let runs = match &chart.content {
        Content::Curves(names) => names
            .iter()
            .filter_map(|name| Some(curve(chart, validated, validated.outcome(name)?)))
            .collect(),
        Content::Measures { expect, at } => {
            let measured = |(name, x): &(String, f64)| {
                Some((*x, validated.measured(name, expect)?.value * chart.y.factor))
            };
            vec![Line {
                name: "wythe".to_owned(),
                points: Vec::new(),
                marks: at.iter().filter_map(measured).collect(),
            }]
        }
    };
    let axes = [chart.x.label.as_str(), chart.y.label.as_str()];
    curves(&chart.title, axes, &runs, &chart.references)
}

/// Curve of one column over the other, from the state at rest.
fn curve(chart: &Chart, validated: &Validated, outcome: &Outcome) -> Line {
    let column = |name: &Option<String>| match name {
        Some(name) => outcome.history.column(name),
        None => &[],
    };
    let (x, y) = (column(&chart.x.column), column(&chart.y.column));
    let scaled = |(x, y): (&f64, &f64)| (x * chart.x.factor, y * chart.y.factor);
    let points = x.iter().zip(y).map(scaled).filter(finite);
    let run = validated.case.runs.iter().find(|r| r.name == outcome.name);
    let about = run.map_or("", |r| r.about.as_str());
    Line {
        name: match about {
            "" => format!("wythe, {}", outcome.name),
            about => format!("wythe, {}: {about}", outcome.name),
        },
        points: std::iter::once((0.0, 0.0)).chain(points).collect(),
        marks: Vec::new(),
    }
}

fn finite((x, y): &(f64, f64)) -> bool {
    x.is_finite() && y.is_finite()
}
