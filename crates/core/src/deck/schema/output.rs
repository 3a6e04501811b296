//! Output of a run, and the experiment with which it is compared.
//!
//! The name of the experiment's file is relative to the folder of the deck.

use super::Deck;
use crate::error::ModelError;
use crate::experiment::{Experiment, ExperimentError};
use crate::model::scene::{MeasuredCurve, Output};

impl Deck {
    /// Reads `[output]`, including the file of the experiment.
    ///
    /// # Errors
    /// A file of the experiment that cannot be read or has another format: key, file, line and reason.
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
        let (path, text) = self.table(key, file)?;
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
