//! Reads the tables that a study has written.

use std::path::Path;

use super::errors::Errors;
use super::outcome::{Outcome, Studied};
use super::scene::Scene;
use crate::study::cell::Cost;
use wythe_core::error::IoError;

/// A scene with the results of its full form from a table of the study. Repeated times are stored as medians.
/// Choices that the table does not contain are missing; rows of unknown choices are ignored.
///
/// # Errors
/// The file cannot be read, or is not a table of the study.
pub fn read(scene: &Scene, file: &Path) -> Result<Studied, IoError> {
    let failed = |why: std::io::Error| IoError {
        path: file.to_owned(),
        why,
    };
    let text = std::fs::read_to_string(file).map_err(failed)?;
    parsed(scene, &text).map_err(|why| failed(std::io::Error::other(why)))
}

fn parsed(scene: &Scene, text: &str) -> Result<Studied, String> {
    let first = text.lines().next().and_then(|l| l.strip_prefix("# "));
    let sitting = first.ok_or("does not begin with how the times were taken")?;
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_reader(text.as_bytes());
    let header = reader.headers().map_err(|e| e.to_string())?.clone();
    let place = |name: &str| {
        let place = header.iter().position(|h| h == name);
        place.ok_or(format!("has no column `{name}`"))
    };
    let mut outcomes = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| e.to_string())?;
        let field = |name: &str| Ok::<_, String>(record.get(place(name)?).unwrap_or_default());
        // Older tables have no column of cracks.
        let cracks = record.get(place("cracks").unwrap_or(usize::MAX));
        let number = |name: &str| {
            let field = field(name)?;
            let number = field.parse::<f64>();
            number.map_err(|_| format!("`{field}` of `{name}` is no number"))
        };
        let name = field("choice")?;
        let Some(choice) = scene.choices.iter().find(|c| c.name == name) else {
            continue;
        };
        let errors = match field("why")? {
            "" => Ok(Errors {
                peak: number("peak_error")?,
                energy: number("energy_error")?,
                rms: number("rms")?,
            }),
            why => Err(why.to_owned()),
        };
        outcomes.push(Outcome {
            choice: choice.clone(),
            errors,
            cracks: cracks
                .and_then(|c| c.parse().ok())
                .filter(|c: &f64| c.is_finite()),
            peak: number("peak")?,
            cost: Cost {
                increments: number("increments")? as usize,
                iterations: number("solves")? as usize,
                cutbacks: number("cuts")? as usize,
                seconds: number("cpu_s")?,
            },
            energy: number("energy_imbalance")?,
            cpu: vec![number("cpu_s")?],
            wall: vec![number("wall_s")?],
        });
    }
    Ok(Studied {
        scene: scene.clone(),
        short: false,
        outcomes,
        sitting: sitting.to_owned(),
    })
}
