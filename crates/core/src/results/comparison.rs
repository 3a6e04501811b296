//! Comparison of a run with an experiment by engineering quantities.

use serde::Serialize;

use super::Curve;
use super::backbone::Backbone;
use super::branch::{self, Branch};
use super::curve::INITIAL;
use crate::experiment::{Experiment, Point};
use crate::model::Model;
use crate::model::scene::Step;

/// Quantities read from a curve; displacements and forces are positive along the drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[allow(non_snake_case)]
pub struct Measures {
    /// Largest force [kN].
    pub peak_force_kN: Option<f64>,
    /// Displacement at the peak [mm].
    pub displacement_at_peak_mm: Option<f64>,
    /// Secant stiffness up to a tenth of the peak [kN/mm], see [`Curve::initial_stiffness`].
    pub initial_stiffness_kN_per_mm: Option<f64>,
    /// Secant stiffness up to 0.7 of the peak [kN/mm], which errors in the digitised start of a curve hardly affect.
    pub secant_stiffness_kN_per_mm: Option<f64>,
    /// Area below the curve over the common displacement range [J].
    pub energy_J: Option<f64>,
    /// Displacement after the peak at which the force has fallen to 0.8 of the peak [mm].
    pub displacement_at_80_percent_mm: Option<f64>,
    /// Drift at that displacement, relative to the clear height [%]; `None` if the height is unknown.
    pub drift_at_80_percent: Option<f64>,
}

/// Both curves and their difference.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[allow(non_snake_case)]
pub struct Comparison {
    /// Name of the experiment.
    pub experiment_name: String,
    /// Whether the experiment was driven the other way and is mirrored.
    pub mirrored: bool,
    /// Clear height for the drift [mm].
    pub height_mm: Option<f64>,
    /// Displacement range covered by both curves [mm]; `None` if they have none in common.
    pub common_range_mm: Option<[f64; 2]>,
    /// Quantities of the run.
    pub run: Measures,
    /// Quantities of the experiment; those of the envelope if it is cyclic.
    pub experiment: Measures,
    /// Ratio of the run to the experiment [-].
    pub ratio: Measures,
    /// Root mean square of the difference over the common range [kN].
    pub rms_difference_kN: Option<f64>,
    /// The same divided by the peak force of the experiment [-].
    pub rms_over_peak: Option<f64>,
}

/// Compares the curve of a run with an experiment; `height` is the clear height of the wall [mm].
pub fn compare(curve: &Curve, experiment: &Experiment, height: Option<f64>) -> Comparison {
    let points = points_of(curve);
    let travel = |p: super::curve::Peak| (p.displacement - curve.start().0).signum();
    let side = curve.peak().map_or_else(|| branch::side(&points), travel);
    let run = Branch::new(&points, side);
    let (test, mirrored) = Branch::towards(&experiment.points, side);
    let common = common_range(&run, &test);
    let of_run = measures((&curve.along(side), false), &run, common, height);
    // Loops of a test are read as those of a run.
    let all = Curve::of_points(&experiment.points).along(if mirrored { -side } else { side });
    let of_test = if all.turns_back() {
        let other = all.peak().is_some_and(|p| p.displacement < all.start().0);
        measures((&all, other), &test, common, height)
    } else {
        let one = Curve::of_points(test.points());
        measures((&one, false), &test, common, height)
    };
    let rms = common.and_then(|range| root_mean_square(&run, &test, range));
    Comparison {
        experiment_name: experiment.name.clone(),
        mirrored,
        height_mm: height,
        common_range_mm: common.map(|(from, to)| [from, to]),
        run: of_run,
        experiment: of_test,
        ratio: ratio(&of_run, &of_test),
        rms_difference_kN: rms,
        rms_over_peak: rms.zip(of_test.peak_force_kN).map(|(rms, peak)| rms / peak),
    }
}

/// Height between the supports below, which hold vertically, and the driven part above [mm]: the lowest node of a
/// driven face, the underside of a beam that stays level, or the mean of the nodes of a spring whose end is driven.
/// `None` if nothing is driven sideways, or not above the supports.
pub fn clear_height(model: &Model) -> Option<f64> {
    let height = |n: &u32| model.mesh.nodes[*n as usize][2];
    let of_beam = |step: &Step| {
        let driven = step.driven?;
        let moves = driven.way(step).is_some() && driven.direction[2] == 0.0;
        let beam = model.beams.get(driven.beam)?;
        let lowest = || beam.nodes.iter().map(height).fold(f64::INFINITY, f64::min);
        moves.then(|| lowest() - beam.depth)
    };
    let of_spring = |step: &Step| {
        let sideways = |by: &[f64; 3]| by[0] != 0.0 || by[1] != 0.0;
        let driven = step.springs.iter().position(sideways)?;
        let nodes = &model.springs.get(driven)?.nodes;
        Some(nodes.iter().map(height).sum::<f64>() / nodes.len() as f64)
    };
    let steps = model.steps.iter();
    let driven = steps.clone().find_map(of_beam);
    let top = driven.or_else(|| steps.clone().find_map(of_spring))?;
    let vertical = model.supports.iter().filter(|s| s.fixed[2]);
    let held = vertical.flat_map(|s| &s.nodes).map(height);
    let clear = top - held.fold(f64::NEG_INFINITY, f64::max);
    (clear > 0.0 && clear.is_finite()).then_some(clear)
}

