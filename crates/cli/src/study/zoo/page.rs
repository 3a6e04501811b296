//! Page of the zoo as Markdown, and its histogram.

use std::collections::BTreeMap;

use super::row::{AREA, CRASHED, ENERGY, OUT_OF_TIME, PEAK, REFUSED, SOLVES, ZooRow};
use super::study::Folder;
use wythe_core::results::plotting::{self, Bars};

/// Target for the median number of solves.
const MEDIAN: usize = 350;
/// Target for the 95th percentile of the number of solves.
const MOST: usize = 1500;

/// Statuses with their own colour in the histogram; all others share the next colour.
const COLOURED: [&str; 5] = [
    "completed",
    "collapsed",
    OUT_OF_TIME,
    "not_converged",
    CRASHED,
];

/// Histogram of the solves of all walls as SVG text; none if no wall was solved.
///
/// # Errors
/// The message of plotters if it cannot draw.
pub fn histogram(rows: &[ZooRow]) -> Result<Option<String>, String> {
    let of_status = |(name, _): (String, usize)| {
        let solved = rows.iter().filter(|r| r.status == name && r.solves > 0);
        Bars {
            colour: COLOURED
                .iter()
                .position(|of| *of == name)
                .unwrap_or(COLOURED.len()),
            values: solved.map(|r| r.solves as f64).collect(),
            name,
        }
    };
    let series: Vec<Bars> = statuses(rows).into_iter().map(of_status).collect();
    if series.iter().all(|s| s.values.is_empty()) {
        return Ok(None);
    }
    plotting::histogram("Solves of the zoo", "linear solves", "walls", &series).map(Some)
}

/// The page. `picture` is the file name of the histogram beside it, if there is one; `command` produces the page.
pub fn page(rows: &[ZooRow], picture: Option<&str>, command: &str) -> String {
    let mut page = format!(
        "# The zoo\n\nRandom walls, each drawn from its seed and run as a newcomer would: every key of the solver has its \
         default. Made by `{command}` (wythe {}).\n\n",
        env!("CARGO_PKG_VERSION")
    );
    figures(&mut page, rows);
    if let Some(picture) = picture {
        page.push_str(&format!(
            "\n![Solves of the walls, on a logarithmic axis]({picture})\n"
        ));
    }
    loads(&mut page, rows);
    walls(&mut page, rows);
    page
}

/// Number of walls of each status: answers first, then by decreasing number.
fn statuses(rows: &[ZooRow]) -> Vec<(String, usize)> {
    let mut counts: BTreeMap<&str, (bool, usize)> = BTreeMap::new();
    for row in rows {
        let count = counts.entry(&row.status).or_insert((!row.answered(), 0));
        count.1 += 1;
    }
    let mut all: Vec<_> = counts.into_iter().collect();
    all.sort_by_key(|(_, (unanswered, count))| (*unanswered, std::cmp::Reverse(*count)));
    all.into_iter()
        .map(|(name, (_, count))| (name.to_owned(), count))
        .collect()
}

/// Smallest value that is not exceeded by this part of all values; none if there are no values. `part` is between
/// 0 and 1.
fn quantile(values: impl Iterator<Item = usize>, part: f64) -> Option<usize> {
    let mut sorted: Vec<usize> = values.collect();
    sorted.sort_unstable();
    let rank = (part * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.saturating_sub(1)).copied()
}

fn told(value: Option<usize>) -> String {
    value.map_or("–".to_owned(), |v| v.to_string())
}

/// Appends summary figures beside their targets.
fn figures(page: &mut String, rows: &[ZooRow]) {
    let sound = || rows.iter().filter(|r| r.status != REFUSED);
    let solves = || sound().map(|r| r.solves);
    let answered = rows.iter().filter(|r| r.answered()).count();
    let out = rows.iter().filter(|r| r.energies_out()).count();
    let mut line = |name: &str, value: String, aim: &str| {
        page.push_str(&format!("| {name} | {value} | {aim} |\n"));
    };
    line("", String::new(), "aim");
    line("---", "---".to_owned(), "---");
    line("walls", rows.len().to_string(), "");
    for (name, count) in statuses(rows) {
        line(&format!("{name} walls"), count.to_string(), "");
    }
    let name = "completed or collapsed, of those that are not refused as wrong models";
    line(name, format!("{answered} of {}", sound().count()), "all");
    let percent = 100.0 * ENERGY;
    line(
        &format!("energies out by more than {percent} %"),
        out.to_string(),
        "none",
    );
    line(
        "solves: median",
        told(quantile(solves(), 0.5)),
        &format!("≤ {MEDIAN}"),
    );
    line(
        "solves: 95th percentile",
        told(quantile(solves(), 0.95)),
        &format!("≤ {MOST}"),
    );
    line("solves: most", told(solves().max()), &format!("≤ {SOLVES}"));
    let compared = || rows.iter().filter(|r| r.peak_difference.is_some());
    if compared().next().is_some() {
        let far = compared().filter(|r| r.far_from_reference()).count();
        let name = format!(
            "of {} compared with a careful run, peak out by more than {} % or area by more than {} %",
            compared().count(),
            100.0 * PEAK,
            100.0 * AREA
        );
        line(&name, far.to_string(), "none");
    }
    let cpu: f64 = rows.iter().map(|r| r.cpu_s).sum();
    line("CPU time of all runs, s", format!("{cpu:.0}"), "");
    page.push_str(
        "\nSolves of a wall that did not come to an end are those that it took until then. Energies are compared as in \
         `summary.json`.\n",
    );
}

