//! One side of a load-displacement curve as a single-valued function, for comparison.
//!
//! ```text
//! force ▲        ╭──────╮ ← envelope        A curve with returns, as that of a cyclic test, has several
//!       │    ╭───╯╱╱ ╱╱ ╰───╮               forces at one displacement. The branch takes the largest.
//!       │ ╭──╯ ╱ ╱ ╱ ╱   ╱  │
//!       └─╯──╱─╱───╱──╱────╱──▶ displacement
//! ```

use crate::experiment::Point;

/// A curve as a function of the displacement, which never decreases. Both quantities are positive along the chosen
/// side, so that push and pull are treated alike.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Branch {
    points: Vec<Point>,
}

/// Fraction of its range by which a monotonic curve may step back: digitised curves do so.
const BACK: f64 = 0.02;
/// Number of intervals of an envelope.
const INTERVALS: usize = 400;

/// Whether a curve returns, as that of a cyclic test does.
pub fn returns(points: &[Point]) -> bool {
    let (low, high) = range(points);
    let allowed = BACK * (high - low);
    let goes_back = |sign: f64| {
        let mut furthest = f64::NEG_INFINITY;
        points.iter().any(|p| {
            furthest = furthest.max(sign * p.0);
            sign * p.0 < furthest - allowed
        })
    };
    goes_back(1.0) && goes_back(-1.0)
}

/// Smallest and largest displacement [mm].
fn range(points: &[Point]) -> (f64, f64) {
    let start = (f64::INFINITY, f64::NEG_INFINITY);
    let wider = |(low, high): (f64, f64), p: &Point| (low.min(p.0), high.max(p.0));
    points.iter().fold(start, wider)
}

/// The side on which a curve extends farther: 1 or −1.
pub fn side(points: &[Point]) -> f64 {
    let (low, high) = range(points);
    if high.abs() >= low.abs() { 1.0 } else { -1.0 }
}

impl Branch {
    /// The part of a curve on one side (1 or −1) of zero.
    pub fn new(points: &[Point], side: f64) -> Self {
        let turned: Vec<Point> = points.iter().map(|p| (side * p.0, side * p.1)).collect();
        if returns(points) {
            return Self {
                points: envelope(&turned),
            };
        }
        // Points before the first motion are preload, as in a history.
        let resting = turned.iter().take_while(|p| p.0 == turned[0].0).count();
        let mut furthest = f64::NEG_INFINITY;
        let moving = turned.into_iter().skip(resting.saturating_sub(1));
        let onwards = moving.map(|(d, f)| {
            furthest = furthest.max(d);
            (furthest, f)
        });
        Self {
            points: onwards.collect(),
        }
    }

    /// The branch on the given side, as by [`Branch::new`], or the mirrored one if the curve lies on the other side
    /// only. The flag is true if it is mirrored.
    pub fn towards(points: &[Point], side: f64) -> (Self, bool) {
        let (low, high) = range(points);
        let (here, there) = if side > 0.0 {
            (high, -low)
        } else {
            (-low, high)
        };
        let mirrored = here < BACK * there;
        (
            Self::new(points, if mirrored { -side } else { side }),
            mirrored,
        )
    }

    /// Points with ascending displacements [mm, kN].
    pub fn points(&self) -> &[Point] {
        &self.points
    }

    /// First and last displacement [mm]; `None` for an empty branch.
    pub fn range(&self) -> Option<(f64, f64)> {
        Some((self.points.first()?.0, self.points.last()?.0))
    }

    /// Force just after a displacement (`after`) or just before it [kN]; `None` outside the range.
    pub fn force(&self, at: f64, after: bool) -> Option<f64> {
        let points = &self.points;
        let i = points.partition_point(|p| if after { p.0 <= at } else { p.0 < at });
        match (i.checked_sub(1).map(|k| points[k]), points.get(i)) {
            (Some(a), Some(&b)) => Some(a.1 + (b.1 - a.1) * (at - a.0) / (b.0 - a.0)),
            // The ends have one side only.
            (Some(last), None) if last.0 == at => Some(last.1),
            (None, Some(first)) if first.0 == at => Some(first.1),
            _ => None,
        }
    }
}

