//! Ground motion: files of times and accelerations, one for each direction.
//!
//! A record is a CSV file: `#` comments, an optional line of column names, then a time [s] and an acceleration per
//! line, with ascending times. `ground_unit` of the step is the unit of the accelerations, `ground_factor`
//! multiplies them, and the step begins at the time `ground_start` of the record. File names are relative to the
//! folder of the deck.

use super::Deck;
use super::rows::rows;
use crate::deck::quantity::{Acceleration, Number, Time};
use crate::error::ModelError;
use crate::model::scene::GroundMotion;

impl Deck {
    /// Reads the records of a step.
    ///
    /// # Errors
    /// A file that cannot be read or is no record: key, file, line and reason.
    pub fn ground_motion(&self, step: usize) -> Result<GroundMotion, ModelError> {
        let mut motion = GroundMotion::default();
        let of = &self.steps[step];
        let Some(ground) = &of.ground else {
            return Ok(motion);
        };
        let unit = of.ground_unit.map_or(1.0, Acceleration::get);
        let factor = of.ground_factor.unwrap_or_default();
        let factors = [factor.x, factor.y, factor.z].map(Number::get);
        let begin = of.ground_start.map_or(0.0, Time::get);
        for (i, file) in ground.files().into_iter().enumerate() {
            let Some(file) = file else { continue };
            let key = format!("steps.{step}.ground.{}", ["x", "y", "z"][i]);
            let (path, text) = self.table(&key, file)?;
            motion.acceleration[i] = record(&text, unit * factors[i]).map_err(|(line, why)| {
                self.error(
                    &key,
                    format!("{} line {line}: {why}", path.display()),
                    "a record has a time [s] and an acceleration a line, such as 0.02, 0.113",
                )
            })?;
            for row in &mut motion.acceleration[i] {
                row[0] -= begin;
            }
        }
        Ok(motion)
    }
}

/// Rows of a record, or the first invalid line (from 1) and the reason.
fn record(text: &str, unit: f64) -> Result<Vec<[f64; 2]>, (usize, String)> {
    let rows = rows(text, "not a time and an acceleration")?;
    if let Some(pair) = rows.windows(2).find(|pair| pair[1].1[0] <= pair[0].1[0]) {
        let (line, [time, _]) = pair[1];
        return Err((line, format!("the time {time} s does not ascend")));
    }
    if rows.len() < 2 {
        return Err((text.lines().count(), "fewer than two rows".to_owned()));
    }
    let scaled = rows.into_iter().map(|(_, [time, a])| [time, unit * a]);
    Ok(scaled.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_record_has_comments_names_and_rows() {
        let text = "# station\ntime_s,a_g\n0,0\n0.01, 0.5\n\n0.02,-1\n";
        let expected = vec![[0.0, 0.0], [0.01, 4905.0], [0.02, -9810.0]];
        assert_eq!(record(text, 9810.0), Ok(expected));
        for (text, line) in [
            ("0,1\n0,2", 2),
            ("0,1\nx,2\n1,2", 2),
            ("0,1\n1\n", 2),
            ("t,a\nt,a\n0,1\n1,1", 2),
            ("0,1\n1,nan", 2),
            ("0,1", 1),
            ("", 0),
        ] {
            assert_eq!(record(text, 1.0).unwrap_err().0, line, "{text}");
        }
    }
}
