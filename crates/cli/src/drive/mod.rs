//! `wythe drive`: one material or interface point along a prescribed path.

mod path;
mod point;
mod table;

use std::fs;
use std::path::Path as FilePath;

use miette::Diagnostic;
use nalgebra::{Matrix3, Vector3};
use wythe_contact::InterfaceLaw;
use wythe_core::error::IoError;
use wythe_core::material::MaterialHistory;
use wythe_core::model::Deck;
use wythe_core::results::summary::write_whole;

use crate::arguments::{Drive, DrivePoint, Point};
use crate::check::print;
use crate::failure::Failure;
use path::{INTERFACE, Layout, MATERIAL, Path, Row, Target};
use point::{Answer, PointFailure, State};

/// What an interface point adds to its path after its tractions.
const INTERFACE_STATE: [&str; 1] = ["D"];
/// What a material point adds to its path after its stresses.
const MATERIAL_STATE: [&str; 5] = ["kt", "kc", "dt", "dc", "d"];

/// Drives the point and writes what it answers.
pub fn drive(arguments: &Drive) -> Result<(), Failure> {
    match &arguments.point {
        Point::Material(point) => material(point),
        Point::Interface(point) => interface(point),
    }
}

fn material(arguments: &DrivePoint) -> Result<(), Failure> {
    let deck = Deck::load(&arguments.model, &arguments.with.overrides)?;
    // A point has no size: tables as given.
    let (law, warnings) = deck.law(&arguments.name, None)?;
    for warning in warnings {
        eprintln!("warning: {warning}");
    }
    let update = |strain: &_, old: &MaterialHistory, dt| {
        let response = law.update(strain, old, dt, true)?;
        Ok(Answer {
            stress: response.stress,
            tangent: response.tangent,
            history: response.history,
        })
    };
    walk(
        arguments,
        &MATERIAL,
        MaterialHistory::default(),
        update,
        &MATERIAL_STATE,
        |h| {
            vec![
                h.kappa_t,
                h.kappa_c,
                h.tensile_damage,
                h.compressive_damage,
                h.damage,
            ]
        },
    )
}

fn interface(arguments: &DrivePoint) -> Result<(), Failure> {
    let deck = Deck::load(&arguments.model, &arguments.with.overrides)?;
    let law: InterfaceLaw = deck.interface(&arguments.name)?;
    let update = |gap: &Vector3<f64>, old: &_, _dt| {
        let response = law.update((*gap).into(), old);
        let (stress, tangent): (Vector3<f64>, Matrix3<f64>) =
            (response.traction.into(), response.tangent);
        Ok(Answer {
            stress,
            tangent,
            history: response.history,
        })
    };
    walk(
        arguments,
        &INTERFACE,
        law.virgin(),
        update,
        &INTERFACE_STATE,
        |h| vec![h.damage],
    )
}

/// A point that found no answer, and where.
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

/// What became of a row, in the words of its columns.
fn reason<const N: usize>(
    failure: &PointFailure<N>,
    row: &Row<N>,
    layout: &Layout<N>,
) -> (String, &'static str) {
    let limit = match failure {
        PointFailure::Law(why) => {
            return (
                format!("the law has no answer: {why}"),
                "the rows before are written; take smaller steps (--substeps)",
            );
        }
        PointFailure::Beyond(limit) => limit,
    };
    let (mut missed, mut held) = (Vec::new(), Vec::new());
    for (i, name) in layout.stresses.iter().enumerate() {
        let Target::Stress(asked) = row.targets[i] else {
            continue;
        };
        let reached = limit.stress[i];
        if (asked - reached).abs() > 1e-9 * asked.abs().max(1.0) {
            let (asked, reached) = (short(asked), short(reached));
            missed.push(format!("{name} = {asked} asked, {reached} reached"));
        } else if asked != 0.0 {
            held.push(format!("{name} = {} held", short(asked)));
        }
    }
    missed.append(&mut held);
    let said = if missed.is_empty() {
        "all stresses held at 0".to_owned()
    } else {
        missed.join(", ")
    };
    (
        format!(
            "beyond the strength: no strain gives this stress ({said}; {:.2} % of the way through \
             the row)",
            100.0 * limit.fraction
        ),
        "the rows before are written; ask for less, or drive by strain where the point softens",
    )
}

/// Seven digits.
fn short(value: f64) -> String {
    let rounded = format!("{value:.6e}").parse::<f64>().unwrap_or(value);
    format!("{rounded:?}")
}

/// Takes the point along its path, and writes path and answers.
fn walk<const N: usize, H: Copy>(
    arguments: &DrivePoint,
    layout: &Layout<N>,
    virgin: H,
    update: impl Fn(
        &nalgebra::SVector<f64, N>,
        &H,
        f64,
    ) -> Result<Answer<N, H>, wythe_core::material::LocalFailure>,
    state_columns: &[&str],
    state_values: impl Fn(&H) -> Vec<f64>,
) -> Result<(), Failure> {
    let file = arguments.path.display().to_string();
    let text = fs::read_to_string(&arguments.path).map_err(|why| IoError {
        path: arguments.path.clone(),
        why,
    })?;
    let path = Path::read(&file, &text, layout, &arguments.stress)
        .map_err(|error| Failure::model(*error))?;
    let mut table = table::Table::new(&path, layout, state_columns);
    let mut state = State::at_rest(virgin);
    let mut failure = None;
    for (index, row) in path.rows.iter().enumerate() {
        match point::advance(&update, &state, row, arguments.substeps.get()) {
            Ok(next) => state = next,
            Err(why) => {
                let (why, help) = reason(&why, row, layout);
                failure = Some(NoAnswer {
                    file,
                    line: row.line,
                    row: index + 1,
                    why,
                    help,
                });
                break;
            }
        }
        table.push(&path, index, &state, &state_values(&state.history));
    }
    let text = table.finish();
    match &arguments.out {
        Some(out) => write(out, &text)?,
        None => print(&text)?,
    }
    failure.map_or(Ok(()), |failure| {
        Err(Failure::NotConverged(miette::Report::new(failure)))
    })
}

fn write(out: &FilePath, text: &str) -> Result<(), Failure> {
    write_whole(out, text.as_bytes()).map_err(|why| {
        IoError {
            path: out.to_owned(),
            why,
        }
        .into()
    })
}
