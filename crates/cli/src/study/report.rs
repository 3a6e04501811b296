//! The atlas as a page of Markdown.

use super::cell::{Cell, Verdict};
use super::expect::percent;
use super::method::METHODS;
use super::stability::{Row, Study};

/// A verdict in a few words, for a cell of the table and for the terminal.
pub fn brief(cell: &Cell) -> String {
    match &cell.verdict {
        Verdict::Completed(Some(error)) => format!("completed, {}", size(*error)),
        Verdict::Completed(None) => "completed".to_owned(),
        Verdict::Wrong(reasons) => {
            format!("wrong: {}", reasons.first().map_or("", |r| heading(r)))
        }
        Verdict::Diverged(place, _) => format!("diverged, {place}"),
        Verdict::Stopped(place) => format!("stopped, {place}"),
        Verdict::Inapplicable(_) => "–".to_owned(),
        Verdict::Broken(_) => "broken".to_owned(),
    }
}

/// A fraction as a percentage, without a plus sign.
fn size(error: f64) -> String {
    percent(error).trim_start_matches('+').to_owned()
}

/// A reason in short: its text up to the first bracket.
fn heading(reason: &str) -> &str {
    reason.split(" (").next().unwrap_or(reason)
}

/// The page as Markdown. `picture` is the file name of the picture, which lies beside the page.
pub fn report(study: &Study, picture: &str) -> String {
    let mut page = format!(
        "# Where each method fails\n\n\
         Every case of the atlas through every method, {} forms, one thread a cell.\n\
         Repeat it with `wythe study stability{}`. A cell is\n\n\
         * **completed**: it ended as it should, every number is finite, every increment in balance to \
         its tolerance, energies close to {}, and every expectation holds; with the largest error \
         against the references;\n\
         * **wrong**: it ended as it should and one of these fails;\n\
         * **diverged**: it lost convergence; the step and how much of it was done;\n\
         * **stopped**: its time was up;\n\
         * **–**: the method does not apply.\n\n\
         `simplified` and `rigid` are modelling strategies of the walls, solved by `auto`: their errors are those of \
         the coarser model.\n\n\
         ![Cases against methods, coloured by verdict]({picture})\n\n",
        if study.short { "short" } else { "full" },
        if study.short {
            " --short --out DIR"
        } else {
            ""
        },
        size(super::case::ENERGY),
    );
    table(&mut page, study);
    for row in &study.rows {
        case(&mut page, row);
    }
    page
}

/// Appends the table of cases against methods.
fn table(page: &mut String, study: &Study) {
    let names: Vec<&str> = METHODS
        .iter()
        .map(|m| m.name)
        .filter(|name| {
            let mut cells = study.rows.iter().flat_map(|r| &r.cells);
            cells.any(|c| c.method == *name)
        })
        .collect();
    let rows = study.rows.iter().filter(|r| r.case.methods.is_empty());
    page.push_str(&format!("| Case | {} |\n", names.join(" | ")));
    page.push_str(&format!("|---|{}\n", "---|".repeat(names.len())));
    for row in rows {
        let cell = |name: &&str| {
            let of_name = row.cells.iter().find(|c| c.method == **name);
            of_name.map_or_else(String::new, |c| escaped(&brief(c)))
        };
        let cells: Vec<String> = names.iter().map(cell).collect();
        page.push_str(&format!(
            "| {} | {} |\n",
            escaped(&row.case.name()),
            cells.join(" | ")
        ));
    }
    page.push_str("\nCases with methods of their own are in their paragraphs.\n");
}

/// Appends the paragraph of a case.
fn case(page: &mut String, row: &Row) {
    let case = &row.case;
    page.push_str(&format!(
        "\n## {}\n\n{}\n\nReference: {}\n",
        case.name(),
        case.mechanics.trim(),
        case.source.trim()
    ));
    if case.energy != super::case::ENERGY {
        let why = match case.why.trim() {
            "" => String::new(),
            why => format!(": {why}"),
        };
        page.push_str(&format!(
            "Energies may differ by {}{why}.\n",
            size(case.energy)
        ));
    }
    costs(page, &row.cells);
    for cell in row.cells.iter().filter(|c| !c.procedures.is_empty()) {
        let all: Vec<String> = cell
            .procedures
            .iter()
            .map(|(name, count)| format!("{name} {count}"))
            .collect();
        page.push_str(&format!(
            "\n{} took increments by {}.\n",
            cell.method,
            all.join(", ")
        ));
    }
    let why = |cell: &Cell| Some(format!("* {}: {}.\n", cell.method, cell.why()?));
    let told: Vec<String> = row.cells.iter().filter_map(why).collect();
    if !told.is_empty() {
        page.push('\n');
        page.push_str(&told.concat());
    }
}

