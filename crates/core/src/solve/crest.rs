//! Increments near the peak of what a displacement drives or steers.
//!
//! What load a wall carries is read off the largest force of all increments, and the largest of them is only near the peak: over
//! a way h a parabola with the second derivative −κ rises by κ h²/8 above its chord. Where the one through the last three increments
//! has its vertex within the next, that one is made so short that no more than a given part of the force is left there. What was not
//! foreseen, as of a bond that breaks, is seen behind it, and that increment taken again.

use serde::{Deserialize, Serialize};

/// Part of the largest force so far above which a peak counts.
const NEAR: f64 = 0.9;
/// Part of the last increment that the next is at least, however sharp the peak looks.
const LEAST: f64 = 0.25;

/// Part of a force that the first of a curve begins with at most.
pub(super) const AT_REST: f64 = 0.1;
/// Times the part that is left unseen, where the force does not fall.
const CORNER: f64 = 4.0;

/// The last increments of a step.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(super) struct Crest {
    /// Part of the step's time, and the force or load factor there, oldest first.
    last: [Option<[f64; 2]>; 3],
    /// Largest so far, without sign.
    most: f64,
}

impl Crest {
    /// Takes an increment.
    pub(super) fn take(&mut self, time: f64, force: f64) {
        let [_, before, last] = self.last;
        self.last = [before, last, Some([time, force])];
        self.most = self.most.max(force.abs());
    }

    /// What was tells nothing of what comes.
    pub(super) fn forget(&mut self) {
        self.last = [None; 3];
    }

    /// The whole step becomes `part` of a longer one.
    pub(super) fn lengthen(&mut self, part: f64) {
        for point in self.last.iter_mut().flatten() {
            point[0] *= part;
        }
    }

    /// Size of the next increment, if one of `next` would pass over a peak and leave more than `part` of the force unseen.
    pub(super) fn shortens(&self, next: f64, part: f64) -> Option<f64> {
        let [Some(a), Some(b), Some(c)] = self.last else {
            return None;
        };
        let ([before, size], force) = ([b[0] - a[0], c[0] - b[0]], c[1].abs());
        if !(before > 0.0 && size > 0.0 && force >= NEAR * self.most) {
            return None;
        }
        // Of the force along what it is now.
        let slope =
            |from: [f64; 2], to: [f64; 2]| (to[1] - from[1]) * c[1].signum() / (to[0] - from[0]);
        let kappa = 2.0 * (slope(a, b) - slope(b, c)) / (before + size);
        let rises = slope(b, c) - 0.5 * kappa * size;
        if !(rises > 0.0 && rises < kappa * next) {
            return None;
        }
        let resolves = (8.0 * part * force / kappa).sqrt().max(LEAST * size);
        (resolves < next).then_some(resolves)
    }

    /// The force where the way begins, if nothing else is known.
    pub(super) fn begins_at(&self) -> Option<f64> {
        match self.last {
            [None, None, Some([_, force])] => Some(force),
            _ => None,
        }
    }

