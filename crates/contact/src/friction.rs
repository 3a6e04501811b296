//! Shear strength and return of the slip (theory/joint.md, eqs 15 to 18).

use nalgebra::Vector2;

use crate::cohesive::{Normal, Wholes};
use crate::law::{CohesiveFrictional, InterfaceHistory};

/// Limit g(σ, D) of the shear traction with its derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limit {
    /// g [MPa].
    pub value: f64,
    /// ∂g/∂σ [-].
    pub by_traction: f64,
    /// ∂g/∂D [MPa].
    pub by_damage: f64,
}

impl CohesiveFrictional {
    /// g(σ, D) = (1−D)⟨c − tanφ σ⟩ + D μ ⟨−σ⟩ (theory/joint.md, eqs 15 and 25).
    #[inline(always)]
    pub(crate) fn limit(&self, sigma: f64, damage: f64) -> Limit {
        let cohesive = self.c - self.tan_phi * sigma;
        let bonded = if cohesive > 0.0 { 1.0 } else { 0.0 };
        let pressed = if sigma < 0.0 { 1.0 } else { 0.0 };
        Limit {
            value: (1.0 - damage) * bonded * cohesive - damage * self.mu * pressed * sigma,
            by_traction: -(1.0 - damage) * self.tan_phi * bonded - damage * self.mu * pressed,
            by_damage: -bonded * cohesive - self.mu * pressed * sigma,
        }
    }

    /// Shear traction divided by its limit [-]; infinite without pressure.
    #[inline(always)]
    pub fn utilisation(&self, traction: &[f64; 3], damage: f64) -> f64 {
        if traction[0] < 0.0 {
            let shear = (traction[1] * traction[1] + traction[2] * traction[2]).sqrt();
            shear / self.limit(traction[0], damage).value
        } else {
            f64::INFINITY
        }
    }

    /// The larger of shear traction over its limit and tension over tensile strength [-]; infinite under tension
    /// without bond.
    #[inline(always)]
    pub fn exertion(&self, traction: &[f64; 3], damage: f64) -> f64 {
        let [sigma, t1, t2] = *traction;
        if sigma < 0.0 {
            return self.utilisation(traction, damage);
        }
        let strength = (1.0 - damage) * self.f_t;
        let limit = self.limit(sigma, damage).value;
        if strength > 0.0 && limit > 0.0 {
            (sigma / strength).max(t1.hypot(t2) / limit)
        } else {
            f64::INFINITY
        }
    }

    /// Slip increment Δγ from |τ_tr| − k_s Δγ − g(σ(D), D) = 0 on [0, |τ_tr|/k_s], by Newton's method with bisection
    /// as safeguard.
    #[expect(
        clippy::too_many_arguments,
        reason = "a scalar equation of its own coefficients, solved in the hot loop"
    )]
    pub(crate) fn return_slip(
        &self,
        size: f64,
        n: Vector2<f64>,
        plastic: Vector2<f64>,
        opening_max: f64,
        old: &InterfaceHistory,
        normal_at: impl Fn(f64) -> Normal,
        wholes: &mut Wholes,
    ) -> f64 {
        let k_s = self.shear_stiffness;
        let (mut low, mut high) = (0.0, size / k_s);
        // The first guess is the limit without further damage, which is exact for perfect friction.
        let mut dg = {
            let damage = self.damage(opening_max, old.slip_max, old, wholes).value;
            let limit = self.limit(normal_at(damage).traction, damage);
            ((size - limit.value) / k_s).max(low).min(high)
        };
        for _ in 0..100 {
            let new = plastic + dg * n;
            let reach = new.norm();
            let slip_max = old.slip_max.max(reach);
            let damage = self.damage(opening_max, slip_max, old, wholes);
            let normal = normal_at(damage.value);
            let limit = self.limit(normal.traction, damage.value);
            let phi = size - k_s * dg - limit.value;
            if phi > 0.0 {
                low = dg;
            } else {
                high = dg;
            }
            let d_s = if reach > old.slip_max {
                damage.by_slip * new.dot(&n) / reach
            } else {
                0.0
            };
            let slope = -k_s - (limit.by_traction * normal.by_damage + limit.by_damage) * d_s;
            let step = -phi / slope;
            // Stop at the rounding of |τ_tr| − k_s Δγ.
            if phi.abs() <= 4.0 * f64::EPSILON * size || high - low <= f64::EPSILON * high {
                break;
            }
            let next = dg + step;
            dg = if next > low && next < high {
                next
            } else {
                0.5 * (low + high)
            };
        }
        dg
    }
}
