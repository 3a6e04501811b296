//! The figures of a curve whose error is estimated, and their differences between two curves.

use serde::{Deserialize, Serialize};

use super::super::Curve;
use super::super::branch::{Branch, returns};
use crate::experiment::Point;

/// Figures of a load-displacement curve.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[allow(non_snake_case)]
pub struct Figures {
    /// Largest force along the motion [kN], see [`Curve::peak`].
    pub peak_force_kN: f64,
    /// Area under the curve from the start of the drive to its end [J].
    pub area_J: f64,
    /// Displacement at the largest force [mm].
    pub displacement_at_peak_mm: f64,
}

impl Figures {
    /// The figures of a curve; `None` if nothing moved.
    pub fn of(curve: &Curve) -> Option<Self> {
        let peak = curve.peak()?;
        Some(Self {
            peak_force_kN: peak.force,
            area_J: area(&points(curve)),
            displacement_at_peak_mm: peak.displacement,
        })
    }

    /// Differences from the figures of another discretisation of the same model, as magnitudes: force [kN], area [J],
    /// displacement [mm]. `None` if nothing moved in one of them.
    ///
    /// The difference of the areas is the area between the curves, as far as both go: forces that are too large at
    /// the beginning and too small at the end do not cancel, because they need not cancel in the error. Where a curve
    /// returns, it is the difference of the areas.
    pub fn differences(run: &Curve, other: &Curve) -> Option<[f64; 3]> {
        let [a, b] = [Self::of(run)?, Self::of(other)?];
        let area = between(run, other).unwrap_or((a.area_J - b.area_J).abs());
        Some([
            (a.peak_force_kN - b.peak_force_kN).abs(),
            area,
            (a.displacement_at_peak_mm - b.displacement_at_peak_mm).abs(),
        ])
    }
}

/// Points of a curve from the start of the drive.
fn points(curve: &Curve) -> Vec<Point> {
    let start = std::iter::once(curve.start());
    start.chain(curve.points().iter().copied()).collect()
}

/// Area under a curve by the trapezoidal rule [J].
fn area(points: &[Point]) -> f64 {
    let trapezium = |p: &[Point]| 0.5 * (p[0].1 + p[1].1) * (p[1].0 - p[0].0);
    points.windows(2).map(trapezium).sum()
}

/// Area between two curves as far as both go [J]; `None` if one returns, or if they have no part in common.
fn between(run: &Curve, other: &Curve) -> Option<f64> {
    let [a, b] = [points(run), points(other)];
    if returns(&a) || returns(&b) {
        return None;
    }
    let travel = a.last()?.0 - a.first()?.0;
    let [a, b] = [a, b].map(|points| Branch::new(&points, travel.signum()));
    let ((a0, a1), (b0, b1)) = (a.range()?, b.range()?);
    let (from, to) = (a0.max(b0), a1.min(b1));
    let mut places: Vec<f64> = [&a, &b]
        .iter()
        .flat_map(|branch| branch.points().iter().map(|p| p.0))
        .filter(|d| (from..=to).contains(d))
        .chain([from, to])
        .collect();
    places.sort_by(f64::total_cmp);
    let gap = |at: f64, after: bool| Some(a.force(at, after)? - b.force(at, after)?);
    let strip = |d: &[f64]| Some((d[1] - d[0]) * mean_size(gap(d[0], true)?, gap(d[1], false)?));
    let strips = places.windows(2).filter(|d| d[1] > d[0]);
    (from < to).then(|| strips.map(strip).sum()).flatten()
}

/// Mean magnitude of a linear function between its values at the ends.
fn mean_size(a: f64, b: f64) -> f64 {
    let [x, y] = [a.abs(), b.abs()];
    if a * b >= 0.0 {
        0.5 * (x + y)
    } else {
        0.5 * (x * x + y * y) / (x + y)
    }
}

