//! Energy line search as a root find in one dimension.
//!
//! Along the Newton direction d, s(η) = d·r(q + η d) is the slope of the energy. A norm of r may
//! grow where the slope falls (the window of stick is 2 f/k_s ≈ 4e-6 mm wide), so the norm is not
//! looked at. A residual costs a tenth of a factorisation: a few are well spent.

use super::outcome::Refusal;
/// d·r: slope of the energy along a direction d where the forces r are out of balance.
pub(in crate::solve) use crate::linear::dot;

/// What to do next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Probe {
    /// Evaluate the slope here.
    Try(f64),
    /// Take this step, evaluated last.
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

/// Accepted fall of the slope: a looser root takes more solves, a tighter one saves none
/// (docs/decisions/line-search.md).
const FALL: f64 = 0.2;
/// Part of the slope that is much to be left at the full step.
const MUCH: f64 = 0.5;
/// Largest step.
const FARTHEST: f64 = 8.0;
/// Next step over one at which much of the slope was left, at most.
const LONGER: f64 = 4.0;
/// Most residuals spent on one direction.
const MOST: usize = 6;
/// Smallest step: below it, the direction is bad and a new tangent is due.
const SMALLEST: f64 = 0.02;
/// The same where bodies may meet.
const MOST_TO_IMPACT: usize = 16;
const SMALLEST_TO_IMPACT: f64 = 1e-6;

/// A law that fails at a shorter step fails: the increment is cut.
const NEAR: f64 = 0.1;

impl LineSearch {
    /// Starts from the slope at η = 0 (negative for a direction of descent).
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

    /// Searches no further than `farthest` times the step.
    pub fn no_further_than(self, farthest: f64) -> Self {
        Self { farthest, ..self }
    }

    /// Searches where bodies in free flight may meet: the root is where they do, however near, and a step
    /// beyond it would press one corner with the weight of the whole flight.
    pub fn to_impact(self) -> Self {
        Self {
            most: MOST_TO_IMPACT,
            smallest: SMALLEST_TO_IMPACT,
            ..self
        }
    }

    /// Searches along a direction from the full step on: `slope` goes to η, leaves the forces there and tells s(η).
    ///
    /// # Errors
    /// That of `slope` where no shorter step helps.
    pub(in crate::solve) fn run(
        mut self,
        mut slope: impl FnMut(f64) -> Result<f64, Refusal>,
    ) -> Result<(), Refusal> {
        let mut eta = 1.0;
        loop {
            let (found, refused) = match slope(eta) {
                Ok(found) => (found, None),
                // A law that fails far away may answer nearer.
                Err(why @ Refusal::Local { .. }) if eta > NEAR => (f64::NAN, Some(why)),
                Err(why) => return Err(why),
            };
            match (self.next(eta, found), refused) {
                (Probe::Try(next), _) => eta = next,
                (Probe::Accept(_), None) => return Ok(()),
                // The last one tried has no forces: the farthest that descends has, if there is one.
                (Probe::Accept(_), Some(_)) if self.low.0 > 0.0 => {
                    return slope(self.low.0).map(drop);
                }
                (Probe::Accept(_), Some(why)) => return Err(why),
            }
        }
    }

    /// Takes the slope at the last tried η.
    pub fn next(&mut self, eta: f64, slope: f64) -> Probe {
        self.evaluations += 1;
        if slope.is_finite() && slope.abs() <= FALL * self.start.abs() {
            return Probe::Accept(eta);
        }
        // Still descending: the next tangent goes on from there, unless most of the slope is left. Then the
        // tangent knows nothing of what softens along the direction, and would take many such steps.
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
            // Illinois: an end that stays twice loses half its weight.
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
        // A gap that closes at a tenth of the step with a stiffness 500 times as large.
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
        // It never rises: a bounded step.
        assert_eq!(search(|_| -1.0).0, FARTHEST);
        // Quick enough for the next tangent.
        assert_eq!(search(|eta| 0.6 * eta - 1.0), (1.0, 1));
    }

    #[test]
    fn not_a_number_beyond_the_full_step_leads_back() {
        let (eta, _) = search(|eta| if eta > 2.5 { f64::NAN } else { 0.5 * eta - 1.2 });
        assert!((1.0..=2.5).contains(&eta), "{eta}");
    }

    /// Where the last point that may be tried has no answer, the forces that are left are those of one that has.
    #[test]
    fn a_search_never_ends_where_the_law_failed() {
        let failed = || Refusal::Local {
            element: 0,
            why: LocalFailure::StrainNotFinite,
        };
        // It falls slowly up to the full step, and there is nothing beyond.
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
        // Nothing at all: the law's own refusal.
        let search = LineSearch::new(-1.0).run(|_| Err(failed()));
        assert!(matches!(search, Err(Refusal::Local { .. })), "{search:?}");
    }

    #[test]
    fn not_a_number_shortens_the_step() {
        let (eta, _) = search(|eta| if eta > 0.3 { f64::NAN } else { eta - 0.3 });
        assert!(eta <= 0.3);
    }
}
