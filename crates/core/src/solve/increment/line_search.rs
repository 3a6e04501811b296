//! Energy line search: a root search in one variable (docs/theory/equilibrium.md, eq. 11).
//!
//! Along the Newton direction d, s(η) = d·r(q + η d) is the slope of the energy. The search ignores norms of r, which
//! may grow while the slope falls (the range of stick is only 2 c/k_s ≈ 3e-5 mm wide). A residual costs a tenth of a
//! factorisation, so a few evaluations pay.

use super::outcome::Rejection;
/// d·r, the slope of the energy along a direction d with out-of-balance forces r.
pub(in crate::solve) use crate::linear::dot;

/// Next action of the search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Probe {
    /// Evaluate the slope at this step length.
    Try(f64),
    /// Accept this step length, which was evaluated last.
    Accept(f64),
}

/// State of the search: a bracket of the root.
#[derive(Clone, Copy, Debug)]
pub struct LineSearch {
    start: f64,
    low: (f64, f64),
    high: Option<(f64, f64)>,
    evaluations: usize,
    side: i8,
    most: usize,
    smallest: f64,
    farthest: f64,
}

/// Accepted |s(η)/s(0)|. A looser root takes more solves, a tighter one saves none (docs/theory/equilibrium.md, eq.
/// 11).
const FALL: f64 = 0.2;
/// Part of the slope at the full step above which the step is lengthened.
const MUCH: f64 = 0.5;
/// Largest step length η.
const FARTHEST: f64 = 8.0;
/// Largest factor between a step length and the next longer one.
const LONGER: f64 = 4.0;
/// Most residuals evaluated for one direction.
const MOST: usize = 6;
/// Smallest step length. A direction that needs less is poor, and a new tangent is due.
const SMALLEST: f64 = 0.02;
/// The same two bounds where bodies may meet.
const MOST_TO_IMPACT: usize = 16;
const SMALLEST_TO_IMPACT: f64 = 1e-6;

/// Step length down to which a local failure shortens the step; below it the failure is reported and the increment is
/// cut.
const NEAR: f64 = 0.1;

impl LineSearch {
    /// Starts from the slope at η = 0, which is negative for a direction of descent.
    pub fn new(start: f64) -> Self {
        Self {
            start,
            low: (0.0, start),
            high: None,
            evaluations: 0,
            side: 0,
            most: MOST,
            smallest: SMALLEST,
            farthest: FARTHEST,
        }
    }

    /// Limits the step length to `farthest`.
    pub fn no_further_than(self, farthest: f64) -> Self {
        Self { farthest, ..self }
    }

    /// Allows short steps, where bodies in free flight may meet. The root is their impact, however near; a step
    /// beyond it would press one corner with the forces of the whole flight.
    pub fn to_impact(self) -> Self {
        Self {
            most: MOST_TO_IMPACT,
            smallest: SMALLEST_TO_IMPACT,
            ..self
        }
    }

    /// Searches along a direction, from the full step on. `slope` evaluates the forces at η, leaves them in place and
    /// returns s(η).
    ///
    /// # Errors
    /// The error of `slope` if no shorter step helps.
    pub(in crate::solve) fn run(
        mut self,
        mut slope: impl FnMut(f64) -> Result<f64, Rejection>,
    ) -> Result<(), Rejection> {
        let mut eta = 1.0;
        loop {
            let (found, rejected) = match slope(eta) {
                Ok(found) => (found, None),
                // A law that fails far away may succeed nearer.
                Err(why @ Rejection::Local { .. }) if eta > NEAR => (f64::NAN, Some(why)),
                Err(why) => return Err(why),
            };
            match (self.next(eta, found), rejected) {
                (Probe::Try(next), _) => eta = next,
                (Probe::Accept(_), None) => return Ok(()),
                // The step tried last has no forces. Return to the longest step that still descends, if there is one.
                (Probe::Accept(_), Some(_)) if self.low.0 > 0.0 => {
                    return slope(self.low.0).map(drop);
                }
                (Probe::Accept(_), Some(why)) => return Err(why),
            }
        }
    }

