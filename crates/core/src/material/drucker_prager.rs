//! Smooth hyperbolic Drucker–Prager plasticity with softening for stone and soil (theory/drucker-prager.md).
//!
//! ```text
//! F = √(q² + a²y²) + η σ_m − k y                                                                   (1)
//! G = √(q² + a²y²) + η̄ σ_m                                                                         (5)
//! y = r + (1 − r) e^(−ω),   dω = (σ : dε_p) ℓ/(y 𝒢)                                                (7, 8)
//! ```

use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

use super::hooke;
use super::law::{LocalFailure, MaterialHistory, Response};
use super::parameters::{DruckerPragerParameters, ElasticParameters};
use super::screen::{bits, hooke_by_point};
use super::solid_law::{Increment, LawOutput, Slot, SolidLaw};
use super::uniaxial::{Branch, TableError};
use super::{Wanted, elastic_stiffness};
use crate::tensor::{self, ByPoint};

/// Residual strength divided by the initial strength. It keeps the surface smooth and the point sufficiently stiff.
pub const RESIDUAL: f64 = 1e-3;
/// A step is plastic if the yield function exceeds this fraction of k: rounding of stresses some hundred times the
/// strength.
const YIELD: f64 = 1e-10;
/// Most Newton steps or bisections of either loop. Sixty bisections exhaust the precision; some ten steps are usual.
const MOST_STEPS: usize = 100;

pub(super) const OUTPUTS: [LawOutput; 2] = [
    LawOutput::new("kappa_t", "1", Slot::KappaT),
    LawOutput::new("kappa_c", "1", Slot::KappaC),
];

/// The law for elements of one size.
#[derive(Clone, Debug)]
pub struct DruckerPrager {
    elastic: ElasticParameters,
    shear: f64,
    bulk: f64,
    /// η: slope of the yield surface over the mean stress [-].
    friction: f64,
    /// η̄: slope of the flow potential over the mean stress [-].
    dilation: f64,
    /// k [MPa].
    strength: f64,
    /// a [MPa].
    rounding: f64,
    /// f_t and f_c [MPa].
    uniaxial: [f64; 2],
    /// ℓ/𝒢 in tension and in compression [1/MPa]; 0 without softening.
    brittleness: [f64; 2],
}

/// Invariants of the trial stress and the softening before the step.
#[derive(Clone, Copy, Debug)]
struct Trial {
    mean: f64,
    q: f64,
    softening: f64,
}

/// State on the yield surface at a given softening.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// Plastic multiplier λ [-].
    lambda: f64,
    /// q divided by q of the trial stress [-].
    ratio: f64,
    q: f64,
    mean: f64,
    /// √(q² + a²y²) [MPa].
    root: f64,
    /// y and dy/dω [-].
    left: [f64; 2],
    /// dω/dλ [-] and its derivatives by q, σ_m and ω.
    rate: f64,
    rate_slope: [f64; 3],
    /// Fraction of the plastic work that counts as tension [-].
    weight: f64,
}

/// Slope of the Drucker–Prager cone through the compressive meridian of Mohr–Coulomb, 6 sin φ/(3 − sin φ) [-].
fn slope(angle: f64) -> f64 {
    6.0 * angle.sin() / (3.0 - angle.sin())
}

impl DruckerPragerParameters {
    /// Uniaxial compressive strength f_c = 2 c cos φ/(1 − sin φ) [MPa].
    pub fn compressive_strength(&self) -> f64 {
        let phi = self.friction_angle;
        2.0 * self.cohesion * phi.cos() / (1.0 - phi.sin())
    }

    /// Tensile strength of the sharp cone through f_c, f_c (3 − η)/(3 + η) [MPa], an upper bound of that of the law.
    pub fn largest_tensile_strength(&self) -> f64 {
        let eta = slope(self.friction_angle);
        self.compressive_strength() * (3.0 - eta) / (3.0 + eta)
    }