/// Points of a curve, from the point where the drive begins.
pub fn points_of(curve: &Curve) -> Vec<Point> {
    std::iter::once(curve.start())
        .chain(curve.points().iter().copied())
        .collect()
}

fn common_range(a: &Branch, b: &Branch) -> Option<(f64, f64)> {
    let ((a0, a1), (b0, b1)) = (a.range()?, b.range()?);
    let (from, to) = (a0.max(b0), a1.min(b1));
    (from < to).then_some((from, to))
}

/// Quantities of the side of a curve on which its peak is, or of the `opposite` one.
fn measures(
    (curve, opposite): (&Curve, bool),
    branch: &Branch,
    common: Option<(f64, f64)>,
    height: Option<f64>,
) -> Measures {
    let side = Backbone::of(curve, opposite);
    let secant = |part: f64| side.as_ref().and_then(|side| side.secant(part));
    let (peak, initial, at_80) = if opposite {
        let fallen = side.as_ref().and_then(Backbone::displacement_at_80_percent);
        (curve.opposite_peak(), secant(INITIAL), fallen)
    } else {
        let fallen = curve.displacement_at_80_percent();
        (curve.peak(), curve.initial_stiffness(), fallen)
    };
    Measures {
        peak_force_kN: peak.map(|p| p.force),
        displacement_at_peak_mm: peak.map(|p| p.displacement),
        initial_stiffness_kN_per_mm: initial,
        secant_stiffness_kN_per_mm: secant(SECANT),
        energy_J: common.map(|range| area(branch, range)),
        displacement_at_80_percent_mm: at_80,
        drift_at_80_percent: at_80.zip(height).map(|(d, h)| 100.0 * d / h),
    }
}

/// Fraction of the peak up to which the second stiffness is measured.
const SECANT: f64 = 0.7;

fn ratio(a: &Measures, b: &Measures) -> Measures {
    let over = |a: Option<f64>, b: Option<f64>| {
        let (a, b) = a.zip(b)?;
        (b != 0.0).then_some(a / b)
    };
    Measures {
        peak_force_kN: over(a.peak_force_kN, b.peak_force_kN),
        displacement_at_peak_mm: over(a.displacement_at_peak_mm, b.displacement_at_peak_mm),
        initial_stiffness_kN_per_mm: over(
            a.initial_stiffness_kN_per_mm,
            b.initial_stiffness_kN_per_mm,
        ),
        secant_stiffness_kN_per_mm: over(
            a.secant_stiffness_kN_per_mm,
            b.secant_stiffness_kN_per_mm,
        ),
        energy_J: over(a.energy_J, b.energy_J),
        displacement_at_80_percent_mm: over(
            a.displacement_at_80_percent_mm,
            b.displacement_at_80_percent_mm,
        ),
        drift_at_80_percent: over(a.drift_at_80_percent, b.drift_at_80_percent),
    }
}

/// Displacements of the corners of all branches within the range, and its two ends.
fn corners(branches: &[&Branch], (from, to): (f64, f64)) -> Vec<f64> {
    let all = branches.iter().flat_map(|b| b.points()).map(|p| p.0);
    let mut places: Vec<f64> = all.filter(|&d| from < d && d < to).collect();
    places.extend([from, to]);
    places.sort_by(f64::total_cmp);
    places.dedup();
    places
}

/// Area ∫ F du [J]; exact because the branch is linear between its corners.
fn area(branch: &Branch, range: (f64, f64)) -> f64 {
    corners(&[branch], range)
        .windows(2)
        .filter_map(|w| {
            let (a, b) = (branch.force(w[0], true)?, branch.force(w[1], false)?);
            Some(0.5 * (a + b) * (w[1] - w[0]))
        })
        .sum()
}

