//! Errors and warnings of a model: all of them at once, as text or as JSON.

use std::fmt::Write as _;
use std::path::Path;

use miette::Report;
use serde_json::{Value, json};
use wythe_core::deck::{Deck, MOST_BYTES};
use wythe_core::error::{DeckError, ModelError, Warning};
use wythe_core::input;
use wythe_core::model::Model;

use crate::arguments::ModelArguments;
use crate::failure::Failure;
use crate::say::{self, tell};

/// A deck that could be read, with the model built from it.
pub struct Sound {
    pub deck: Deck,
    pub model: Model,
    pub warnings: Vec<Warning>,
}

/// Layers of a check: physics is checked only if the form is right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Layer {
    /// Keys, types, units, ranges, names.
    Form,
    /// Behaviour of the model that the deck describes.
    Physics,
}

impl Layer {
    /// Name of the layer in the output.
    pub fn name(self) -> &'static str {
        match self {
            Self::Form => "form",
            Self::Physics => "physics",
        }
    }
}

/// Reason why there is no model.
pub enum Unsound {
    /// The file could not be read.
    Unread(Failure),
    /// The model is wrong, in this layer.
    Wrong(Layer, ModelError),
}

/// Reads a deck and builds its model.
pub fn read(path: &Path, with: &ModelArguments) -> Result<Sound, Unsound> {
    let deck = Deck::load(path, &with.overrides()).map_err(|error| match error {
        DeckError::Io(error) => Unsound::Unread(error.into()),
        DeckError::Model(error) => Unsound::Wrong(Layer::Form, error),
    })?;
    let (model, warnings) =
        Model::from_deck(&deck).map_err(|error| Unsound::Wrong(Layer::Physics, error))?;
    Ok(Sound {
        deck,
        model,
        warnings,
    })
}

impl Unsound {
    /// Prints the errors on standard error, each with its place. Returns the failure of the command.
    pub fn tell(self, path: &Path) -> Failure {
        let (layer, error) = match self {
            Self::Unread(failure) => return failure,
            Self::Wrong(layer, error) => (layer, error),
        };
        let text = input::text(path, MOST_BYTES as u64).unwrap_or_default();
        let lines: Vec<&str> = text.lines().collect();
        for warning in error.warnings() {
            say::text(&drawn(warning, &lines));
        }
        for error in error.all() {
            tell!("{:?}", Report::new(error.alone()));
        }
        let count = crate::terminal::count(error.all().count(), "error");
        let rest = match layer {
            Layer::Form => "; the physics is judged when the form is right",
            Layer::Physics => "",
        };
        tell!("{count} of {} in {}{rest}", layer.name(), path.display());
        Failure::ToldModel
    }
}

/// Text of a warning, with the line of the deck and a caret below its place.
pub fn drawn(warning: &Warning, lines: &[&str]) -> String {
    let mut out = format!("warning: {warning}\n");
    let (Some(line), Some(column)) = (warning.line, warning.column) else {
        return out;
    };
    if let Some(written) = lines.get(line - 1) {
        let gutter = line.to_string().len();
        let before = written.chars().take(column - 1);
        let indent: String = before.map(|c| if c == '\t' { '\t' } else { ' ' }).collect();
        // Writing to a string does not fail.
        let _ = writeln!(out, "  {line} | {written}\n  {:gutter$} | {indent}^", "");
    }
    out
}

/// JSON object of an error.
pub fn error_json(error: &ModelError) -> Value {
    json!({
        "kind": error.kind().name(),
        "file": error.file(),
        "key": error.key(),
        "line": error.line(),
        "column": error.column(),
        "message": error.message(),
        "help": error.advice(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warning_points_at_its_place() {
        let warning = Warning {
            key: "materials.brick.nu".to_owned(),
            line: Some(2),
            column: Some(6),
            message: "high".to_owned(),
            others: 0,
        };
        assert_eq!(
            drawn(&warning, &["[materials.brick]", "nu = 0.49"]),
            "warning: materials.brick.nu (line 2): high\n  2 | nu = 0.49\n    |      ^\n"
        );
        let nowhere = Warning {
            line: None,
            column: None,
            ..warning
        };
        assert_eq!(drawn(&nowhere, &[]), "warning: materials.brick.nu: high\n");
    }
}
