//! `wythe check`: checks a model without running it.

use std::path::{Path, PathBuf};

use serde_json::{Value, json};
use wythe_core::deck::MOST_BYTES;
use wythe_core::error::ErrorKind;
use wythe_core::input;
use wythe_core::model::Model;
use wythe_core::results::plotting::scene;

use crate::arguments::Check;
use crate::failure::Failure;
use crate::findings::{self, Sound, Unsound};
use crate::plot::write_picture;
use crate::say::print;

/// Reads and builds the model, and prints its errors, or its warnings and sizes.
pub fn check(arguments: &Check) -> Result<(), Failure> {
    let path = &arguments.model;
    let found = findings::read(path, &arguments.with);
    let drawn = match (&arguments.picture, &found) {
        (Some(picture), Ok(sound)) => draw(&sound.model, picture, &sound.deck.inputs()),
        _ => Ok(()),
    };
    if arguments.json {
        // The JSON object is printed even if the picture fails.
        return print_json(path, found).and(drawn);
    }
    drawn?;
    let Sound {
        deck,
        model,
        warnings,
    } = found.map_err(|unsound| unsound.tell(path))?;
    let mut report = wythe_core::deck::check(&deck, &model);
    // Warnings are printed with their places in the deck instead.
    report.warnings.clear();
    let text = input::text(path, MOST_BYTES as u64).unwrap_or_default();
    let lines: Vec<&str> = text.lines().collect();
    let drawn: String = warnings
        .iter()
        .map(|w| findings::drawn(w, &lines))
        .collect();
    print(&format!("{drawn}{report}"))
}

/// Draws the model.
fn draw(model: &Model, picture: &Path, inputs: &[PathBuf]) -> Result<(), Failure> {
    write_picture(picture, scene(model), inputs)
}

/// The object of a file that cannot be read.
fn unread(file: &str, failure: &Failure) -> Value {
    let (message, help) = failure.in_words();
    let error = json!({
        "kind": ErrorKind::File.name(),
        "file": file,
        "key": "",
        "line": null,
        "column": null,
        "message": message,
        "help": help,
    });
    json!({
        "file": file,
        "ok": false,
        "layer": "file",
        "errors": [error],
        "warnings": [],
    })
}

/// Prints one JSON object, whether the model is right or wrong.
fn print_json(path: &std::path::Path, found: Result<Sound, Unsound>) -> Result<(), Failure> {
    let file = path.display().to_string();
    let (object, outcome): (Value, _) = match found {
        Err(Unsound::Unread(failure)) => {
            let object = unread(&file, &failure);
            (object, Err(failure))
        }
        Err(Unsound::Wrong(layer, error)) => {
            let errors: Vec<Value> = error.all().map(findings::error_json).collect();
            let object = json!({
                "file": file,
                "ok": false,
                "layer": layer.name(),
                "errors": errors,
                "warnings": error.warnings(),
            });
            (object, Err(Failure::ToldModel))
        }
        Ok(Sound {
            deck,
            model,
            warnings,
        }) => {
            let report = wythe_core::deck::check(&deck, &model);
            let object = json!({
                "file": file,
                "ok": true,
                "title": report.title,
                "errors": [],
                "warnings": warnings,
                "notes": report.notes,
                "sizes": report.sizes,
                "memory_MB": report.memory_mb,
                "processor_time_s": report.time_s,
            });
            (object, Ok(()))
        }
    };
    print(&format!("{object}\n"))?;
    outcome
}