/// Appends a line for each kind of load.
fn loads(page: &mut String, rows: &[ZooRow]) {
    let mut of_loads: BTreeMap<&str, Vec<&ZooRow>> = BTreeMap::new();
    for row in rows {
        of_loads.entry(&row.load).or_default().push(row);
    }
    page.push_str(
        "\n| Load | walls | completed or collapsed | energies out | solves: median | most |\n|---|---|---|---|---|---|\n",
    );
    for (load, rows) in of_loads {
        page.push_str(&format!(
            "| {load} | {} | {} | {} | {} | {} |\n",
            rows.len(),
            rows.iter().filter(|r| r.answered()).count(),
            rows.iter().filter(|r| r.energies_out()).count(),
            told(quantile(rows.iter().map(|r| r.solves), 0.5)),
            told(rows.iter().map(|r| r.solves).max())
        ));
    }
}

/// Rank of a wall in the table, by its worst deficiency: no answer, unbalanced energies, a curve far from its
/// reference, many solves. Walls that are rejected come last, because their decks are invalid.
fn badness(row: &ZooRow) -> (u8, usize) {
    let kind = if row.status == REFUSED {
        4
    } else if !row.answered() {
        0
    } else if row.energies_out() {
        1
    } else if row.far_from_reference() {
        2
    } else {
        3
    };
    (kind, usize::MAX - row.solves)
}

/// Appends the table of all walls, the worst first.
fn walls(page: &mut String, rows: &[ZooRow]) {
    let mut order: Vec<&ZooRow> = rows.iter().collect();
    order.sort_by_key(|row| badness(row));
    let compared = rows.iter().any(|r| !r.reference_status.is_empty());
    page.push_str("\n## Walls, the worst first\n\n| Seed | wall | load | status | solves | increments | cut-backs | CPU s | energies | peak, kN | at, mm | warnings |");
    page.push_str(if compared {
        " reference | peak | area |"
    } else {
        ""
    });
    page.push_str(" message |\n|---|---|---|---|---|---|---|---|---|---|---|---|");
    page.push_str(if compared {
        "---|---|---|---|\n"
    } else {
        "---|\n"
    });
    for row in order {
        let number = |value: Option<f64>| value.map_or(String::new(), |v| format!("{v:.4}"));
        let percent = |value: Option<f64>, bound: f64| {
            value.map_or(String::new(), |v| {
                let bold = if v.abs() <= bound { "" } else { "**" };
                format!("{bold}{:+.2} %{bold}", 100.0 * v)
            })
        };
        let bold = |text: String, wrong: bool| if wrong { format!("**{text}**") } else { text };
        let energy = row
            .energy_balance_error
            .map_or(String::new(), |e| format!("{e:.0e}"));
        let mut cells = vec![
            links(row.seed),
            wall(row),
            row.load.clone(),
            bold(row.status.clone(), !row.answered()),
            bold(row.solves.to_string(), row.solves > SOLVES),
            row.increments.to_string(),
            row.cutbacks.to_string(),
            format!("{:.1}", row.cpu_s),
            bold(energy, row.energies_out()),
            number(row.peak_force_kN),
            number(row.displacement_at_peak_mm),
            row.warnings.to_string(),
        ];
        if compared {
            cells.push(row.reference_status.clone());
            cells.push(percent(row.peak_difference, PEAK));
            cells.push(percent(row.area_difference, AREA));
        }
        cells.push(row.message.clone());
        let cells: Vec<String> = cells.iter().map(|text| text.replace('|', "\\|")).collect();
        page.push_str(&format!("| {} |\n", cells.join(" | ")));
    }
}