    /// Takes the slope at the step length tried last.
    pub fn next(&mut self, eta: f64, slope: f64) -> Probe {
        self.evaluations += 1;
        if slope.is_finite() && slope.abs() <= FALL * self.start.abs() {
            return Probe::Accept(eta);
        }
        // The energy still descends here. Usually the next tangent continues from this point. If most of the slope
        // remains, the tangent misses softening along the direction and would need many such steps: lengthen the
        // step.
        if slope.is_finite() && slope * self.start > 0.0 && self.high.is_none() {
            let far = eta >= self.farthest || self.evaluations >= self.most;
            if far || slope.abs() <= MUCH * self.start.abs() {
                return Probe::Accept(eta);
            }
            let (before, slope_before) = self.low;
            let fall = (slope_before - slope) / slope;
            let root = if fall > 0.0 {
                eta + (eta - before) / fall
            } else {
                f64::INFINITY
            };
            self.low = (eta, slope);
            return Probe::Try(root.min(LONGER * eta).min(self.farthest));
        }
        if self.evaluations >= self.most || eta <= self.smallest {
            return Probe::Accept(eta);
        }
        if slope.is_finite() && slope * self.start > 0.0 {
            self.low = (eta, slope);
            // Illinois method: the value at an end that stays twice is halved.
            if self.side == -1
                && let Some(high) = &mut self.high
            {
                high.1 *= 0.5;
            }
            self.side = -1;
        } else {
            self.high = Some((eta, slope));
            if self.side == 1 {
                self.low.1 *= 0.5;
            }
            self.side = 1;
        }
        let Some(high) = self.high else {
            return Probe::Accept(eta);
        };
        let width = high.0 - self.low.0;
        let secant = if high.1.is_finite() {
            self.low.0 + width * self.low.1 / (self.low.1 - high.1)
        } else {
            self.low.0 + 0.25 * width
        };
        Probe::Try(
            secant
                .max(self.low.0 + 0.05 * width)
                .min(high.0 - 0.05 * width)
                .max(self.smallest),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::LocalFailure;

    fn search(slope: impl Fn(f64) -> f64) -> (f64, usize) {
        let mut search = LineSearch::new(slope(0.0));
        let mut eta = 1.0;
        for count in 1.. {
            match search.next(eta, slope(eta)) {
                Probe::Try(next) => eta = next,
                Probe::Accept(eta) => return (eta, count),
            }
        }
        unreachable!()
    }

    #[test]
    fn a_good_step_costs_one_residual() {
        assert_eq!(search(|eta| eta - 1.0), (1.0, 1));
    }

    #[test]
    fn a_stiffening_direction_is_shortened() {
        // A gap that closes at a tenth of the step, with a stiffness 500 times as large.
        let slope = |eta: f64| -1.0 + eta + 500.0 * (eta - 0.1_f64).max(0.0);
        let (eta, count) = search(slope);
        assert!(slope(eta).abs() < 0.5, "slope {} at {eta}", slope(eta));
        assert!(count <= MOST);
    }

    #[test]
    fn a_softening_direction_is_lengthened() {
        let (eta, count) = search(|eta| 0.2 * eta - 1.0);
        assert!((4.0..=6.0).contains(&eta), "{eta}"); // to a fifth of the slope
        assert!(count <= 3, "{count}");
        // The slope never changes sign: the step length reaches its bound.
        assert_eq!(search(|_| -1.0).0, FARTHEST);
        // The slope falls enough for the next tangent.
        assert_eq!(search(|eta| 0.6 * eta - 1.0), (1.0, 1));
    }

    #[test]
    fn nan_beyond_the_full_step_leads_back_to_it() {
        let (eta, _) = search(|eta| if eta > 2.5 { f64::NAN } else { 0.5 * eta - 1.2 });
        assert!((1.0..=2.5).contains(&eta), "{eta}");
    }

    /// If the law fails at the last point tried, the search returns to a point whose forces are known.
    #[test]
    fn a_search_never_ends_where_the_law_failed() {
        let failed = || Rejection::Local {
            element: 0,
            why: LocalFailure::StrainNotFinite,
        };
        // The slope falls slowly up to the full step, and the law fails beyond it.
        let mut tried = Vec::new();
        let search = LineSearch::new(-1.0).run(|eta| {
            tried.push(eta);
            if eta > 1.0 {
                Err(failed())
            } else {
                Ok(0.1 * eta - 1.0)
            }
        });
        assert!(search.is_ok(), "{search:?}");
        assert_eq!(tried.len(), MOST + 1);
        assert!(tried[MOST - 1] > 1.0 && tried[MOST] == 1.0, "{tried:?}");
        // The law fails everywhere: its own error is returned.
        let search = LineSearch::new(-1.0).run(|_| Err(failed()));
        assert!(matches!(search, Err(Rejection::Local { .. })), "{search:?}");
    }

    #[test]
    fn nan_shortens_the_step() {
        let (eta, _) = search(|eta| if eta > 0.3 { f64::NAN } else { eta - 0.3 });
        assert!(eta <= 0.3);
    }
}