/// Appends the table of a case: verdict and cost of each method.
fn costs(page: &mut String, cells: &[Cell]) {
    page.push_str(
        "\n| Method | | increments | solves | cuts | CPU s | energies | out of balance |\n\
         |---|---|---|---|---|---|---|---|\n",
    );
    for cell in cells {
        let cost = &cell.cost;
        if cost.iterations == 0 {
            let name = escaped(&cell.method);
            page.push_str(&format!(
                "| {name} | {} | | | | | | |\n",
                escaped(&brief(cell))
            ));
            continue;
        }
        page.push_str(&format!(
            "| {} | {} | {} | {} | {} | {:.2} | {:.0e} | {:.0e} |\n",
            escaped(&cell.method),
            escaped(&brief(cell)),
            cost.increments,
            cost.iterations,
            cost.cutbacks,
            cost.seconds,
            cell.energy,
            cell.out_of_balance
        ));
    }
}

/// Escapes a text for a cell of a table.
pub(super) fn escaped(text: &str) -> String {
    text.replace('|', "\\|").replace('\n', " ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::case::{Case, CaseMethod};
    use crate::study::cell::{Cost, Place};

    fn cell(method: &str, verdict: Verdict) -> Cell {
        let cost = Cost {
            increments: 10,
            iterations: 25,
            cutbacks: 1,
            seconds: 0.123,
        };
        Cell {
            method: method.to_owned(),
            verdict,
            cost,
            measured: Vec::new(),
            out_of_balance: 1e-3,
            energy: 1e-4,
            procedures: Vec::new(),
        }
    }

    pub fn study() -> Study {
        let place = Place {
            step: 1,
            done: 0.25,
        };
        let first = Case {
            title: "Bar | snaps".to_owned(),
            mechanics: "It snaps.".to_owned(),
            ..Case::empty()
        };
        let own = Case {
            number: 17,
            methods: vec![CaseMethod {
                name: "penalty 5".to_owned(),
                set: Vec::new(),
            }],
            ..Case::empty()
        };
        let rows = vec![
            Row {
                case: first,
                cells: vec![
                    cell("auto", Verdict::Completed(Some(0.0012))),
                    cell(
                        "direct",
                        Verdict::Diverged(place, "the matrix is singular".to_owned()),
                    ),
                    cell(
                        "quasi_static",
                        Verdict::Inapplicable("stone has no density".to_owned()),
                    ),
                ],
            },
            Row {
                case: own,
                cells: vec![cell(
                    "penalty 5",
                    Verdict::Wrong(vec!["peak 3.0, +5.0 % of 2.9 (± 1.0 %)".to_owned()]),
                )],
            },
        ];
        Study {
            rows,
            short: false,
            interrupted: false,
        }
    }

    #[test]
    fn the_page_tells_verdicts_places_and_reasons() {
        let page = report(&study(), "stability.svg");
        for text in [
            "completed, 0.1 %",
            "diverged, step 1 at 25.0 %",
            "* direct: the matrix is singular.",
            "* quasi_static: stone has no density.",
            "wrong: peak 3.0, +5.0 % of 2.9 |",
            "* penalty 5: peak 3.0, +5.0 % of 2.9 (± 1.0 %).",
            "## 17 ",
            "(stability.svg)",
            "| 10 | 25 | 1 | 0.12 |",
        ] {
            assert!(page.contains(text), "{text}\n{page}");
        }
        let header = page.lines().find(|l| l.starts_with("| Case")).unwrap();
        assert_eq!(header, "| Case | auto | direct | quasi_static |");
    }

    #[test]
    fn the_picture_has_a_square_a_cell_and_writes_into_it() {
        let svg = super::super::picture(&study()).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        for text in ["1 Bar | snaps", "auto", "0.1 %", "penalty 5", "1: 25 %"] {
            assert!(svg.contains(text), "{text}");
        }
    }
}