/// Root mean square (∫ ΔF² du / ∫ du)^½ [kN]; exact because the branches are linear between their corners.
fn root_mean_square(a: &Branch, b: &Branch, range: (f64, f64)) -> Option<f64> {
    let mut squares = 0.0;
    for w in corners(&[a, b], range).windows(2) {
        let start = a.force(w[0], true)? - b.force(w[0], true)?;
        let end = a.force(w[1], false)? - b.force(w[1], false)?;
        squares += (start * start + start * end + end * end) / 3.0 * (w[1] - w[0]);
    }
    Some((squares / (range.1 - range.0)).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    fn experiment(points: &[Point]) -> Experiment {
        Experiment {
            name: "test".to_owned(),
            points: points.to_vec(),
        }
    }

    const WALL: [Point; 5] = [
        (0.0, 0.0),
        (0.5, 20.0),
        (2.0, 50.0),
        (3.0, 45.0),
        (4.0, 30.0),
    ];

    #[test]
    fn a_curve_equals_itself_in_either_direction() {
        for sign in [1.0, -1.0] {
            let curve = Curve::of_points(&WALL.map(|p| (sign * p.0, sign * p.1)));
            let found = compare(&curve, &experiment(&WALL), Some(1000.0));
            assert_eq!(found.mirrored, sign < 0.0);
            assert_eq!(found.common_range_mm, Some([0.0, 4.0]));
            assert_eq!(found.rms_difference_kN, Some(0.0));
            // 5 + 52.5 + 47.5 + 37.5
            assert_relative_eq!(found.run.energy_J.unwrap(), 142.5, max_relative = 1e-14);
            // 40 kN at 3 + 1/3 mm
            assert_relative_eq!(
                found.run.drift_at_80_percent.unwrap(),
                1.0 / 3.0,
                max_relative = 1e-14
            );
            // 35 kN at 1.25 mm
            assert_relative_eq!(
                found.run.secant_stiffness_kN_per_mm.unwrap(),
                28.0,
                max_relative = 1e-14
            );
            assert_eq!(found.ratio.peak_force_kN, Some(1.0));
            assert_eq!(found.ratio.drift_at_80_percent, Some(1.0));
        }
    }

    #[test]
    fn an_offset_is_a_root_mean_square_over_the_common_range() {
        let curve = Curve::of_points(&WALL);
        let higher: Vec<Point> = WALL[..4].iter().map(|p| (p.0, p.1 + 5.0)).collect();
        let found = compare(&curve, &experiment(&higher), None);
        assert_eq!(found.common_range_mm, Some([0.0, 3.0]));
        assert_relative_eq!(found.rms_difference_kN.unwrap(), 5.0, max_relative = 1e-14);
        assert_relative_eq!(
            found.rms_over_peak.unwrap(),
            5.0 / 55.0,
            max_relative = 1e-14
        );
        assert_eq!(found.experiment.displacement_at_80_percent_mm, None);
        assert_eq!(found.ratio.displacement_at_80_percent_mm, None);
        // A ramp from 0 to 3 kN against zero: 3/√3.
        let ramp = Curve::of_points(&[(0.0, 0.0), (1.0, 3.0)]);
        let flat = experiment(&[(0.0, 0.0), (2.0, 0.0)]);
        let rms = compare(&ramp, &flat, None).rms_difference_kN;
        assert_relative_eq!(rms.unwrap(), 3.0_f64.sqrt(), max_relative = 1e-14);
    }

    /// A cyclic test that is stronger on the other side: the side of the run counts.
    #[test]
    fn a_cyclic_test_is_read_on_the_side_of_the_run() {
        let curve = Curve::of_points(&WALL);
        let stronger_there = [
            (0.0, 0.0),
            (0.3, 20.0),
            (0.0, 0.0),
            (-0.3, -60.0),
            (0.0, 0.0),
            (2.0, 25.0),
            (0.0, 0.0),
            (-2.0, -35.0),
        ];
        let found = compare(&curve, &experiment(&stronger_there), None);
        assert!(!found.mirrored);
        assert_eq!(found.experiment.peak_force_kN, Some(25.0));
        assert_eq!(found.experiment.displacement_at_peak_mm, Some(2.0));
        // 17.5 kN at 0.2625 mm
        assert_relative_eq!(
            found.experiment.secant_stiffness_kN_per_mm.unwrap(),
            17.5 / 0.2625,
            max_relative = 1e-12
        );
        assert_eq!(found.ratio.peak_force_kN, Some(2.0));
        // The other way round the experiment is turned.
        let back = Curve::of_points(&WALL.map(|p| (-p.0, -p.1)));
        let found = compare(&back, &experiment(&stronger_there), None);
        assert_eq!(found.experiment.peak_force_kN, Some(60.0));
    }

    #[test]
    fn curves_without_a_common_range_have_no_distance() {
        let curve = Curve::of_points(&WALL);
        let found = compare(&curve, &experiment(&[(5.0, 1.0), (6.0, 2.0)]), None);
        assert_eq!(
            (found.common_range_mm, found.rms_difference_kN),
            (None, None)
        );
        let nothing = compare(&Curve::default(), &experiment(&WALL), None);
        assert_eq!(nothing.run.peak_force_kN, None);
    }
}
