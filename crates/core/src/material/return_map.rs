//! The scalar return map (theory B.1) and its derivatives (B.2).
//!
//! The plastic flow keeps the principal directions of the trial stress, so every quantity of the
//! end of the step is an explicit function of the multiplier λ:
//!
//! ```text
//! R1: q (1 + 3Gλ/A) = q_tr, A² = a² + q²;  σ_m = σ_m,tr − K T λ;  σ_i = η s_i + σ_m, η = q/q_tr
//! R2: f(λ) = q + 3α σ_m + β⟨σ_max⟩ − γ⟨−σ_max⟩ − (1−α) σ̄_c = 0
//! ```

use super::damage_plasticity::DamagePlasticity;
use super::law::LocalFailure;
use super::uniaxial::CurvePoint;

/// Trial state in invariants.
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
}

/// A change of the trial state, or of λ.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Variation {
    pub mean: f64,
    pub q: f64,
    pub s: [f64; 3],
    pub lambda: f64,
}

/// State at one λ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub lambda: f64,
    pub q: f64,
    /// A = √(a² + q²).
    pub a: f64,
    /// η = q/q_tr.
    pub eta: f64,
    pub mean: f64,
    /// Effective principal stresses.
    pub stress: [f64; 3],
    /// r(σ̄).
    pub r: f64,
    /// Largest and smallest flow direction N, unclipped.
    pub n_max: f64,
    pub n_min: f64,
    pub kappa_t: f64,
    pub kappa_c: f64,
    pub tension: CurvePoint,
    pub compression: CurvePoint,
    /// (1−α) F.
    pub f: f64,
}

/// Derivatives of a [`Point`] along a [`Variation`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Slope {
    pub eta: f64,
    pub mean: f64,
    pub r: f64,
    pub kappa_t: f64,
    pub kappa_c: f64,
    pub f: f64,
}

/// r = Σ⟨σ_i⟩/Σ|σ_i|, 0 without stress (theory A.4).
pub(super) fn weight(stress: &[f64; 3]) -> f64 {
    let sum: f64 = stress.iter().map(|s| s.abs()).sum();
    if sum > 0.0 {
        stress.iter().map(|s| s.max(0.0)).sum::<f64>() / sum
    } else {
        0.0
    }
}

impl DamagePlasticity {
    /// q(λ) of R1, by Newton from below where the concave function rises monotonically.
    fn mises(&self, q_trial: f64, lambda: f64) -> f64 {
        if lambda == 0.0 || q_trial == 0.0 {
            return q_trial;
        }
        let (a, g3) = (self.a, 3.0 * self.shear * lambda);
        if a == 0.0 {
            return (q_trial - g3).max(0.0);
        }
        // The flow takes at most 3Gλ, and at least as much as at q_tr: a start from below.
        let mut q = (q_trial - g3).max(q_trial / (1.0 + g3 / a)).max(0.0);
        for _ in 0..60 {
            let root = (a * a + q * q).sqrt();
            let residual = q * (1.0 + g3 / root) - q_trial;
            let slope = 1.0 + g3 * a * a / (root * root * root);
            let step = residual / slope;
            q = (q - step).clamp(0.0, q_trial);
            if step.abs() <= 2.0 * f64::EPSILON * q_trial {
                break;
            }
        }
        q
    }

    /// State at λ.
    pub(super) fn point(&self, trial: &TrialStress, lambda: f64) -> Point {
        let q = self.mises(trial.q, lambda);
        let a = (self.a * self.a + q * q).sqrt();
        let eta = if trial.q > 0.0 { q / trial.q } else { 1.0 };
        let mean = trial.mean - self.bulk * self.dilation * lambda;
        let stress = trial.s.map(|s| eta * s + mean);
        let r = weight(&stress);
        let flow = |s: f64| {
            let deviatoric = if a > 0.0 { 1.5 * eta * s / a } else { 0.0 };
            deviatoric + self.dilation / 3.0
        };
        let (n_max, n_min) = (flow(trial.s[0]), flow(trial.s[2]));
        let kappa_t = trial.kappa_t + lambda * r * n_max.max(0.0);
        let kappa_c = trial.kappa_c + lambda * (1.0 - r) * (-n_min).max(0.0);
        let tension = self.tension.at(kappa_t);
        let compression = self.compression.at(kappa_c);
        let beta =
            (1.0 - self.alpha) * compression.effective / tension.effective - (1.0 + self.alpha);
        let largest = stress[0];
        let slope = if largest >= 0.0 { beta } else { self.gamma };
        let f = q + 3.0 * self.alpha * mean + slope * largest
            - (1.0 - self.alpha) * compression.effective;
        Point {
            lambda,
            q,
            a,
            eta,
            mean,
            stress,
            r,
            n_max,
            n_min,
            kappa_t,
            kappa_c,
            tension,
            compression,
            f,
        }
    }

