//! What is written, and the experiment that a run is compared with.
//!
//! An experiment is a CSV file: `#` comments, perhaps a line of names, then a displacement [mm] and a
//! force [kN] a line, in the order of the test. Its name is relative to the deck's folder.

use std::path::Path;

use super::Deck;
use super::rows::rows;
use crate::error::ModelError;
use crate::model::scene::{Experiment, Output};

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

    fn experiment(&self, file: &str) -> Result<Experiment, ModelError> {
        let key = "output.experiment";
        let folder = Path::new(&self.source.file).parent();
        let path = folder.unwrap_or(Path::new("")).join(file);
        let text = std::fs::read_to_string(&path).map_err(|why| {
            let message = format!("{}: {why}", path.display());
            let help = "name a CSV file, relative to the deck's folder";
            self.error(key, message, help)
        })?;
        let points = curve(&text).map_err(|(line, why)| {
            self.error(
                key,
                format!("{} line {line}: {why}", path.display()),
                "an experiment has a displacement [mm] and a force [kN] a line, such as 1.25, 48.3",
            )
        })?;
        let name = path.file_name().unwrap_or_default();
        Ok(Experiment {
            file: name.to_string_lossy().into(),
            text,
            points,
        })
    }
}

/// Points of an experiment, or the line (from 1) that is none.
fn curve(text: &str) -> Result<Vec<[f64; 2]>, (usize, String)> {
    let rows = rows(text, "not a displacement and a force")?;
    if rows.len() < 2 {
        return Err((text.lines().count(), "fewer than two rows".to_owned()));
    }
    Ok(rows.into_iter().map(|(_, point)| point).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_experiment_has_comments_names_and_points() {
        let text = "# J7D\ndisplacement_mm,force_kN\n0,0\n1.5, 48.25\n\n1.0,50\n";
        let expected = vec![[0.0, 0.0], [1.5, 48.25], [1.0, 50.0]];
        assert_eq!(curve(text), Ok(expected));
        for (text, line) in [("0,1\n0;2", 2), ("0,1\n1\n", 2), ("0,1", 1), ("", 0)] {
            assert_eq!(curve(text).unwrap_err().0, line, "{text}");
        }
    }
}