    /// Largest equivalent lengths for which softening in tension and in compression does not snap back, E 𝒢/f² [mm];
    /// infinite without softening.
    pub fn longest(&self) -> [f64; 2] {
        let limit = |energy: Option<f64>, f: f64| {
            energy.map_or(f64::INFINITY, |energy| self.elastic.E * energy / (f * f))
        };
        [
            limit(self.tension_energy, self.tensile_strength),
            limit(self.compression_energy, self.compressive_strength()),
        ]
    }
}

impl DruckerPrager {
    /// The law for elements of the equivalent length `l_eq` [mm]. `None` uses the `reference_length` of the
    /// parameters; if that is missing, too, there is no softening.
    ///
    /// # Errors
    /// [`TableError::TooBrittle`] if the softening would snap back in an element of this size.
    pub fn new(p: &DruckerPragerParameters, l_eq: Option<f64>) -> Result<Self, TableError> {
        let eta = slope(p.friction_angle);
        let (f_t, f_c) = (p.tensile_strength, p.compressive_strength());
        let strength = 3.0 * (f_c - f_t) * (1.0 - eta * eta / 9.0) / (2.0 * eta);
        let apart = strength - eta * f_t / 3.0;
        let length = l_eq.or(p.reference_length);
        let mut brittleness = [0.0; 2];
        let longest = p.longest();
        let of = [
            (Branch::Tension, p.tension_energy),
            (Branch::Compression, p.compression_energy),
        ];
        for (i, (branch, energy)) in of.into_iter().enumerate() {
            let Some((energy, length)) = energy.zip(length) else {
                continue;
            };
            let limit = longest[i];
            if length >= limit {
                return Err(TableError::TooBrittle {
                    branch,
                    l_eq: length,
                    l_max: limit,
                });
            }
            brittleness[i] = length / energy;
        }
        Ok(Self {
            elastic: p.elastic,
            shear: p.elastic.shear_modulus(),
            bulk: p.elastic.bulk_modulus(),
            friction: eta,
            dilation: slope(p.dilation_angle),
            strength,
            rounding: (apart * apart - f_t * f_t).max(0.0).sqrt(),
            uniaxial: [f_t, f_c],
            brittleness,
        })
    }

    /// F [MPa] at a stress [MPa] and a history (1).
    pub fn yield_function(&self, stress: &Vector6<f64>, history: &MaterialHistory) -> f64 {
        let (mean, q) = invariants(stress);
        let [y, _] = left(self.softening(history));
        self.root(q, y) + self.friction * mean - self.strength * y
    }

    /// Remaining strength divided by the initial strength, y [-].
    pub fn strength_left(&self, history: &MaterialHistory) -> f64 {
        left(self.softening(history))[0]
    }

    /// ω of the equivalent plastic strains κ_t, κ_c (11).
    fn softening(&self, history: &MaterialHistory) -> f64 {
        self.uniaxial[0] * self.brittleness[0] * history.kappa_t
            + self.uniaxial[1] * self.brittleness[1] * history.kappa_c
    }

    fn root(&self, q: f64, y: f64) -> f64 {
        let a = self.rounding * y;
        (q * q + a * a).sqrt()
    }

    /// State at μ = 3Gλ/√(q² + a²y²) for the remaining strength `left`, and F there.
    fn at(&self, trial: &Trial, mu: f64, left: [f64; 2]) -> (f64, f64, f64, f64) {
        let q = trial.q / (1.0 + mu);
        let root = self.root(q, left[0]);
        let lambda = mu * root / (3.0 * self.shear);
        let mean = trial.mean - self.bulk * self.dilation * lambda;
        let f = root + self.friction * mean - self.strength * left[0];
        (q, mean, lambda, f)
    }