/// Links to the folder of a wall's run and to its deck.
fn links(seed: u64) -> String {
    let walls = Folder::WALLS;
    format!("[{seed}]({walls}/{seed}.out) ([deck]({walls}/{seed}.toml))")
}

/// Description of a wall in a few words.
fn wall(row: &ZooRow) -> String {
    let joint = match row.joint_mm {
        0.0 => "dry".to_owned(),
        joint => format!("{joint} mm joints, c {} MPa", row.joint_c_MPa),
    };
    let opening = if row.opening { ", opening" } else { "" };
    let pressure = row
        .pressure_MPa
        .map_or(String::new(), |p| format!(", {p} MPa"));
    format!(
        "{} of {}, {:.0} mm, {} courses, {joint}{opening}{pressure}",
        row.bond, row.unit, row.length_mm, row.courses
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::zoo::Wall;

    fn row(seed: u64, status: &str, solves: usize, energy: f64) -> ZooRow {
        ZooRow {
            status: status.to_owned(),
            solves,
            energy_balance_error: Some(energy),
            ..ZooRow::of_wall(&Wall::drawn(seed))
        }
    }

    #[test]
    fn the_worst_walls_come_first_and_figures_are_those_of_all() {
        let rows = [
            row(1, "completed", 100, 1e-3),
            row(2, "completed", 900, 1e-3),
            row(3, "collapsed", 300, 0.02),
            row(4, "out_of_time", 6000, 1e-3),
            row(5, "refused", 0, 0.0),
        ];
        let text = page(&rows, Some("solves.svg"), "wythe study zoo");
        for line in [
            "| walls | 5 |  |",
            "| completed walls | 2 |  |",
            "| collapsed walls | 1 |  |",
            "| out_of_time walls | 1 |  |",
            "wrong models | 3 of 4 | all |",
            "| energies out by more than 1 % | 1 | none |",
            "| solves: median | 300 | ≤ 350 |",
            "| solves: 95th percentile | 6000 | ≤ 1500 |",
            "| solves: most | 6000 | ≤ 5000 |",
            "![Solves of the walls, on a logarithmic axis](solves.svg)",
        ] {
            assert!(text.contains(line), "{line} in {text}");
        }
        let at = |seed: u64| text.find(&links(seed)).unwrap();
        assert!(at(4) < at(3) && at(3) < at(2) && at(2) < at(1) && at(1) < at(5));
        assert!(!text.contains("reference |"));
        let svg = histogram(&rows).unwrap().unwrap();
        assert!(svg.contains("completed (2)") && svg.contains("out_of_time (1)"));
    }

    #[test]
    fn differences_from_references_are_told_where_there_are_any() {
        let mut far = row(1, "completed", 100, 1e-3);
        far.reference_status = "completed".to_owned();
        (far.peak_difference, far.area_difference) = (Some(-0.031), Some(0.01));
        far.message = "a | b".to_owned();
        let rows = [row(2, "completed", 900, 1e-3), far];
        let text = page(&rows, None, "wythe study zoo");
        assert!(
            text.contains("| **-3.10 %** | +1.00 % | a \\| b |"),
            "{text}"
        );
        assert!(text.contains("of 1 compared with a careful run"));
        assert!(text.find(&links(1)).unwrap() < text.find(&links(2)).unwrap());
        // All lines of a table must have the same number of cells.
        let cells = |line: &str| line.replace("\\|", "").matches('|').count();
        let table = text.split("worst first").nth(1).unwrap();
        let lines: Vec<&str> = table.lines().filter(|l| l.starts_with('|')).collect();
        assert!(
            lines.iter().all(|l| cells(l) == cells(lines[0])),
            "{lines:?}"
        );
    }

    #[test]
    fn quantiles_are_values_that_there_are() {
        let of = |values: &[usize], part| quantile(values.iter().copied(), part);
        assert_eq!(of(&[], 0.5), None);
        assert_eq!(of(&[7], 0.95), Some(7));
        assert_eq!(of(&[4, 1, 3, 2], 0.5), Some(2));
        let hundred: Vec<usize> = (1..=100).collect();
        assert_eq!(of(&hundred, 0.95), Some(95));
    }

    #[test]
    fn a_zoo_without_a_wall_has_a_page_without_a_picture() {
        assert_eq!(histogram(&[]).unwrap(), None);
        assert!(page(&[], None, "wythe study zoo").contains("| walls | 0 |"));
    }
}
