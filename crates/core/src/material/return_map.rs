//! The scalar return map (theory/return-map.md, eqs 1 to 8) and its derivatives (eqs 9 to 14).
//!
//! Plastic flow preserves the principal directions of the trial stress. Every quantity at the end of the step is
//! therefore an explicit function of the multiplier λ:
//!
//! ```text
//! R1: q (1 + 3Gλ/A) = q_tr, A² = a² + q²;  σ_m = σ_m,tr − K T λ;  σ_i = η s_i + σ_m, η = q/q_tr
//! R2: f(λ) = q + 3α σ_m + β⟨σ_max⟩ − γ⟨−σ_max⟩ − (1−α) σ̄_c = 0
//! ```
//!
//! With φ = λη/A = (1−η)/3G the principal plastic strains of the step are λN_i = (3/2) φ s_i + λT/3. They remain
//! defined for q = 0 and A = 0. A hydrostatic trial stress, or the vertex of the cone without eccentricity, needs no
//! special case.

use nalgebra::SVector;

use super::damage_plasticity::DamagePlasticity;
use super::law::LocalFailure;
use super::uniaxial::CurvePoint;

/// Trial state in invariants [MPa].
#[derive(Clone, Copy, Debug)]
pub(super) struct TrialStress {
    /// Mean stress.
    pub mean: f64,
    /// von Mises stress.
    pub q: f64,
    /// Principal deviatoric stresses, descending.
    pub s: [f64; 3],
    /// κ at the start of the step.
    pub kappa_t: f64,
    pub kappa_c: f64,
    /// Indices of the curves of its bands, in tension and in compression.
    pub curve_index: [usize; 2],
}

/// Derivatives of trial state and λ by `N` variables.
#[derive(Clone, Copy, Debug)]
pub(super) struct Variation<const N: usize> {
    pub mean: SVector<f64, N>,
    pub q: SVector<f64, N>,
    pub s: [SVector<f64, N>; 3],
    pub lambda: SVector<f64, N>,
}

impl Variation<1> {
    /// Derivative by λ at constant trial stress.
    pub fn along_lambda() -> Self {
        let zero = SVector::zeros();
        Self {
            mean: zero,
            q: zero,
            s: [zero; 3],
            lambda: SVector::<f64, 1>::new(1.0),
        }
    }
}

/// State at a given λ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub lambda: f64,
    /// A = √(a² + q²) [MPa].
    pub a: f64,
    /// η = q/q_tr.
    pub eta: f64,
    /// φ = λη/A = (1−η)/3G [1/MPa].
    pub phi: f64,
    /// Effective mean stress [MPa].
    pub mean: f64,
    /// Effective principal stresses [MPa].
    pub stress: [f64; 3],
    /// r(σ̄).
    pub r: f64,
    /// Largest and smallest principal plastic strain of the step, not clipped at 0.
    pub strain_max: f64,
    pub strain_min: f64,
    pub kappa_t: f64,
    pub kappa_c: f64,
    pub tension: CurvePoint,
    pub compression: CurvePoint,
    /// (1−α) F [MPa].
    pub f: f64,
}

/// Derivatives of a [`Point`] for a [`Variation`].
#[derive(Clone, Copy, Debug)]
pub(super) struct Slope<const N: usize> {
    pub eta: SVector<f64, N>,
    pub r: SVector<f64, N>,
    pub kappa_t: SVector<f64, N>,
    pub kappa_c: SVector<f64, N>,
    pub f: SVector<f64, N>,
}

/// r = Σ⟨σ_i⟩/Σ|σ_i|; 0 at zero stress (theory/damage-plasticity.md, eq. 7).
#[inline(always)]
pub(super) fn weight(stress: &[f64; 3]) -> f64 {
    let sum = stress[0].abs() + stress[1].abs() + stress[2].abs();
    if sum > 0.0 {
        (stress[0].max(0.0) + stress[1].max(0.0) + stress[2].max(0.0)) / sum
    } else {
        0.0
    }
}

impl Point {
    /// Elastic end of a step in which r is not needed and f is at most `bound`.
    pub fn elastic(
        mean: f64,
        tension: CurvePoint,
        compression: CurvePoint,
        kappa_t: f64,
        kappa_c: f64,
        bound: f64,
    ) -> Self {
        Self {
            lambda: 0.0,
            a: 0.0,
            eta: 1.0,
            phi: 0.0,
            mean,
            stress: [0.0; 3],
            r: 0.0,
            strain_max: 0.0,
            strain_min: 0.0,
            kappa_t,
            kappa_c,
            tension,
            compression,
            f: bound,
        }
    }
}