/// Largest force of all passages at equidistant displacements.
fn envelope(points: &[Point]) -> Vec<Point> {
    let end = points.iter().map(|p| p.0).fold(0.0, f64::max);
    let start = points.first().map_or(0.0, |p| p.0).max(0.0).min(end);
    let width = (end - start) / INTERVALS as f64;
    if width <= 0.0 {
        return Vec::new();
    }
    let place = |i: usize| {
        if i == INTERVALS {
            end
        } else {
            start + width * i as f64
        }
    };
    let mut most = vec![f64::NEG_INFINITY; INTERVALS + 1];
    for pair in points.windows(2) {
        let (a, b) = if pair[0].0 <= pair[1].0 {
            (pair[0], pair[1])
        } else {
            (pair[1], pair[0])
        };
        let first = ((a.0 - start) / width).ceil().max(0.0) as usize;
        for i in first..=INTERVALS {
            let d = place(i);
            if d > b.0 {
                break;
            }
            if d < a.0 {
                continue;
            }
            let force = if b.0 == a.0 {
                a.1.max(b.1)
            } else {
                a.1 + (b.1 - a.1) * (d - a.0) / (b.0 - a.0)
            };
            most[i] = most[i].max(force);
        }
    }
    (0..=INTERVALS)
        .filter(|&i| most[i].is_finite())
        .map(|i| (place(i), most[i]))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn a_monotonic_curve_changes_only_by_its_jitter() {
        let curve = [(0.0, 0.0), (1.0, 10.0), (0.99, 10.5), (2.0, 8.0)];
        assert!(!returns(&curve));
        let branch = Branch::new(&curve, 1.0);
        assert_eq!(
            branch.points(),
            [(0.0, 0.0), (1.0, 10.0), (1.0, 10.5), (2.0, 8.0)]
        );
        assert_eq!(branch.force(1.0, false), Some(10.0));
        assert_eq!(branch.force(1.0, true), Some(10.5));
        assert_eq!(branch.force(0.5, true), Some(5.0));
        assert_eq!(branch.force(2.0, true), Some(8.0));
        assert_eq!(branch.force(2.1, true), None);
    }

    #[test]
    fn a_preload_is_no_part_of_the_curve() {
        let history = [(0.0, -0.1), (0.0, -0.6), (1.0, 10.0), (1.0, 9.0)];
        let branch = Branch::new(&history, 1.0);
        assert_eq!(branch.points(), &history[1..]);
        assert_eq!(Branch::new(&[], 1.0).points(), []);
        assert_eq!(Branch::new(&[(0.0, 1.0)], 1.0).points(), [(0.0, 1.0)]);
    }

    #[test]
    fn a_cyclic_curve_has_an_envelope_on_each_side() {
        // To 1 and back, to −1 and back, to 2 with a lower force on the way, then up to 12.
        let curve = [
            (0.0, 0.0),
            (1.0, 10.0),
            (0.2, 0.0),
            (-1.0, -8.0),
            (-0.1, 0.0),
            (1.0, 7.0),
            (2.0, 12.0),
        ];
        assert!(returns(&curve));
        let right = Branch::new(&curve, 1.0);
        assert_relative_eq!(right.force(0.5, true).unwrap(), 5.0, epsilon = 1e-12);
        assert_relative_eq!(right.force(2.0, false).unwrap(), 12.0, epsilon = 1e-12);
        let left = Branch::new(&curve, -1.0);
        assert_eq!(left.range(), Some((0.0, 1.0)));
        assert_relative_eq!(left.force(1.0, false).unwrap(), 8.0, epsilon = 1e-12);
    }

    #[test]
    fn a_curve_of_the_other_side_is_mirrored() {
        let pulled = [(0.0, 0.0), (-1.0, -10.0)];
        assert_eq!(side(&pulled), -1.0);
        let (branch, mirrored) = Branch::towards(&pulled, 1.0);
        assert!(mirrored);
        assert_eq!(branch.points(), [(0.0, 0.0), (1.0, 10.0)]);
        assert!(!Branch::towards(&pulled, -1.0).1);
    }
}
