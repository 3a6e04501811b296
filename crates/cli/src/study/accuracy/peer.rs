//! Curves of other programs for the same scene. They are read from a file; the study does not run these programs.

use std::path::PathBuf;

use super::errors::{Errors, Known};
use crate::study::curve::Point;

/// Another program on the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Peer {
    /// Name in tables and charts.
    pub name: String,
    /// Differences of its model.
    pub differs: String,
    /// File of its curve.
    pub file: PathBuf,
    /// Curve in the units of the scene's columns. `[point][x, y]`
    pub curve: Vec<Point>,
    /// CPU time up to the end of the comparison [s].
    pub cpu: f64,
    /// CPU time of the scene's default, measured on the same occasion [s].
    pub default_cpu: f64,
}

impl Peer {
    /// CPU time over that of the default.
    pub fn ratio(&self) -> f64 {
        self.cpu / self.default_cpu
    }

    /// Largest ordinate.
    pub fn peak(&self) -> f64 {
        self.curve.iter().map(|p| p[1]).fold(f64::NAN, f64::max)
    }

    /// Errors against the reference of the scene.
    ///
    /// # Errors
    /// In words: the curve turns back, or does not reach the end of the range.
    pub fn errors(&self, known: &Known) -> Result<Errors, String> {
        known.errors(&self.curve)
    }
}

/// Time at the first point that reaches `to` [s]. `spent`: `[point][x, seconds]`
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
