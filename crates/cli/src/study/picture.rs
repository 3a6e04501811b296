//! The atlas as a picture: a row per case, a column per method, coloured by verdict.

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::cell::{Cell, Verdict};
use super::expect::percent;
use super::method::METHODS;
use super::stability::Study;
use wythe_core::results::plotting::svg;

/// Sizes [px]: width and height of a cell, then width of the titles, height of the names, margin.
const CELL: (i32, i32) = (118, 34);
const TITLES: i32 = 540;
const NAMES: i32 = 34;
const MARGIN: i32 = 12;
/// Height of the legend [px].
const LEGEND: i32 = 40;

const COMPLETED: RGBColor = RGBColor(178, 214, 168);
const WRONG: RGBColor = RGBColor(240, 178, 92);
const DIVERGED: RGBColor = RGBColor(222, 130, 122);
const STOPPED: RGBColor = RGBColor(196, 180, 214);
const NONE: RGBColor = RGBColor(236, 236, 236);

type Drawn<'a> = Result<(), DrawingAreaErrorKind<<SVGBackend<'a> as DrawingBackend>::ErrorType>>;

/// The atlas as SVG text.
///
/// # Errors
/// The message of plotters if it cannot draw.
pub fn picture(study: &Study) -> Result<String, String> {
    let columns = columns(study);
    let most = study.rows.iter().map(|r| r.cells.len()).max().unwrap_or(0);
    let width = 2 * MARGIN + TITLES + CELL.0 * columns.len().max(most) as i32;
    let height = 2 * MARGIN + NAMES + CELL.1 * study.rows.len() as i32 + LEGEND;
    svg((width as u32, height as u32), |root| {
        draw(root, study, &columns)
    })
}

/// Methods of the atlas that were run with at least one case.
fn columns(study: &Study) -> Vec<&'static str> {
    let cells = || study.rows.iter().flat_map(|r| &r.cells);
    let used = |name: &&str| cells().any(|c| c.method == **name);
    METHODS.iter().map(|m| m.name).filter(used).collect()
}

fn draw<'a>(
    root: &DrawingArea<SVGBackend<'a>, Shift>,
    study: &Study,
    columns: &[&str],
) -> Drawn<'a> {
    root.fill(&WHITE)?;
    for (i, name) in columns.iter().enumerate() {
        let x = MARGIN + TITLES + CELL.0 * i as i32 + CELL.0 / 2;
        text(root, name, (x, MARGIN + NAMES / 2), 15, HPos::Center)?;
    }
    for (i, row) in study.rows.iter().enumerate() {
        let y = MARGIN + NAMES + CELL.1 * i as i32;
        text(
            root,
            &row.case.name(),
            (MARGIN, y + CELL.1 / 2),
            15,
            HPos::Left,
        )?;
        for (k, cell) in row.cells.iter().enumerate() {
            // A case with its own methods shows them side by side with their names.
            let own = !row.case.methods.is_empty();
            let column = columns.iter().position(|c| *c == cell.method && !own);
            let x = MARGIN + TITLES + CELL.0 * column.unwrap_or(k) as i32;
            let (colour, said) = shown(cell);
            let (from, to) = ((x + 1, y + 1), (x + CELL.0 - 1, y + CELL.1 - 1));
            root.draw(&Rectangle::new([from, to], colour.filled()))?;
            let middle = (x + CELL.0 / 2, y + CELL.1 / 2);
            if own {
                text(root, &cell.method, (middle.0, y + 10), 11, HPos::Center)?;
                text(root, &said, (middle.0, y + 24), 12, HPos::Center)?;
            } else {
                text(root, &said, middle, 13, HPos::Center)?;
            }
        }
    }
    let y = MARGIN + NAMES + CELL.1 * study.rows.len() as i32 + LEGEND / 2;
    let mut x = MARGIN;
    for (colour, meaning) in [
        (COMPLETED, "completed: largest error"),
        (WRONG, "wrong answer: what"),
        (DIVERGED, "lost convergence: step, part done"),
        (STOPPED, "out of time"),
        (NONE, "does not apply"),
    ] {
        root.draw(&Rectangle::new([(x, y), (x + 14, y + 14)], colour.filled()))?;
        text(root, meaning, (x + 20, y + 7), 13, HPos::Left)?;
        x += 40 + 7 * meaning.len() as i32;
    }
    Ok(())
}

fn text<'a>(
    root: &DrawingArea<SVGBackend<'a>, Shift>,
    text: &str,
    at: (i32, i32),
    size: i32,
    to: HPos,
) -> Drawn<'a> {
    let style = ("sans-serif", size)
        .into_text_style(root)
        .pos(Pos::new(to, VPos::Center));
    root.draw_text(text, &style, at)
}

/// Colour and text of a cell.
fn shown(cell: &Cell) -> (RGBColor, String) {
    let place = |p: &super::Place| format!("{}: {:.0} %", p.step, 100.0 * p.done);
    match &cell.verdict {
        Verdict::Completed(error) => {
            let error = error.map_or("✓".to_owned(), percent);
            (COMPLETED, error.trim_start_matches('+').to_owned())
        }
        Verdict::Wrong(reasons) => {
            let reason = reasons.first().map_or("", String::as_str);
            (WRONG, shortened(reason))
        }
        Verdict::Diverged(at, _) => (DIVERGED, place(at)),
        Verdict::Stopped(at) => (STOPPED, place(at)),
        Verdict::Inapplicable(_) => (NONE, "–".to_owned()),
        Verdict::Broken(_) => (DIVERGED, "broken".to_owned()),
    }
}

/// Text that fits into a cell: the error if the reason gives one, else its first words.
fn shortened(reason: &str) -> String {
    let error = reason
        .split(", ")
        .nth(1)
        .and_then(|rest| rest.split(" of ").next())
        .filter(|error| error.ends_with('%'));
    match error {
        Some(error) => error.to_owned(),
        None => reason
            .chars()
            .take(16)
            .collect::<String>()
            .trim_end()
            .to_owned(),
    }
}