/// Largest distance from the displacement at the peak at which the peak may be [mm] if forces are off by `error`
/// [kN]: the increments beside it, and all that carry as much as the peak less this error. A flat peak is wide.
pub fn width(curve: &Curve, error: f64) -> f64 {
    let Some(peak) = curve.peak() else {
        return 0.0;
    };
    let all = points(curve);
    let start = curve.start().0;
    let side = (peak.displacement - start).signum();
    let distance = |p: &Point| (p.0 - peak.displacement).abs();
    // The start of the drive is the first of the points.
    let beside = [peak.index, peak.index + 2].map(|i| all.get(i).map_or(0.0, distance));
    let high = all.iter().skip(1).filter(|p| {
        let out = side * (p.0 - start) > 0.0;
        out && side * p.1 >= side * peak.force - error
    });
    high.map(distance).chain(beside).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn curve(points: &[Point]) -> Curve {
        Curve::of_points(points)
    }

    const WALL: [Point; 4] = [(0.0, 0.0), (1.0, 40.0), (2.0, 50.0), (4.0, 30.0)];

    #[test]
    fn figures_are_those_by_hand_on_both_sides() {
        let expected = Figures {
            peak_force_kN: 50.0,
            area_J: 20.0 + 45.0 + 80.0,
            displacement_at_peak_mm: 2.0,
        };
        assert_eq!(Figures::of(&curve(&WALL)), Some(expected));
        let pulled = Figures::of(&curve(&WALL).along(-1.0)).unwrap();
        assert_eq!((pulled.peak_force_kN, pulled.area_J), (-50.0, 145.0));
        assert_eq!(Figures::of(&Curve::default()), None);
    }

    #[test]
    fn a_run_does_not_differ_from_itself() {
        let wall = curve(&WALL);
        assert_eq!(Figures::differences(&wall, &wall), Some([0.0; 3]));
        assert_eq!(Figures::differences(&wall, &Curve::default()), None);
    }

    #[test]
    fn areas_of_both_signs_do_not_cancel() {
        // Above by a triangle of 10 kN × 1 mm, then below by one of 10 kN × 2 mm: 0.5 (10 · 1 + 10 · 2) = 15 J.
        let run = curve(&[(0.0, 0.0), (1.0, 20.0), (3.0, 20.0)]);
        let other = curve(&[(0.0, 10.0), (1.0, 20.0), (3.0, 30.0)]);
        let [force, area, moved] = Figures::differences(&run, &other).unwrap();
        assert_relative_eq!(force, 10.0);
        assert_relative_eq!(area, 15.0, max_relative = 1e-14); // sums of a few numbers in f64
        assert_relative_eq!(moved, 2.0);
        // The other way round, on the other side, and with a crossing within an interval: 2 · 0.5 · 5 · 0.5.
        let turned = Figures::differences(&other.along(-1.0), &run.along(-1.0)).unwrap();
        assert_relative_eq!(turned[1], 15.0, max_relative = 1e-14);
        let [flat, crossing] =
            [[5.0, 5.0], [0.0, 10.0]].map(|f| curve(&[(0.0, f[0]), (1.0, f[1])]));
        let [_, area, _] = Figures::differences(&flat, &crossing).unwrap();
        assert_relative_eq!(area, 2.5, max_relative = 1e-14);
    }

    #[test]
    fn areas_are_compared_as_far_as_both_curves_go() {
        let [long, short] = [4.0, 2.0].map(|end| curve(&[(0.0, 10.0), (end, 10.0)]));
        assert_eq!(Figures::differences(&long, &short).unwrap()[1], 0.0);
        // Curves that return, as those of cyclic tests, have the difference of their areas.
        let loops = [(0.0, 0.0), (2.0, 10.0), (-2.0, -10.0), (2.0, 8.0)];
        let smaller = loops.map(|(d, f)| (d, 0.5 * f));
        let [_, area, _] = Figures::differences(&curve(&loops), &curve(&smaller)).unwrap();
        assert_relative_eq!(area, 0.5 * area_of(&loops).abs(), max_relative = 1e-14);
    }

    fn area_of(points: &[Point]) -> f64 {
        area(points)
    }

    #[test]
    fn a_flat_peak_may_be_anywhere_on_its_top() {
        let flat = [
            (0.0, 0.0),
            (1.0, 48.0),
            (1.5, 50.0),
            (1.75, 49.0),
            (4.0, 30.0),
        ];
        let of = |error| width(&curve(&flat), error);
        // The increments beside the peak are 0.5 and 0.25 mm away.
        assert_eq!(of(0.0), 0.5);
        assert_eq!(of(1.5), 0.5);
        assert_eq!(of(20.0), 2.5);
        assert_eq!(width(&curve(&flat).along(-1.0), 20.0), 2.5);
        assert_eq!(width(&Curve::default(), 1.0), 0.0);
    }
}