    /// Derivatives at a point along a change of trial state and λ (theory B.2).
    pub(super) fn slope(&self, trial: &TrialStress, p: &Point, v: &Variation) -> Slope {
        let (g, lambda) = (self.shear, p.lambda);
        let cubed = p.a * p.a * p.a;
        let (mut dq, mut deta) = (0.0, 0.0);
        if trial.q > 0.0 && p.a > 0.0 {
            let dr1 = 1.0 + 3.0 * g * lambda * self.a * self.a / cubed;
            dq = (v.q - 3.0 * g * p.q / p.a * v.lambda) / dr1;
            deta = (dq - p.eta * v.q) / trial.q;
        }
        let dmean = v.mean - self.bulk * self.dilation * v.lambda;
        let ds = |i: usize| trial.s[i] * deta + p.eta * v.s[i];
        let stress = [0, 1, 2].map(|i| ds(i) + dmean);
        let sum: f64 = p.stress.iter().map(|s| s.abs()).sum();
        let mut dr = 0.0;
        if sum > 0.0 {
            for i in 0..3 {
                let s = p.stress[i];
                let positive = if s > 0.0 { 1.0 } else { 0.0 };
                let sign = if s == 0.0 { 0.0 } else { s.signum() };
                dr += (positive - p.r * sign) * stress[i] / sum;
            }
        }
        let dn = |i: usize| {
            if p.a > 0.0 {
                1.5 * (ds(i) / p.a - p.eta * trial.s[i] * p.q * dq / cubed)
            } else {
                0.0
            }
        };
        let mut slope = Slope {
            eta: deta,
            mean: dmean,
            r: dr,
            ..Slope::default()
        };
        if p.n_max > 0.0 {
            slope.kappa_t = p.r * p.n_max * v.lambda + lambda * (p.n_max * dr + p.r * dn(0));
        }
        if p.n_min < 0.0 {
            slope.kappa_c =
                -(1.0 - p.r) * p.n_min * v.lambda + lambda * (p.n_min * dr - (1.0 - p.r) * dn(2));
        }
        let dsc = p.compression.effective_slope * slope.kappa_c;
        let dst = p.tension.effective_slope * slope.kappa_t;
        let (sc, st) = (p.compression.effective, p.tension.effective);
        let largest = p.stress[0];
        let (factor, dbeta) = if largest >= 0.0 {
            let beta = (1.0 - self.alpha) * sc / st - (1.0 + self.alpha);
            (beta, (1.0 - self.alpha) * (dsc / st - sc * dst / (st * st)))
        } else {
            (self.gamma, 0.0)
        };
        slope.f = dq + 3.0 * self.alpha * dmean + dbeta * largest.max(0.0) + factor * stress[0]
            - (1.0 - self.alpha) * dsc;
        slope
    }

    /// Root of f(λ) beyond a trial state with f(0) > 0: Newton inside a bracket.
    pub(super) fn solve(&self, trial: &TrialStress) -> Result<Point, LocalFailure> {
        let tolerance = 1e-12 * self.compression.first_yield();
        let along = Variation {
            lambda: 1.0,
            ..Variation::default()
        };
        let start = self.point(trial, 0.0);
        let (mut low, mut high) = (0.0, start.f / (3.0 * self.shear));
        // f → −∞: doubling ends.
        let mut doublings = 0;
        while self.point(trial, high).f > 0.0 {
            low = high;
            high *= 2.0;
            doublings += 1;
            if doublings > 200 || !high.is_finite() {
                return Err(LocalFailure::ReturnMap { residual: start.f });
            }
        }
        let mut p = self.point(trial, low);
        let mut best = p;
        for _ in 0..200 {
            if p.f.abs() < best.f.abs() {
                best = p;
            }
            // At the sixth digit below the tolerance Newton has converged; the last bits are free.
            if p.f.abs() <= 1e-3 * tolerance || high - low <= 4.0 * f64::EPSILON * high {
                break;
            }
            if p.f > 0.0 {
                low = p.lambda;
            } else {
                high = p.lambda;
            }
            let next = p.lambda - p.f / self.slope(trial, &p, &along).f;
            let inside = next > low && next < high;
            p = self.point(trial, if inside { next } else { 0.5 * (low + high) });
        }
        if p.f.abs() < best.f.abs() {
            best = p;
        }
        // A bracket of two neighbouring numbers is all there is to find, whatever f is there.
        if best.f.abs() <= tolerance.max(1e-9 * trial.q) {
            Ok(best)
        } else {
            Err(LocalFailure::ReturnMap { residual: best.f })
        }
    }
}
