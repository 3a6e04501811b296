//! Differences between a curve and the reference curve.

use crate::study::curve::Point;

/// Number of intervals of a comparison, equal in x. Both curves are sampled there; coarse curves are interpolated
/// linearly.
const INTERVALS: usize = 2000;

/// Part of the range by which a run may miss its end or move backwards, which the tolerance of equilibrium allows
/// [-].
pub(super) const SLACK: f64 = 1e-6;

/// Reference curve over a range.
#[derive(Clone, Debug)]
pub struct Known {
    range: [f64; 2],
    /// Ordinates at equal distances over the range. `[INTERVALS + 1]`
    samples: Vec<f64>,
    /// Largest ordinate.
    peak: f64,
}

/// Errors of a run relative to the reference [-].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Error of the largest ordinate.
    pub peak: f64,
    /// Error of the area under the curve, up to the end of the range.
    pub energy: f64,
    /// Root mean square of the difference over the peak of the reference.
    pub rms: f64,
}

impl Errors {
    /// The larger of the errors of peak and energy, by magnitude, which the chart shows. The root mean square is
    /// listed beside it: it depends on the displacement at which a force drops, which says little about the
    /// load-bearing capacity.
    pub fn of_chart(&self) -> f64 {
        self.peak.abs().max(self.energy.abs())
    }
}

impl Known {
    /// Reference between two abscissae. `peak` is the exact peak, if known better than from the points of the
    /// curve.
    ///
    /// # Errors
    /// In words: the curve turns back, ends before the range does, or is nowhere above zero.
    pub fn new(curve: &[Point], range: [f64; 2], peak: Option<f64>) -> Result<Self, String> {
        let curve = advancing(curve, range)?;
        let last = curve.last().map_or(0.0, |p| p[0]);
        // A probe may have moved backwards by this distance at the start.
        let first = curve[0][0] - SLACK * (range[1] - range[0]);
        if range[0] < first || last < reached(range) {
            return Err(format!(
                "the reference goes from {} to {last}, the comparison from {} to {}",
                curve[0][0], range[0], range[1]
            ));
        }
        let samples = samples(&curve, range);
        let largest = largest(&curve, &samples, range);
        if largest <= 0.0 || largest.is_nan() {
            return Err("the reference is nowhere above zero".to_owned());
        }
        Ok(Self {
            range,
            samples,
            peak: peak.unwrap_or(largest),
        })
    }

    /// Largest ordinate.
    pub fn peak(&self) -> f64 {
        self.peak
    }

    /// Area under the curve over the range.
    pub fn energy(&self) -> f64 {
        area(&self.samples, self.range)
    }

    /// Errors of a curve, which starts at its first point.
    ///
    /// # Errors
    /// In words: the curve turns back, or does not reach the end of the range.
    pub fn errors(&self, curve: &[Point]) -> Result<Errors, String> {
        let curve = advancing(curve, self.range)?;
        let last = curve.last().map_or(0.0, |p| p[0]);
        if last < reached(self.range) {
            return Err(format!("ends at {last:.4} of {}", self.range[1]));
        }
        let run = samples(&curve, self.range);
        let squares: Vec<f64> = run
            .iter()
            .zip(&self.samples)
            .map(|(a, b)| (a - b).powi(2))
            .collect();
        let mean = area(&squares, self.range) / (self.range[1] - self.range[0]);
        Ok(Errors {
            peak: largest(&curve, &run, self.range) / self.peak - 1.0,
            energy: area(&run, self.range) / self.energy() - 1.0,
            rms: mean.sqrt() / self.peak,
        })
    }
}

fn reached([from, to]: [f64; 2]) -> f64 {
    to - SLACK * (to - from)
}

/// Points in order. Of several points at one abscissa the last is kept, as for the rows of a preload.
fn advancing(curve: &[Point], [from, to]: [f64; 2]) -> Result<Vec<Point>, String> {
    let mut points: Vec<Point> = Vec::new();
    for point in curve {
        if !point.iter().all(|v| v.is_finite()) {
            return Err("has a point that is not finite".to_owned());
        }
        match points.last_mut() {
            Some(last) if point[0] == last[0] => *last = *point,
            // At rest a probe may move about zero within the tolerance of equilibrium.
            Some(last) if point[0] < last[0] && last[0] - point[0] <= SLACK * (to - from) => {
                last[1] = point[1];
            }
            Some(last) if point[0] < last[0] => {
                return Err(format!("turns back from {:.4} to {:.4}", last[0], point[0]));
            }
            _ => points.push(*point),
        }
    }
    if points.len() < 2 {
        return Err("has fewer than two points".to_owned());
    }
    Ok(points)
}

