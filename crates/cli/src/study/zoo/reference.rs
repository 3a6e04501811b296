//! The careful run that a wall is compared with: a tenth of the increments, consistent tangents, a tenth of their
//! tolerance.

use wythe_core::model::Model;
use wythe_core::results::Curve;
use wythe_core::results::comparison::points_of;

/// Increments of the careful run over those of the default.
const PART: f64 = 0.1;
/// Tolerance of the out-of-balance force over the mean nodal force: a tenth of the default for consistent
/// tangents.
const RESIDUAL: f64 = 5e-4;
/// Largest number of iterations to reach that tolerance.
const ITERATIONS: u32 = 60;
/// Displacements that differ by less than this part of the range are equal [-].
const SAME: f64 = 1e-6;

/// Overrides of a model's deck that make its run a careful one.
pub fn careful(model: &Model) -> Vec<(String, String)> {
    let mut set = Vec::new();
    for (i, step) in model.steps.iter().enumerate() {
        let increments = step.increments;
        let mut say = |key: &str, value: String| set.push((format!("steps.{i}.{key}"), value));
        say(
            "increments.initial",
            (PART * increments.initial).to_string(),
        );
        say("increments.max", (PART * increments.max).to_string());
        // The smallest increment must not exceed the first.
        say(
            "increments.min",
            increments.min.min(PART * increments.initial).to_string(),
        );
        say("increments.peak", (PART * increments.peak).to_string());
        say("tolerance.residual", RESIDUAL.to_string());
        say("tolerance.max_iterations", ITERATIONS.to_string());
        say("tangent", "consistent".to_owned());
    }
    set
}

/// Difference between a curve and its reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// End of the comparison: the displacement at which the first of the curves ends [mm].
    pub to: f64,
    /// Largest force over that of the reference, less 1 [-].
    pub peak: f64,
    /// Area under the curve over that of the reference, less 1 [-].
    pub area: f64,
}

impl Difference {
    /// Compares two curves up to the displacement at which the first of them ends. `completed`: both runs reached
    /// their end. Returns none if a curve has no points, or if a cyclic run ended early: its displacement does not
    /// show which reversals of the two runs correspond.
    pub fn of(run: &Curve, reference: &Curve, completed: bool) -> Option<Self> {
        let ends = [run.final_displacement()?, reference.final_displacement()?];
        if !completed && (run.turns_back() || reference.turns_back()) {
            return None;
        }
        let begin = reference.start().0;
        let range = reference.points().iter().map(|p| (p.0 - begin).abs());
        let same = (ends[0] - ends[1]).abs() <= SAME * range.fold(0.0, f64::max);
        let [mut run, mut reference] = [run, reference].map(points_of);
        let mut to = ends[0];
        if !same {
            let side = (ends[1] - begin).signum();
            to = begin + side * f64::min(side * (ends[0] - begin), side * (ends[1] - begin));
            cut(&mut run, to, side);
            cut(&mut reference, to, side);
        }
        let peaks = [&run, &reference].map(|c| Curve::of_points(c).peak().map(|p| p.force));
        Some(Self {
            to,
            peak: peaks[0]? / peaks[1]? - 1.0,
            area: work(&run) / work(&reference) - 1.0,
        })
    }
}

/// Cuts the curve where it first reaches `to`, by linear interpolation; `side` is its direction, 1 or −1.
fn cut(curve: &mut Vec<(f64, f64)>, to: f64, side: f64) {
    let Some(beyond) = curve.iter().position(|p| side * (p.0 - to) >= 0.0) else {
        return;
    };
    curve.truncate(beyond + 1);
    if let [.., a, b] = curve.as_mut_slice()
        && b.0 != a.0
    {
        *b = (to, a.1 + (to - a.0) / (b.0 - a.0) * (b.1 - a.1));
    }
}

/// ∫ F du along the curve, by the trapezoidal rule [J].
fn work(curve: &[(f64, f64)]) -> f64 {
    let piece = |w: &[(f64, f64)]| 0.5 * (w[0].1 + w[1].1) * (w[1].0 - w[0].0);
    curve.windows(2).map(piece).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::zoo::Wall;
    use wythe_core::deck::Deck;

    const RAMP: [(f64, f64); 3] = [(0.0, 0.0), (1.0, 10.0), (2.0, 0.0)];

    fn of(run: &[(f64, f64)], reference: &[(f64, f64)]) -> Option<Difference> {
        Difference::of(&Curve::of_points(run), &Curve::of_points(reference), false)
    }

    #[test]
    fn curves_are_compared_up_to_where_the_first_ends() {
        let higher = RAMP.map(|(x, y)| (x, 1.1 * y));
        let all = of(&higher, &RAMP).unwrap();
        // The tolerance allows for rounding in products and sums of a few numbers.
        assert!((all.peak - 0.1).abs() < 1e-12 && (all.area - 0.1).abs() < 1e-12);
        assert_eq!(all.to, 2.0);
        let short = of(&[(0.0, 0.0), (0.5, 6.0)], &RAMP).unwrap();
        assert_eq!(short.to, 0.5);
        assert!((short.peak - 0.2).abs() < 1e-12 && (short.area - 0.2).abs() < 1e-12);
        // A drive in the opposite direction.
        let back = |curve: &[(f64, f64)]| curve.iter().map(|p| (-p.0, -p.1)).collect::<Vec<_>>();
        let other = of(&back(&[(0.0, 0.0), (0.5, 6.0)]), &back(&RAMP)).unwrap();
        assert_eq!(
            (other.to, other.peak, other.area),
            (-0.5, short.peak, short.area)
        );
        assert_eq!(of(&[], &RAMP), None);
    }

    #[test]
    fn drives_to_and_fro_are_compared_where_both_came_to_the_end() {
        let cycle = [
            (0.0, 0.0),
            (1.0, 10.0),
            (0.0, -5.0),
            (-1.0, -9.0),
            (0.0, 4.0),
        ];
        let [whole, half] = [&cycle[..], &cycle[..3]].map(Curve::of_points);
        assert_eq!(Difference::of(&whole, &whole, true).unwrap().area, 0.0);
        // The curve ends at the same displacement as the whole curve by chance.
        assert_eq!(Difference::of(&half, &whole, false), None);
    }

    #[test]
    fn a_careful_deck_is_sound() {
        for seed in [1, 2, 28] {
            let wall = Wall::drawn(seed);
            let model = |set: &[(String, String)]| {
                let deck = Deck::from_str_with(&wall.deck, "zoo.toml", set).unwrap();
                Model::from_deck(&deck).unwrap().0
            };
            let default = model(&[]);
            let careful = model(&careful(&default));
            for (a, b) in default.steps.iter().zip(&careful.steps) {
                assert_eq!(b.increments.max, PART * a.increments.max);
                assert_eq!(b.increments.initial, PART * a.increments.initial);
                assert!(b.tolerance.residual < a.tolerance.residual);
            }
        }
    }
}