    /// Root μ of F at given y. F decreases without bound from the trial state.
    fn on_surface(&self, trial: &Trial, left: [f64; 2]) -> Result<f64, LocalFailure> {
        let (three, y) = (3.0 * self.shear, left[0]);
        let exact = self.exact(trial, y);
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut mu = 0.0;
        let mut f = self.at(trial, mu, left).3;
        for _ in 0..MOST_STEPS {
            if f.abs() <= exact {
                return Ok(mu);
            }
            if f > 0.0 {
                low = mu;
            } else {
                high = mu;
            }
            let q = trial.q / (1.0 + mu);
            let root = self.root(q, y);
            let by_q = -q * q / ((1.0 + mu) * root);
            let by_lambda = (root + mu * by_q) / three;
            let fall = by_q - self.friction * self.bulk * self.dilation * by_lambda;
            let mut next = mu - f / fall;
            if !(next > low && next < high) {
                next = if high.is_finite() {
                    0.5 * (low + high)
                } else {
                    2.0 * low + 1.0
                };
            }
            if next == mu || next == low || next == high {
                return Ok(mu);
            }
            mu = next;
            f = self.at(trial, mu, left).3;
        }
        Err(LocalFailure::ReturnMap { residual: f })
    }

    /// Tolerance of F from rounding [MPa].
    fn exact(&self, trial: &Trial, y: f64) -> f64 {
        8.0 * f64::EPSILON * (trial.q + self.friction * trial.mean.abs() + self.strength * y)
    }

    /// State on the yield surface at softening ω.
    fn point(&self, trial: &Trial, softening: f64) -> Result<Point, LocalFailure> {
        let left = left(softening);
        let mu = self.on_surface(trial, left)?;
        let (q, mean, lambda, _) = self.at(trial, mu, left);
        let (root, y, dy) = (self.root(q, left[0]), left[0], left[1]);
        let a2 = self.rounding * self.rounding;
        // Fraction of tension: 0 at and below the mean stress of uniaxial compression, 1 at that of uniaxial tension.
        let part = if q > 0.0 {
            0.5 + 1.5 * mean / q
        } else {
            f64::INFINITY.copysign(mean)
        };
        let (weight, by_part) = if part <= 0.0 {
            (0.0, 0.0)
        } else if part >= 1.0 {
            (1.0, 0.0)
        } else {
            (part * part * (3.0 - 2.0 * part), 6.0 * part * (1.0 - part))
        };
        let [t, c] = self.brittleness;
        let brittle = weight * t + (1.0 - weight) * c;
        // σ : N = q²/√(…) + η̄ σ_m
        let work = q * q / root + self.dilation * mean;
        let rate = work * brittle / y;
        let mut rate_slope = [0.0; 3];
        if rate != 0.0 || by_part != 0.0 {
            let by_q = q * (2.0 / root - q * q / root.powi(3));
            let by_left = -q * q * a2 * y / root.powi(3);
            let (mut part_q, mut part_mean) = (0.0, 0.0);
            if by_part > 0.0 {
                part_q = -1.5 * mean / (q * q) * by_part * (t - c);
                part_mean = 1.5 / q * by_part * (t - c);
            }
            rate_slope = [
                (by_q * brittle + work * part_q) / y,
                (self.dilation * brittle + work * part_mean) / y,
                (by_left * brittle / y - rate / y) * dy,
            ];
        }
        Ok(Point {
            lambda,
            ratio: 1.0 / (1.0 + mu),
            q,
            mean,
            root,
            left,
            rate,
            rate_slope,
            weight,
        })
    }

    /// Derivatives of the residuals by q, λ, ω:
    ///
    /// ```text
    /// R₁ = q (1 + 3Gλ/√(q² + a²y²)) − q_tr,   R₂ = F,   R₃ = ω − ω_n − λ dω/dλ                     (14)
    /// ```
    fn jacobian(&self, p: &Point) -> Matrix3<f64> {
        let g3 = 3.0 * self.shear * p.lambda;
        let (q, root) = (p.q, p.root);
        let cube = root * root * root;
        let by_left = self.rounding * self.rounding * p.left[0] * p.left[1];
        let [m_q, m_mean, m_softening] = p.rate_slope;
        let mean = -self.bulk * self.dilation;
        Matrix3::new(
            1.0 + g3 / root - g3 * q * q / cube,
            3.0 * self.shear * q / root,
            -g3 * q * by_left / cube,
            q / root,
            self.friction * mean,
            by_left / root - self.strength * p.left[1],
            -p.lambda * m_q,
            -p.rate - p.lambda * m_mean * mean,
            1.0 - p.lambda * m_softening,
        )
    }

