//! Tangents of damage plasticity: consistent (theory/return-map.md, eqs 15 to 17), secant, and bounded for yielding
//! points.

use std::f64::consts::SQRT_2;

use nalgebra::{Matrix6, Vector3, Vector6};

use super::damage_plasticity::{DamagePlasticity, Inviscid};
use super::return_map::{Slope, Variation};
use crate::tensor;

/// Smallest stiffness of a yielding point relative to that of its intact part. Solutions with a softer one overshoot
/// (docs/decisions/secant-tangents.md).
const LEAST_STIFFNESS: f64 = 0.3;

impl DamagePlasticity {
    /// (1−d) C₀.
    pub fn secant_stiffness(&self, intact: f64) -> Matrix6<f64> {
        isotropic(self.bulk * intact, self.shear * intact)
    }

    /// Symmetric part of a tangent, with eigenvalues relative to C₀ limited to between 0.3 (`LEAST_STIFFNESS`) and 1
    /// times the intact part.
    pub fn bounded(&self, tangent: &Matrix6<f64>, intact: f64) -> Matrix6<f64> {
        bounded(self.bulk, self.shear, tangent, intact)
    }

    /// D = (1−d_v)[(1−θ) C₀ + θ D̄] − θ (C₀:(ε−ε_v)) ⊗ ∇d with the effective algorithmic tangent
    /// D̄ = K 1⊗1 + 2Gη dev + s_tr ⊗ ∇η − K T 1 ⊗ ∇λ (theory/return-map.md, eqs 15 to 17).
    #[inline(always)]
    pub(super) fn tangent(
        &self,
        inviscid: &Inviscid,
        theta: f64,
        intact: f64,
        effective: &Vector6<f64>,
    ) -> Matrix6<f64> {
        let p = &inviscid.point;
        let shear = self.shear * intact * (1.0 - theta + theta * p.eta);
        let mut d = isotropic(self.bulk * intact, shear);
        let Some(directions) = &inviscid.directions else {
            return d;
        };
        let (slope, by_lambda, lambda) = self.gradients(inviscid, directions);
        let gradient = |along: Vector6<f64>, over: f64| along + lambda * over;
        let (r, kappa_t, kappa_c) = if inviscid.is_plastic() {
            let eta = gradient(slope.eta, by_lambda.eta[0]);
            d += inviscid.deviator * (theta * intact) * eta.transpose();
            d -= tensor::UNIT * (theta * intact * self.bulk * self.dilation) * lambda.transpose();
            (
                gradient(slope.r, by_lambda.r[0]),
                gradient(slope.kappa_t, by_lambda.kappa_t[0]),
                gradient(slope.kappa_c, by_lambda.kappa_c[0]),
            )
        } else {
            (slope.r, Vector6::zeros(), Vector6::zeros())
        };
        // ∇d (theory/return-map.md, eq. 16), from both factors of the intact part.
        let (w_t, w_c) = (self.tension_recovery, self.compression_recovery);
        let (s_t, s_c) = (1.0 - w_t * p.r, 1.0 - w_c * (1.0 - p.r));
        let (factors, _) = self.intact(p);
        let crushing =
            kappa_c * (s_t * p.compression.damage_slope) - r * (w_t * p.compression.damage);
        let cracking = kappa_t * (s_c * p.tension.damage_slope) + r * (w_c * p.tension.damage);
        let damage = crushing * factors[1] + cracking * factors[0];
        d -= effective * theta * damage.transpose();
        d
    }