impl DamagePlasticity {
    /// q(λ) of R1 by Newton's method, from below, where the concave function increases.
    #[inline(always)]
    fn mises(&self, q_trial: f64, lambda: f64) -> f64 {
        if lambda == 0.0 || q_trial == 0.0 {
            return q_trial;
        }
        let (a, g3) = (self.a, 3.0 * self.shear * lambda);
        if a == 0.0 {
            return (q_trial - g3).max(0.0);
        }
        // Start from below: the flow reduces q by at most 3Gλ, and at most by the factor that holds at q = 0.
        let mut q = (q_trial - g3).max(q_trial / (1.0 + g3 / a)).max(0.0);
        for _ in 0..60 {
            let square = a * a + q * q;
            let share = g3 / square.sqrt();
            let residual = q * (1.0 + share) - q_trial;
            let step = residual / (1.0 + share * a * a / square);
            q = (q - step).max(0.0).min(q_trial);
            // Newton's method converges quadratically: after a step of 1e-9 the error is below rounding.
            if step.abs() <= 1e-9 * q {
                break;
            }
        }
        q
    }

    /// State at λ.
    #[inline(always)]
    pub(super) fn point(&self, trial: &TrialStress, lambda: f64) -> Point {
        let q = self.mises(trial.q, lambda);
        let a = (self.a * self.a + q * q).sqrt();
        let g3 = 3.0 * self.shear;
        let eta = if trial.q > 0.0 {
            q / trial.q
        } else if a > 0.0 {
            1.0 / (1.0 + g3 * lambda / a)
        } else {
            1.0
        };
        let phi = if a > 0.0 {
            lambda * eta / a
        } else {
            (1.0 - eta) / g3
        };
        self.state(trial, lambda, q, a, eta, phi)
    }