    /// End of a plastic step: Newton's method in ω within a bracket; each iterate lies on the yield surface.
    fn solve(&self, trial: &Trial) -> Result<(Point, f64), LocalFailure> {
        let mut softening = trial.softening;
        let mut p = self.point(trial, softening)?;
        if self.brittleness == [0.0; 2] {
            return Ok((p, softening));
        }
        let (mut low, mut high) = (softening, f64::INFINITY);
        for _ in 0..MOST_STEPS {
            let residual = softening - trial.softening - p.lambda * p.rate;
            // Tolerance: some rounding errors of ω and of its growth.
            let exact = 16.0 * f64::EPSILON * (softening + p.lambda * p.rate.abs());
            if residual.abs() <= exact {
                return Ok((p, softening));
            }
            if residual < 0.0 {
                low = softening;
            } else {
                high = softening;
            }
            let j = self.jacobian(&p);
            let slope = j.determinant() / (j.m11 * j.m22 - j.m12 * j.m21);
            let mut next = softening - residual / slope;
            if !(next > low && next < high) {
                next = if high.is_finite() {
                    0.5 * (low + high)
                } else {
                    2.0 * low + p.lambda * p.rate + 1e-6
                };
            }
            if next == softening || next == low || next == high {
                return Ok((p, softening));
            }
            softening = next;
            p = self.point(trial, softening)?;
        }
        let residual = p.rate;
        Err(LocalFailure::ReturnMap { residual })
    }

    /// D = K 1⊗1 + 2Gζ dev + s_tr ⊗ ∇ζ − K η̄ 1 ⊗ ∇λ (15).
    fn tangent(&self, trial: &Trial, deviator: &Vector6<f64>, p: &Point) -> Matrix6<f64> {
        let Some(inverse) = self.jacobian(p).try_inverse() else {
            return elastic_stiffness(&self.elastic) * p.ratio;
        };
        let mean = tensor::UNIT * self.bulk;
        let by_q = if trial.q > 0.0 {
            deviator * (3.0 * self.shear / trial.q)
        } else {
            Vector6::zeros()
        };
        // Derivatives of R by q_tr and σ_m,tr, with the opposite sign.
        let along_q = inverse * Vector3::new(1.0, 0.0, 0.0);
        let along_mean = inverse * Vector3::new(0.0, -self.friction, p.lambda * p.rate_slope[1]);
        let gradient = |i: usize| by_q * along_q[i] + mean * along_mean[i];
        let (q, lambda) = (gradient(0), gradient(1));
        let mut d = Matrix6::zeros();
        let shear = self.shear * p.ratio;
        for i in 0..3 {
            for j in 0..3 {
                d[(i, j)] = self.bulk - 2.0 / 3.0 * shear;
            }
            d[(i, i)] += 2.0 * shear;
            d[(3 + i, 3 + i)] = shear;
        }
        if trial.q > 0.0 {
            d += deviator * ((q - by_q * p.ratio) / trial.q).transpose();
        }
        d - tensor::UNIT * (self.bulk * self.dilation) * lambda.transpose()
    }
}

