//! Other programs on the same scene: their curves come from a file, nothing runs them.

use std::path::PathBuf;

use super::errors::{Errors, Known};
use crate::study::curve::Point;

/// Another program on the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Peer {
    /// Name in tables and charts.
    pub name: String,
    /// What differs in its model.
    pub differs: String,
    /// The file of its curve.
    pub file: PathBuf,
    /// In units of the scene's columns. `[point][x, y]`
    pub curve: Vec<Point>,
    /// Its CPU time to the end of the comparison [s].
    pub cpu: f64,
    /// That of the scene's default in the same sitting [s].
    pub default_cpu: f64,
}

impl Peer {
    /// Its CPU time over that of the default.
    pub fn ratio(&self) -> f64 {
        self.cpu / self.default_cpu
    }

    /// Its largest ordinate.
    pub fn peak(&self) -> f64 {
        self.curve.iter().map(|p| p[1]).fold(f64::NAN, f64::max)
    }

    /// Its errors against the reference of the scene.
    ///
    /// # Errors
    /// In words: its curve turns back, or does not come to the end of the range.
    pub fn errors(&self, known: &Known) -> Result<Errors, String> {
        known.errors(&self.curve)
    }
}

/// The seconds at the first point that has come to `to`. `spent`: `[point][x, seconds]`
pub fn spent_to(spent: &[Point], to: f64) -> Option<f64> {
    let there = |p: &&Point| p[0] >= to * (1.0 - 1e-9);
    spent.iter().find(there).map(|p| p[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_of_a_peer_is_that_to_the_end_of_the_comparison() {
        let spent = [[0.0, 2.0], [1.0, 5.0], [2.0, 9.0], [3.0, 14.0]];
        assert_eq!(spent_to(&spent, 2.0), Some(9.0));
        assert_eq!(spent_to(&spent, 1.5), Some(9.0));
        assert_eq!(spent_to(&spent, 3.1), None);
    }
}
