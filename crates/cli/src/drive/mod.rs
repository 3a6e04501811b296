//! `wythe drive`: drives one material or interface point along a prescribed path.

mod path;
mod table;

use std::path::PathBuf;

use miette::Diagnostic;
use wythe_core::deck::Deck;
use wythe_core::error::IoError;
use wythe_core::input;
use wythe_core::point::{self, Layout, PointFailure, Row, Walk};

use crate::arguments::{Drive, DrivePoint, Point};
use crate::failure::Failure;
use crate::plot::write_answer;
use crate::say::print;
use crate::say::tell;
use path::Path;

/// Drives the point and writes its response.
pub fn drive(arguments: &Drive) -> Result<(), Failure> {
    match &arguments.point {
        Point::Material(point) => material(point),
        Point::Interface(point) => interface(point),
    }
}

fn material(arguments: &DrivePoint) -> Result<(), Failure> {
    let deck = Deck::load(&arguments.model, &arguments.with.overrides())?;
    // A point has no size, so tables are taken as given.
    let (law, warnings) = deck.law(&arguments.name, None)?;
    for warning in warnings {
        tell!("warning: {warning}");
    }
    let follow = |rows: &[Row<6>]| point::material_path(&law, rows, arguments.substeps);
    walk(
        arguments,
        &point::material_layout(law.law()),
        follow,
        |history| point::material_outputs(law.law(), history),
        deck.inputs(),
    )
}

fn interface(arguments: &DrivePoint) -> Result<(), Failure> {
    let deck = Deck::load(&arguments.model, &arguments.with.overrides())?;
    let law = deck.interface(&arguments.name)?;
    let follow = |rows: &[Row<3>]| point::interface_path(&law, rows, arguments.substeps);
    walk(
        arguments,
        &point::interface_layout(&law),
        follow,
        |history| point::interface_outputs(&law, history),
        deck.inputs(),
    )
}

/// Failure of a point, with its place in the path.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[error("{file}:{line} (row {row}): {why}")]
struct NoAnswer {
    file: String,
    line: u64,
    row: usize,
    why: String,
    #[help]
    help: &'static str,
}

/// Advice for a failure.
fn help<const N: usize>(failure: &PointFailure<N>) -> &'static str {
    match failure {
        PointFailure::Beyond(_) => {
            "the rows before are written; ask for less, or drive by strain where the point softens"
        }
        // Numbers and times were checked when the path was read.
        _ => "the rows before are written; take smaller steps (--substeps)",
    }
}

/// Drives the point along its path, and writes the path and the response.
fn walk<const N: usize, H>(
    arguments: &DrivePoint,
    layout: &Layout<N>,
    follow: impl FnOnce(&[Row<N>]) -> Walk<N, H>,
    state: impl Fn(&H) -> Vec<f64>,
    mut inputs: Vec<PathBuf>,
) -> Result<(), Failure> {
    inputs.push(arguments.path.clone());
    let file = arguments.path.display().to_string();
    let text = input::text(&arguments.path, input::MOST_OF_TABLE).map_err(|why| IoError {
        path: arguments.path.clone(),
        why,
    })?;
    let path = Path::read(&file, &text, layout, &arguments.stress)
        .map_err(|error| Failure::model(*error))?;
    let Walk { records, failure } = follow(&path.rows);
    let mut table = table::Table::new(&path, layout);
    for (index, record) in records.iter().enumerate() {
        table.push(&path, index, &record.state, &state(&record.state.history));
    }
    let text = table.finish();
    match &arguments.out {
        Some(out) => write_answer(out, text.as_bytes(), &inputs)?,
        None => print(&text)?,
    }
    let Some(failure) = failure else {
        return Ok(());
    };
    Err(Failure::NotConverged(miette::Report::new(NoAnswer {
        file,
        line: path.lines[failure.row],
        row: failure.row + 1,
        why: failure.why.explain(&path.rows[failure.row], layout),
        help: help(&failure.why),
    })))
}