impl SolidLaw for DruckerPrager {
    fn name(&self) -> &'static str {
        "drucker-prager"
    }

    fn elastic(&self) -> &ElasticParameters {
        &self.elastic
    }

    fn update(
        &self,
        strain: &Vector6<f64>,
        old: &MaterialHistory,
        increment: Increment,
    ) -> Result<Response, LocalFailure> {
        if !strain.iter().all(|e| e.is_finite()) {
            return Err(LocalFailure::StrainNotFinite);
        }
        let stress = hooke(&self.elastic, &(strain - old.plastic_strain));
        let (mean, q) = invariants(&stress);
        let trial = Trial {
            mean,
            q,
            softening: self.softening(old),
        };
        let y = left(trial.softening)[0];
        let f = self.root(q, y) + self.friction * mean - self.strength * y;
        if f <= YIELD * self.strength * y {
            let tangent = match increment.tangent {
                Wanted::Everywhere => elastic_stiffness(&self.elastic),
                _ => Matrix6::zeros(),
            };
            return Ok(Response::inviscid(strain, old, stress, tangent, *old));
        }
        let (p, softening) = self.solve(&trial)?;
        let deviator = stress - tensor::UNIT * mean;
        let stress = deviator * p.ratio + tensor::UNIT * p.mean;
        let mut history = *old;
        // λN = (3/2)(λ/√(…)) s + (λη̄/3) 1; shear components are doubled.
        let (along, volume) = (
            1.5 * p.lambda / p.root * p.ratio,
            p.lambda * self.dilation / 3.0,
        );
        for i in 0..3 {
            history.plastic_strain[i] += along * deviator[i] + volume;
            history.plastic_strain[3 + i] += 2.0 * along * deviator[3 + i];
        }
        let work = p.lambda * (p.q * p.q / p.root + self.dilation * p.mean) / p.left[0];
        history.kappa_t += p.weight * work / self.uniaxial[0];
        history.kappa_c += (1.0 - p.weight) * work / self.uniaxial[1];
        let [t, c] = self.brittleness;
        history.tensile_damage = lost(self.uniaxial[0] * t * history.kappa_t);
        history.compressive_damage = lost(self.uniaxial[1] * c * history.kappa_c);
        debug_assert!((self.softening(&history) - softening).abs() <= 1e-9 * (1.0 + softening));
        let tangent = if increment.tangent == Wanted::Nowhere {
            Matrix6::zeros()
        } else {
            self.tangent(&trial, &deviator, &p)
        };
        Ok(Response::inviscid(strain, old, stress, tangent, history))
    }

    fn outputs(&self) -> &'static [LawOutput] {
        &OUTPUTS
    }

    fn screen(&self, strain: &ByPoint) -> (ByPoint, u8) {
        let stress = hooke_by_point(&self.elastic, strain);
        let mut elastic = [false; 8];
        for g in 0..8 {
            let mut one = Vector6::zeros();
            for k in 0..6 {
                one[k] = stress[k][g];
            }
            let (mean, q) = invariants(&one);
            // False if a value is not finite.
            elastic[g] = self.root(q, 1.0) + self.friction * mean <= self.strength;
        }
        (stress, bits(&elastic))
    }

    /// y of the yield surface through the stress, from the square of (1).
    fn reached(&self, stress: &Vector6<f64>) -> Option<f64> {
        let (mean, q) = invariants(stress);
        let (a, k, pressed) = (self.rounding, self.strength, self.friction * mean);
        let square = k * k - a * a;
        let root = (a * a * pressed * pressed + square * q * q).sqrt();
        Some(((k * pressed + root) / square).max(0.0))
    }
}

/// Mean stress σ_m and q = √(3/2 s:s) [MPa].
fn invariants(stress: &Vector6<f64>) -> (f64, f64) {
    let mean = tensor::mean(stress);
    let deviator = stress - tensor::UNIT * mean;
    (mean, (1.5 * tensor::norm_squared(&deviator)).sqrt())
}

/// y and dy/dω (7).
fn left(softening: f64) -> [f64; 2] {
    let soft = (1.0 - RESIDUAL) * (-softening).exp();
    [RESIDUAL + soft, -soft]
}

/// Lost fraction of the strength at a given softening.
fn lost(softening: f64) -> f64 {
    1.0 - left(softening)[0]
}
