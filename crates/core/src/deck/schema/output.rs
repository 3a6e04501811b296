//! What is written, and the experiment that a run is compared with.
//!
//! The name of its file is relative to the deck's folder.

use super::Deck;
use crate::error::ModelError;
use crate::experiment::{Experiment, ExperimentError};
use crate::input;
use crate::model::scene::{MeasuredCurve, Output};

impl Deck {
    /// What `[output]` says, the experiment read.
    ///
    /// # Errors
    /// The experiment cannot be read, or is none: the key, the file, its line and what is wrong.
    pub fn output(&self) -> Result<Output, ModelError> {
        let of = &self.output;
        Ok(Output {
            every: of.every,
            mcap: of.mcap,
            scene_every: of.scene_every,
            experiment: match &of.experiment {
                Some(file) => Some(self.experiment(file)?),
                None => None,
            },
        })
    }

    fn experiment(&self, file: &str) -> Result<MeasuredCurve, ModelError> {
        let key = "output.experiment";
        let path = self.folder().join(file);
        let text = input::text(&path, input::MOST_OF_TABLE).map_err(|why| {
            let message = format!("{}: {why}", path.display());
            let help = "name a CSV file, relative to the deck's folder";
            self.error(key, message, help)
        })?;
        let curve = Experiment::of_text(&path, &text).map_err(|error| {
            let help = match &error {
                ExperimentError::Content { help, .. } => help.as_str(),
                ExperimentError::Read { .. } => "",
            };
            self.error(key, error.to_string(), help)
        })?;
        let name = path.file_name().unwrap_or_default();
        Ok(MeasuredCurve {
            file: name.to_string_lossy().into(),
            text,
            curve,
        })
    }
}