    /// Size of another try of an increment that ends at `time` with this `force`, if more than `part` of the force may lie
    /// unseen within it: at the vertex of the parabola through its ends and the one before, or, where the force has fallen
    /// farther than that tells of, where it would have come to without the fall. What goes on rising has a corner more
    /// often than a peak, and is asked for [`CORNER`] times as much, but for the second increment from rest, which is long
    /// beside what it has come.
    pub(super) fn passed(&self, time: f64, force: f64, part: f64) -> Option<f64> {
        let [earlier, Some(a), Some(b)] = self.last else {
            return None;
        };
        let ([before, size], sign) = ([b[0] - a[0], time - b[0]], b[1].signum());
        let [first, start, end] = [a[1], b[1], force].map(|force| sign * force);
        let largest = start.max(end);
        if !(before > 0.0 && size > 0.0 && largest >= NEAR * self.most && part < 1.0) {
            return None;
        }
        let [rise, then] = [(start - first) / before, (end - start) / size];
        let kappa = 2.0 * (rise - then) / (before + size);
        // Of the parabola, where the increment begins.
        let slope = rise - 0.5 * kappa * before;
        if !(rise > 0.0 && slope < kappa * size) {
            return None;
        }
        let (unseen, resolves) = if slope > 0.0 {
            let vertex = start + 0.5 * slope * slope / kappa;
            (vertex - largest, (8.0 * part * largest / kappa).sqrt())
        } else {
            (rise * size, part * largest / rise)
        };
        let is_first = earlier.is_none() && first.abs() <= AT_REST * largest;
        let corner = then >= 0.0 && !is_first;
        let least = if corner { CORNER * part } else { part };
        let resolves = resolves.max(LEAST * size).min(0.5 * size);
        (unseen > least * largest).then_some(resolves)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// F = 10 − (t − 2)² [kN].
    fn hill(t: f64) -> f64 {
        10.0 - (t - 2.0).powi(2)
    }

    fn crest(times: &[f64], force: impl Fn(f64) -> f64) -> Crest {
        let mut crest = Crest::default();
        for &t in times {
            crest.take(t, force(t));
        }
        crest
    }

    #[test]
    fn no_more_than_the_given_part_is_left_at_the_peak() {
        for sign in [1.0, -1.0] {
            let crest = crest(&[0.0, 0.8, 1.5], |t| sign * hill(t));
            let size = crest.shortens(1.0, 0.005).unwrap();
            // κ = 2, F = 9.75: h = √(8 × 0.005 × 9.75 / 2), but for the roundings of two differences.
            assert!((size - 0.195_f64.sqrt()).abs() < 1e-12, "{size}");
            // Wherever the increments fall on the hill, its top is h²/4 at most above one of them.
            for begin in 0..10 {
                let from = 1.5 + 0.1 * size * f64::from(begin);
                let seen = (0..4).map(|i| hill(from + size * f64::from(i)));
                assert!(seen.fold(0.0, f64::max) >= 10.0 * (1.0 - 0.005));
            }
        }
    }

    #[test]
    fn where_no_peak_comes_increments_stay() {
        let stays = |crest: &Crest| crest.shortens(0.75, 0.005).is_none();
        for [a, b, c] in [
            [0.0, 0.3, 0.6], // the peak is beyond the next increment
            [1.5, 2.0, 2.5], // it lies behind
            [1.7, 1.8, 1.9], // the next one is too flat a piece of it
            [2.0, 1.9, 1.5],
            [1.5, 1.5, 1.5],
        ] {
            let flat = |t| 100.0 * f64::from(u8::from(a > 1.6)) + hill(t);
            assert!(stays(&crest(&[a, b, c], flat)), "{a} {b} {c}");
        }
        assert!(stays(&crest(&[1.0, 1.5], hill)));
        assert!(stays(&crest(&[1.0, 1.4, 1.8], |t| 10.0 + (t - 2.0).powi(2))));
        assert!(stays(&crest(&[0.0, 0.8, 1.5], |_| 0.0)));
        // Far below an earlier peak.
        let mut lower = crest(&[-1.0], |_| 11.0);
        for t in [0.0, 0.8, 1.5] {
            lower.take(t, hill(t));
        }
        assert!(stays(&lower));
        let mut turned = crest(&[0.0, 0.8, 1.5], hill);
        assert!(!stays(&turned));
        turned.forget();
        assert!(stays(&turned));
    }

    /// What is taken again is shorter, until no more than the given part is left between two increments.
    #[test]
    fn a_peak_that_was_passed_over_is_gone_back_to() {
        let brittle = |t: f64| if t < 2.03 { 10.0 * t } else { 4.0 };
        let bonded = |t: f64| if t < 0.9 { 10.0 * t } else { 9.0 - (t - 0.9) };
        let runs: [(&dyn Fn(f64) -> f64, f64); 3] =
            [(&hill, 10.0), (&brittle, 20.3), (&bonded, 9.0)];
        for (force, peak) in runs {
            for sign in [1.0, -1.0] {
                let mut way = crest(&[0.0], |t| sign * force(t));
                let (mut at, mut size, mut tries, mut most) = (0.0, 0.7, 0, 0.0_f64);
                while at < 3.0 {
                    tries += 1;
                    let to = at + size;
                    if let Some(shorter) = way.passed(to, sign * force(to), 0.005) {
                        assert!((LEAST - 1e-9..0.5 + 1e-9).contains(&(shorter / size)));
                        size = shorter;
                        continue;
                    }
                    at = to;
                    way.take(at, sign * force(at));
                    most = most.max(force(at));
                    size = (1.5 * size).min(0.7);
                }
                println!("{most} of {peak} in {tries}");
                // Four times the part where the force rises on; of a parabola or a fall no more than the part. Three
                // go in ten increments; a fall takes two tries each time that what comes before it is halved.
                let left = if peak == 9.0 { 4.0 } else { 1.0 } * 0.005;
                assert!(most > (1.0 - left) * peak && tries < 30);
            }
        }
    }

    #[test]
    fn what_rises_on_or_was_seen_is_not_taken_again() {
        let again = |times: &[f64], to: f64, force: fn(f64) -> f64, part: f64| {
            crest(times, force).passed(to, force(to), part).is_some()
        };
        let brittle = |t: f64| if t < 2.0 { t } else { 1.0 };
        assert!(again(&[1.0, 1.9], 2.5, brittle, 0.005));
        assert!(!again(&[1.0, 1.9], 2.5, brittle, 1.0)); // as it was asked for
        assert!(!again(&[1.0, 1.9], 1.99, brittle, 0.005));
        assert!(!again(&[2.1, 2.2], 2.3, brittle, 0.005));
        assert!(!again(&[1.8, 1.9], 2.05, hill, 0.005)); // too flat a piece of it
        assert!(!again(&[1.0], 2.5, brittle, 0.005));
        // A corner: friction does not fall, and hides nothing.
        let slides = |t: f64| t.min(2.0);
        assert!(!again(&[1.5, 1.7, 1.9], 2.1, slides, 0.005));
    }

    #[test]
    fn a_sharp_peak_costs_a_few_increments() {
        let crest = crest(&[1.0, 1.4, 1.9], |t| 10.0 - 9.0 * (t - 2.0).powi(2));
        assert_eq!(crest.shortens(0.75, 1e-6), Some(LEAST * (1.9 - 1.4)));
        // Never more than the next one would be anyway.
        assert_eq!(crest.shortens(0.1, 1e-6), None);
    }

    #[test]
    fn a_longer_step_sees_the_same_peak() {
        let mut crest = crest(&[0.0, 0.8, 1.5], hill);
        let size = crest.shortens(1.0, 0.005).unwrap();
        crest.lengthen(0.5);
        let half = crest.shortens(0.5, 0.005).unwrap();
        assert!((half - 0.5 * size).abs() < 1e-12, "{half} {size}"); // roundings of differences
    }
}