    /// Derivatives by the strain at constant λ, by λ, and ∇λ = −∇f/f_λ (zero in an elastic step).
    #[inline(always)]
    fn gradients(
        &self,
        inviscid: &Inviscid,
        directions: &[Vector3<f64>; 3],
    ) -> (Slope<6>, Slope<1>, Vector6<f64>) {
        let Inviscid {
            trial,
            point,
            deviator,
            ..
        } = inviscid;
        // Voigt components of a stress-like gradient pair with engineering shear strains.
        let by_q = if trial.q > 0.0 {
            3.0 * self.shear / trial.q
        } else {
            0.0
        };
        let mut s =
            directions.map(|n| (tensor::dyad(&n) - tensor::UNIT / 3.0) * (2.0 * self.shear));
        average_repeated(&trial.s, &mut s);
        let (mean, q) = (tensor::UNIT * self.bulk, deviator * by_q);
        let by_strain = Variation {
            mean,
            q,
            s,
            lambda: Vector6::zeros(),
        };
        let slope = self.slope(trial, point, &by_strain);
        let by_lambda = self.slope(trial, point, &Variation::along_lambda());
        let lambda = if inviscid.is_plastic() {
            slope.f * (-1.0 / by_lambda.f[0])
        } else {
            Vector6::zeros()
        };
        (slope, by_lambda, lambda)
    }
}

/// Symmetric part of a tangent, with eigenvalues relative to C₀ limited to between 0.3 (`LEAST_STIFFNESS`) and 1
/// times the intact part.
pub(super) fn bounded(bulk: f64, shear: f64, tangent: &Matrix6<f64>, intact: f64) -> Matrix6<f64> {
    // In Kelvin components an isotropic matrix has a square root with the roots of its two moduli.
    let kelvin = Vector6::new(1.0, 1.0, 1.0, SQRT_2, SQRT_2, SQRT_2);
    let moduli = [3.0 * bulk, 2.0 * shear];
    let [volume, shape] = moduli.map(f64::sqrt);
    let root = kelvin_isotropic(volume, shape);
    let inverse = kelvin_isotropic(1.0 / volume, 1.0 / shape);
    let relative = inverse * tangent.component_mul(&(kelvin * kelvin.transpose())) * inverse;
    if !relative.sum().is_finite() {
        return *tangent; // its forces are rejected; the eigenvalue iteration would not end
    }
    let mut eigen = ((relative + relative.transpose()) * 0.5).symmetric_eigen();
    for value in eigen.eigenvalues.iter_mut() {
        *value = value.max(LEAST_STIFFNESS * intact).min(intact);
    }
    let bounded = root * eigen.recompose() * root;
    bounded.component_div(&(kelvin * kelvin.transpose()))
}

/// K 1⊗1 + 2G dev, engineering Voigt.
#[inline(always)]
fn isotropic(bulk: f64, shear: f64) -> Matrix6<f64> {
    let mut d = Matrix6::zeros();
    for i in 0..3 {
        for j in 0..3 {
            d[(i, j)] = bulk - 2.0 / 3.0 * shear;
        }
        d[(i, i)] += 2.0 * shear;
        d[(3 + i, 3 + i)] = shear;
    }
    d
}

/// An isotropic matrix from its eigenvalues, in Kelvin components.
fn kelvin_isotropic(volume: f64, shape: f64) -> Matrix6<f64> {
    Matrix6::identity() * shape + tensor::UNIT * ((volume - shape) / 3.0) * tensor::UNIT.transpose()
}

/// Coinciding principal values share the mean of their gradients. This subgradient does not depend on an arbitrary
/// choice of directions.
#[inline(always)]
fn average_repeated(s: &[f64; 3], grad: &mut [Vector6<f64>; 3]) {
    let close = 1e-9 * (s[0].abs() + s[2].abs());
    let (upper, lower) = (s[0] - s[1] <= close, s[1] - s[2] <= close);
    if upper && lower {
        *grad = [(grad[0] + grad[1] + grad[2]) / 3.0; 3];
    } else if upper {
        let mean = (grad[0] + grad[1]) / 2.0;
        (grad[0], grad[1]) = (mean, mean);
    } else if lower {
        let mean = (grad[1] + grad[2]) / 2.0;
        (grad[1], grad[2]) = (mean, mean);
    }
}
