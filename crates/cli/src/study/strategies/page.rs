//! Page and chart of the strategies.

use super::row::{Answer, Ran, Row};
use wythe_core::deck::Strategy;
use wythe_core::results::plotting::{Line, curves};

/// The page as Markdown. `title`: that of the deck; `picture`: file of the chart; `command`: what makes the page.
pub fn page(rows: &[Row], title: &str, picture: Option<&str>, command: &str) -> String {
    let mut text = format!(
        "# Strategies: {title}\n\nWritten by `{command}`. Differences are to the `detailed` run; CPU times are those of all \
         threads together.\n\n| Strategy | Largest force [kN] | Difference | At [mm] | CPU [s] | Solves | Energies | \
         Warnings | Ended |\n|---|---|---|---|---|---|---|---|---|\n"
    );
    let reference = rows.iter().find(|row| row.strategy == Strategy::Detailed);
    let reference = reference.and_then(Row::force);
    for row in rows {
        text += &line(row, reference);
    }
    if let Some(picture) = picture {
        text += &format!(
            "\n![Force over displacement by strategy]({picture})\n\nForces that inertia carries are left out of the \
             curves.\n"
        );
    }
    text
}

/// Line of a strategy. `reference`: largest force of the detailed run [kN].
fn line(row: &Row, reference: Option<f64>) -> String {
    const NONE: &str = "–";
    let or_none = |text: Option<String>| text.unwrap_or_else(|| NONE.to_owned());
    let factor = |row: &Row| match &row.answer {
        Answer::Limit(found) => Some(format!("factor {:.4}", found.factor)),
        _ => None,
    };
    let force = row.force().map(|force| format!("{force:.2}"));
    let difference = match (row.force(), reference) {
        (Some(force), Some(reference)) if row.strategy != Strategy::Detailed => {
            Some(format!("{:+.1} %", 100.0 * (force / reference - 1.0)))
        }
        _ => None,
    };
    let ran = match &row.answer {
        Answer::Run(ran) => Some(ran.as_ref()),
        _ => None,
    };
    let of_run = |figure: &dyn Fn(&Ran) -> Option<String>| or_none(ran.and_then(figure));
    format!(
        "| {} | {} | {} | {} | {:.1} | {} | {} | {} | {} |\n",
        row.strategy.name(),
        or_none(force.or_else(|| factor(row))),
        or_none(difference),
        of_run(&|ran| ran.peak.map(|peak| format!("{:.2}", peak.0))),
        row.cpu_s,
        of_run(&|ran| Some(ran.solves.to_string())),
        of_run(&|ran| ran.energies.map(|error| format!("{error:.1e}"))),
        of_run(&|ran| Some(ran.warnings.to_string())),
        row.ended.replace('|', " "),
    )
}

/// Curves of the runs, and the force of the limit analysis as a level line; none if there is no curve.
///
/// # Errors
/// The message of plotters if it cannot draw.
pub fn chart(rows: &[Row], title: &str) -> Result<Option<String>, String> {
    let most = rows.iter().filter_map(|row| match &row.answer {
        Answer::Run(ran) => ran.points.last().map(|point| point.0),
        _ => None,
    });
    let most = most.fold(
        0.0,
        |most: f64, x| if x.abs() > most.abs() { x } else { most },
    );
    let line = |row: &Row| {
        let points = match &row.answer {
            Answer::None => return None,
            Answer::Limit(found) => found.force.map(|force| vec![(0.0, force), (most, force)])?,
            Answer::Run(ran) => std::iter::once((0.0, 0.0))
                .chain(ran.points.clone())
                .collect(),
        };
        Some(Line {
            name: row.strategy.name().to_owned(),
            points,
            marks: Vec::new(),
        })
    };
    let lines: Vec<Line> = rows.iter().filter_map(line).collect();
    if most == 0.0 || lines.is_empty() {
        return Ok(None);
    }
    curves(title, ["Displacement [mm]", "Force [kN]"], &lines, &[]).map(Some)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::strategies::row::LimitLoad;

    fn rows() -> Vec<Row> {
        let run = |strategy, force: f64| Row {
            strategy,
            answer: Answer::Run(Box::new(Ran {
                points: vec![(1.0, force), (2.0, 0.5 * force)],
                peak: Some((1.0, force)),
                solves: 12,
                energies: Some(1e-4),
                warnings: 0,
            })),
            ended: "completed".to_owned(),
            cpu_s: 3.0,
        };
        let limit = Row {
            answer: Answer::Limit(LimitLoad {
                factor: 9e3,
                force: Some(9.0),
                live_load: "force along the drive".to_owned(),
            }),
            ..run(Strategy::Limit, 0.0)
        };
        vec![
            limit,
            run(Strategy::Simplified, 11.0),
            run(Strategy::Detailed, 10.0),
        ]
    }

    #[test]
    fn the_page_has_a_line_a_strategy_beside_the_detailed_one() {
        let text = page(
            &rows(),
            "a wall",
            Some("strategies.svg"),
            "wythe study strategies",
        );
        for line in [
            "| limit | 9.00 | -10.0 % | – | 3.0 | – | – | – | completed |",
            "| simplified | 11.00 | +10.0 % | 1.00 | 3.0 | 12 | 1.0e-4 | 0 | completed |",
            "| detailed | 10.00 | – | 1.00 |",
            "(strategies.svg)",
        ] {
            assert!(text.contains(line), "{line}\n{text}");
        }
    }

    #[test]
    fn the_chart_has_the_limit_as_a_level_line_and_none_without_a_curve() {
        let rows = rows();
        let svg = chart(&rows, "a wall").unwrap().unwrap();
        for name in ["limit", "simplified", "detailed"] {
            assert!(svg.contains(name), "{name}");
        }
        assert!(chart(&rows[..1], "a wall").unwrap().is_none());
    }
}
