//! Energy line search as a root find in one dimension.
//!
//! Along the Newton direction d, s(η) = d·r(q + η d) is the slope of the energy. A norm of r may
//! grow where the slope falls (the window of stick is 2 f/k_s ≈ 4e-6 mm wide), so the norm is not
//! looked at. A residual costs a tenth of a factorisation: a few are well spent.

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
}

/// Accepted fall of the slope: a looser root takes more solves, a tighter one saves none
/// (docs/decisions.md).
const FALL: f64 = 0.2;
/// Most residuals spent on one direction.
const MOST: usize = 6;
/// Smallest step: below it, the direction is bad and a new tangent is due.
const SMALLEST: f64 = 0.02;

impl LineSearch {
    /// Starts from the slope at η = 0 (negative for a direction of descent).
    pub fn new(start: f64) -> Self {
        Self {
            start,
            low: (0.0, start),
            high: None,
            evaluations: 0,
            side: 0,
        }
    }

    /// Takes the slope at the last tried η.
    pub fn next(&mut self, eta: f64, slope: f64) -> Probe {
        self.evaluations += 1;
        if slope.is_finite() && slope.abs() <= FALL * self.start.abs() {
            return Probe::Accept(eta);
        }
        // Still descending at the full step: take it, the next tangent goes on from there.
        if slope.is_finite() && slope * self.start > 0.0 && self.high.is_none() {
            return Probe::Accept(eta);
        }
        if self.evaluations >= MOST || eta <= SMALLEST {
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
                .clamp(self.low.0 + 0.05 * width, high.0 - 0.05 * width)
                .max(SMALLEST),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn not_a_number_shortens_the_step() {
        let (eta, _) = search(|eta| if eta > 0.3 { f64::NAN } else { eta - 0.3 });
        assert!(eta <= 0.3);
    }
}