    /// State at μ = 1 − η = 3Gφ, from which λ = μA/3Gη is explicit. All states except the vertex of a cone have μ <
    /// 1.
    #[inline(always)]
    fn point_at(&self, trial: &TrialStress, mu: f64) -> Point {
        let eta = 1.0 - mu;
        let q = eta * trial.q;
        let a = (self.a * self.a + q * q).sqrt();
        let phi = mu * (1.0 / (3.0 * self.shear));
        self.state(trial, phi / eta * a, q, a, eta, phi)
    }

    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the quantities that define a point on the yield surface"
    )]
    fn state(&self, trial: &TrialStress, lambda: f64, q: f64, a: f64, eta: f64, phi: f64) -> Point {
        let mean = trial.mean - self.bulk * self.dilation * lambda;
        let s = &trial.s;
        let stress = [eta * s[0] + mean, eta * s[1] + mean, eta * s[2] + mean];
        let r = weight(&stress);
        let strain = |s: f64| 1.5 * phi * s + lambda * self.dilation / 3.0;
        let (strain_max, strain_min) = (strain(trial.s[0]), strain(trial.s[2]));
        let kappa_t = trial.kappa_t + r * strain_max.max(0.0);
        let kappa_c = trial.kappa_c + (1.0 - r) * (-strain_min).max(0.0);
        let tension = self.curves.tension.curve(trial.curve_index[0]).at(kappa_t);
        let compression = self
            .curves
            .compression
            .curve(trial.curve_index[1])
            .at(kappa_c);
        let f = self.yield_value(q, mean, stress[0], &tension, &compression);
        Point {
            lambda,
            a,
            eta,
            phi,
            mean,
            stress,
            r,
            strain_max,
            strain_min,
            kappa_t,
            kappa_c,
            tension,
            compression,
            f,
        }
    }

    /// (1−α) F (theory/damage-plasticity.md, eq. 2) [MPa].
    #[inline(always)]
    pub(super) fn yield_value(
        &self,
        q: f64,
        mean: f64,
        largest: f64,
        tension: &CurvePoint,
        compression: &CurvePoint,
    ) -> f64 {
        let slope = if largest >= 0.0 {
            self.beta(tension, compression)
        } else {
            self.gamma
        };
        q + 3.0 * self.alpha * mean + slope * largest - (1.0 - self.alpha) * compression.effective
    }

    /// β (theory/damage-plasticity.md, eq. 2).
    #[inline(always)]
    pub(super) fn beta(&self, tension: &CurvePoint, compression: &CurvePoint) -> f64 {
        (1.0 - self.alpha) * compression.effective / tension.effective - (1.0 + self.alpha)
    }

    /// Derivatives at a point for a change of trial state and λ (theory/return-map.md, eqs 10 to 14).
    #[inline(always)]
    pub(super) fn slope<const N: usize>(
        &self,
        trial: &TrialStress,
        p: &Point,
        v: &Variation<N>,
    ) -> Slope<N> {
        let g3 = 3.0 * self.shear;
        let q = p.eta * trial.q;
        // R1: dη (1 + 3Gλ a²/A³) = (1−η) η q/A² dq_tr − 3Gη/A dλ; at the vertex of a cone dη = 0.
        let deta = if p.a > 0.0 {
            let share = self.a * self.a / (p.a * p.a);
            let by_q = g3 * p.phi * p.eta * q / (p.a * p.a);
            (v.q * by_q - v.lambda * (g3 * p.eta / p.a)) / (1.0 + g3 * p.lambda / p.a * share)
        } else {
            SVector::zeros()
        };
        let dphi = deta * (-1.0 / g3);
        let dq = v.q * p.eta + deta * trial.q;
        let dmean = v.mean - v.lambda * (self.bulk * self.dilation);
        let stress = |i: usize| deta * trial.s[i] + v.s[i] * p.eta + dmean;
        let sum: f64 = p.stress.iter().map(|s| s.abs()).sum();
        let mut dr = SVector::zeros();
        if sum > 0.0 {
            for i in 0..3 {
                let s = p.stress[i];
                let positive = if s > 0.0 { 1.0 } else { 0.0 };
                let sign = if s == 0.0 { 0.0 } else { s.signum() };
                dr += stress(i) * ((positive - p.r * sign) / sum);
            }
        }
        let strain = |i: usize| {
            (v.s[i] * p.phi + dphi * trial.s[i]) * 1.5 + v.lambda * (self.dilation / 3.0)
        };
        let (mut kappa_t, mut kappa_c) = (SVector::zeros(), SVector::zeros());
        if p.strain_max > 0.0 {
            kappa_t = dr * p.strain_max + strain(0) * p.r;
        }
        if p.strain_min < 0.0 {
            kappa_c = dr * p.strain_min - strain(2) * (1.0 - p.r);
        }
        let dst = kappa_t * p.tension.effective_slope;
        let dsc = kappa_c * p.compression.effective_slope;
        let largest = p.stress[0];
        let dlargest = stress(0);
        let by_largest = if largest >= 0.0 {
            let (st, sc) = (p.tension.effective, p.compression.effective);
            let dbeta = (dsc - dst * (sc / st)) * ((1.0 - self.alpha) / st);
            dlargest * self.beta(&p.tension, &p.compression) + dbeta * largest
        } else {
            dlargest * self.gamma
        };
        let f = dq + dmean * (3.0 * self.alpha) + by_largest - dsc * (1.0 - self.alpha);
        Slope {
            eta: deta,
            r: dr,
            kappa_t,
            kappa_c,
            f,
        }
    }

    /// Root of f(λ) from a trial state `start` with f(0) > 0.
    #[inline(always)]
    pub(super) fn solve(&self, trial: &TrialStress, start: &Point) -> Result<Point, LocalFailure> {
        // The tolerance of theory/return-map.md, Decisions, "Tolerances", plus rounding of the trial stress.
        let rounding = 8.0 * f64::EPSILON * (trial.q + trial.mean.abs());
        let tolerance = (1e-12 * self.compression().first_yield()).max(rounding);
        self.along_curve(trial, start, tolerance)
            .map_or_else(|| self.bracketed(trial, start, tolerance), Ok)
    }

    /// Newton's method in μ. There λ is explicit and, for q well above a, f is nearly as linear as in λ. `None` if an
    /// iterate leaves the bracket or convergence is slow.
    #[inline(always)]
    fn along_curve(&self, trial: &TrialStress, start: &Point, tolerance: f64) -> Option<Point> {
        // Below this value f is rounding and another step gains nothing.
        let exact = 2.0 * f64::EPSILON * trial.q;
        let (mut low, mut high) = (0.0, 1.0);
        let (mut p, mut mu) = (*start, 0.0);
        for _ in 0..MOST_STEPS {
            let next = mu - p.f / self.fall(trial, &p);
            // One more Newton step reduces the error far below the tolerance.
            let done = p.f.abs() <= tolerance;
            // A comparison with NaN is false, so that NaN counts as outside.
            if !(next > low && next < high) {
                return done.then_some(p);
            }
            let before = p;
            p = self.point_at(trial, next);
            if done {
                let better = p.f.abs() < before.f.abs();
                return Some(if better { p } else { before });
            }
            if p.f.abs() <= exact {
                return Some(p);
            }
            mu = next;
            if p.f > 0.0 {
                low = mu;
            } else {
                high = mu;
            }
        }
        None
    }

    /// df/dμ: [`Self::slope`] along μ, with common terms computed once.
    #[inline(always)]
    fn fall(&self, trial: &TrialStress, p: &Point) -> f64 {
        let one_by_g3 = 1.0 / (3.0 * self.shear);
        let a2 = self.a * self.a;
        // dη = −dμ, 3G dφ = dμ, and dλ follows from λ = φ A/η.
        let by_eta = 1.0 / p.eta;
        let lambda = (p.a + p.phi * 3.0 * self.shear * by_eta * a2 / p.a) * (by_eta * one_by_g3);
        let mean = -self.bulk * self.dilation * lambda;
        let s = &trial.s;
        let stress = [mean - s[0], mean - s[1], mean - s[2]];
        let sum = p.stress[0].abs() + p.stress[1].abs() + p.stress[2].abs();
        let by_sum = if sum > 0.0 { 1.0 / sum } else { 0.0 };
        let mut r = 0.0;
        for (s, ds) in p.stress.iter().zip(stress) {
            let positive = if *s > 0.0 { 1.0 - p.r } else { p.r };
            r += ds * if *s == 0.0 { 0.0 } else { positive };
        }
        r *= by_sum;
        let volume = lambda * self.dilation / 3.0;
        let strain = |s: f64| 1.5 * one_by_g3 * s + volume;
        let (mut tension, mut compression) = (0.0, 0.0);
        if p.strain_max > 0.0 {
            tension = p.tension.effective_slope * (r * p.strain_max + strain(trial.s[0]) * p.r);
        }
        if p.strain_min < 0.0 {
            let by_strain = strain(trial.s[2]) * (1.0 - p.r);
            compression = p.compression.effective_slope * (r * p.strain_min - by_strain);
        }
        let one = 1.0 - self.alpha;
        let by_largest = if p.stress[0] >= 0.0 {
            let share = 1.0 / p.tension.effective;
            let ratio = p.compression.effective * share;
            let beta = one * ratio - (1.0 + self.alpha);
            stress[0] * beta + (compression - tension * ratio) * (one * share) * p.stress[0]
        } else {
            stress[0] * self.gamma
        };
        3.0 * self.alpha * mean - trial.q + by_largest - one * compression
    }

    /// Newton's method with a bracket. A bracket exists because f decreases to −∞ for T > 0; bisection is used only
    /// if Newton's method leaves it.
    #[cold]
    #[inline(never)]
    fn bracketed(
        &self,
        trial: &TrialStress,
        start: &Point,
        tolerance: f64,
    ) -> Result<Point, LocalFailure> {
        let along = Variation::along_lambda();
        let newton = |p: &Point| p.lambda - p.f / self.slope(trial, p, &along).f[0];
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut p = *start;
        for _ in 0..300 {
            let mut next = newton(&p);
            // A comparison with NaN is false, so that NaN counts as outside.
            if !(next > low && next < high) {
                next = if high.is_finite() {
                    0.5 * (low + high)
                } else {
                    (2.0 * low).max(start.f / (3.0 * self.shear))
                };
            }
            if next <= low || next >= high || !next.is_finite() {
                // The bracket has shrunk to two adjacent floating-point numbers.
                let found = high.is_finite() && p.f.is_finite();
                return if found { Ok(p) } else { Err(refused(&p)) };
            }
            p = self.point(trial, next);
            if p.f > 0.0 {
                low = next;
            } else {
                high = next;
            }
            if p.f.abs() <= tolerance {
                // One more Newton step reduces the error far below the tolerance.
                let polished = self.point(trial, newton(&p).max(0.0));
                return Ok(if polished.f.abs() < p.f.abs() {
                    polished
                } else {
                    p
                });
            }
        }
        Err(refused(&p))
    }
}

/// Largest number of Newton steps in μ; five are usual.
const MOST_STEPS: usize = 12;

fn refused(p: &Point) -> LocalFailure {
    LocalFailure::ReturnMap { residual: p.f }
}

#[cfg(test)]
mod tests;