/// Largest ordinate of the points up to the end of the range, including the interpolated end.
fn largest(curve: &[Point], samples: &[f64], range: [f64; 2]) -> f64 {
    let within = curve.iter().filter(|p| p[0] <= range[1]).map(|p| p[1]);
    within
        .chain(samples.last().copied())
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Ordinates at equal distances, by linear interpolation.
fn samples(curve: &[Point], [from, to]: [f64; 2]) -> Vec<f64> {
    let mut after = 1;
    let at = |i: usize| {
        let x = from + (to - from) * i as f64 / INTERVALS as f64;
        while after + 1 < curve.len() && curve[after][0] < x {
            after += 1;
        }
        let ([x0, y0], [x1, y1]) = (curve[after - 1], curve[after]);
        y0 + ((x - x0) / (x1 - x0)).clamp(0.0, 1.0) * (y1 - y0)
    };
    (0..=INTERVALS).map(at).collect()
}

/// Area by the trapezoidal rule.
fn area(samples: &[f64], [from, to]: [f64; 2]) -> f64 {
    let ends = 0.5 * (samples[0] + samples[samples.len() - 1]);
    (samples.iter().sum::<f64>() - ends) * (to - from) / INTERVALS as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    const RAMP: [Point; 3] = [[0.0, 0.0], [1.0, 10.0], [2.0, 0.0]];

    fn known(range: [f64; 2]) -> Known {
        Known::new(&RAMP, range, None).unwrap()
    }

    #[test]
    fn a_curve_has_no_error_against_itself_and_others_have_theirs() {
        let errors = known([0.0, 2.0]).errors(&RAMP).unwrap();
        // Both curves are sampled at the same abscissae.
        assert_eq!(
            errors,
            Errors {
                peak: 0.0,
                energy: 0.0,
                rms: 0.0
            }
        );
        let scaled = RAMP.map(|[x, y]| [x, 1.1 * y]);
        let errors = known([0.0, 2.0]).errors(&scaled).unwrap();
        // Tolerances: rounding; and for the mean square of a ramp (1/3) the error 1/(6 · 1000²) of the trapezoidal
        // rule on each side.
        assert!((errors.peak - 0.1).abs() < 1e-12 && (errors.energy - 0.1).abs() < 1e-12);
        assert!(
            (errors.rms - 0.1 / 3.0_f64.sqrt()).abs() < 1e-7,
            "{errors:?}"
        );
        assert_eq!(errors.of_chart(), errors.peak.max(errors.energy));
        // The peak of the reference lies between two points of a coarse run.
        let coarse = [[0.0, 0.0], [0.8, 8.0], [1.6, 4.0], [2.0, 0.0]];
        let errors = known([0.0, 2.0]).errors(&coarse).unwrap();
        assert!((errors.peak + 0.2).abs() < 1e-12, "{errors:?}");
        assert!(
            (errors.energy - (8.8 / 10.0 - 1.0)).abs() < 1e-5,
            "{errors:?}"
        );
    }

    #[test]
    fn the_range_and_the_closed_form_count() {
        let first = known([0.0, 0.5]);
        assert_eq!((first.peak(), first.energy()), (10.0_f64 * 0.5, 1.25));
        let peak = Known::new(&RAMP, [0.0, 2.0], Some(12.5)).unwrap();
        assert!((peak.errors(&RAMP).unwrap().peak + 0.2).abs() < 1e-15);
    }

    #[test]
    fn what_cannot_be_compared_says_why() {
        let known = known([0.0, 2.0]);
        let why = |curve: &[Point]| known.errors(curve).unwrap_err();
        assert!(why(&RAMP[..2]).contains("ends at 1.0000 of 2"));
        assert!(why(&[[0.0, 0.0], [1.0, 1.0], [0.5, 1.0]]).contains("turns back"));
        assert!(why(&[[0.0, 0.0], [1.0, f64::NAN]]).contains("not finite"));
        assert!(why(&[[0.0, 0.0], [0.0, 1.0]]).contains("fewer than two"));
        let beyond = Known::new(&RAMP, [0.0, 3.0], None).unwrap_err();
        assert!(beyond.contains("from 0 to 2"), "{beyond}");
        assert!(Known::new(&[[0.0, 0.0], [1.0, 0.0]], [0.0, 1.0], None).is_err());
        // A point that moves backwards by less than the slack counts at the abscissa before it.
        let swung = [&[[0.0, 0.0], [1e-7, 0.0], [-1e-7, 0.0]][..], &RAMP[1..]].concat();
        assert!(known.errors(&swung).unwrap().energy.abs() < 1e-6);
        assert!(why(&[[0.0, 0.0], [1e-3, 0.0], [0.0, 0.0], [2.0, 0.0]]).contains("turns back"));
        // Of the rows of a preload, all at one abscissa, the last counts.
        let rows = [&[[0.0, 5.0], [0.0, 0.0]][..], &RAMP[1..]].concat();
        assert_eq!(known.errors(&rows).unwrap().energy, 0.0);
    }
}
