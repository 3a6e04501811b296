//! Pareto front of the choices in error and computing time.

use super::errors::Errors;

/// Ratio of computing times below which another choice of the same accuracy is better [-].
pub const FASTER: f64 = 0.8;

/// Median; for an even number of values the mean of the middle two; none if there are no values.
pub fn median(values: &[f64]) -> Option<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let half = sorted.len() / 2;
    let upper = sorted.get(half)?;
    Some(if sorted.len() % 2 == 1 {
        *upper
    } else {
        0.5 * (sorted[half - 1] + upper)
    })
}

/// Indices of the Pareto front of points (time, error), fastest first: each is more accurate than all points that
/// are as fast or faster. Errors below `floor`, the uncertainty of the reference, count as equal. A NaN is never
/// on the front.
pub fn front(points: &[(f64, f64)], floor: f64) -> Vec<usize> {
    let key = |i: usize| (points[i].0, points[i].1.max(floor));
    let finite = |i: &usize| points[*i].0.is_finite() && points[*i].1.is_finite();
    let mut order: Vec<usize> = (0..points.len()).filter(finite).collect();
    order.sort_by(|a, b| {
        let (a, b) = (key(*a), key(*b));
        a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    let mut least = f64::INFINITY;
    order.retain(|i| {
        let error = key(*i).1;
        let better = error < least;
        least = least.min(error);
        better
    });
    order
}

/// The fastest choice that is at least as accurate as choice `of` in both peak and energy, and takes at most
/// [`FASTER`] of its time. Errors below `floor` count as equal. An error of none means that the run did not reach
/// its end.
pub fn beaten(times: &[f64], errors: &[Option<Errors>], of: usize, floor: f64) -> Option<usize> {
    let sizes = |errors: Errors| [errors.peak, errors.energy].map(f64::abs);
    let bounds = sizes(errors[of]?).map(|error| error.max(floor));
    let as_near = |i: &usize| {
        errors[*i].is_some_and(|errors| std::iter::zip(sizes(errors), bounds).all(|(e, b)| e <= b))
    };
    (0..times.len())
        .filter(|i| times[*i] <= FASTER * times[of] && as_near(i))
        .min_by(|a, b| times[*a].total_cmp(&times[*b]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_those_of_the_middle() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[3.0, 1.0, 9.0]), Some(3.0));
        assert_eq!(median(&[4.0, 1.0, 2.0, 9.0]), Some(3.0));
    }

    #[test]
    fn the_front_is_what_no_other_beats() {
        let points = [
            (1.0, 0.02),
            (0.5, 0.1),
            (2.0, 0.03),
            (4.0, 0.001),
            (0.5, 0.2),
            (3.0, f64::NAN),
        ];
        assert_eq!(front(&points, 0.0), [1, 0, 3]);
        // Errors that the reference cannot distinguish do not make a choice better.
        assert_eq!(front(&points, 0.02), [1, 0]);
        assert_eq!(front(&[], 0.0), [0; 0]);
        // Every point off the front is exceeded by one on it.
        let on = front(&points, 0.0);
        for (time, error) in points.iter().filter(|p| p.1.is_finite()) {
            assert!(
                on.iter()
                    .any(|i| points[*i].0 <= *time && points[*i].1 <= *error)
            );
        }
    }

    #[test]
    fn a_choice_is_beaten_by_one_as_accurate_in_both_and_a_fifth_faster() {
        let of = |peak, energy| {
            let rms = f64::NAN; // is not read
            Some(Errors { peak, energy, rms })
        };
        let times = [1.0, 0.85, 0.7, 0.75, 0.6, 0.5, 0.4];
        let errors = [
            of(0.01, -0.02),
            of(0.001, 0.001), // not a fifth faster
            of(0.02, 0.01),   // larger error of the peak
            of(-0.01, 0.02),
            of(0.0, 0.03), // larger error of the energy
            None,          // did not reach the end
            of(f64::NAN, 0.0),
        ];
        assert_eq!(beaten(&times, &errors, 0, 0.0), Some(3));
        assert_eq!(beaten(&times[..3], &errors[..3], 0, 0.0), None);
        // Below the uncertainty of the reference, a larger error counts as equal.
        assert_eq!(beaten(&times, &errors, 0, 0.02), Some(2));
        assert_eq!(beaten(&times, &errors, 0, 0.03), Some(4));
        assert_eq!(beaten(&times, &errors, 5, 0.03), None);
    }
}
