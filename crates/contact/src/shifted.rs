//! The same law for a solver that iterates with a softer stiffness.
//!
//! A penalty of 500 times the elements' stiffness is a constant of the law, not of the solver. Let
//! t be the traction, g the gap, k the physical and k' < k the numerical stiffness. Where the law
//! is elastic, the solver uses
//!
//! ```text
//! t = k' (g − a),   a = −t₋ (1/k' − 1/k)   ⟺   t = k' g + (1 − k'/k) t₋
//! ```
//!
//! with t₋ the traction of the last iterate: an augmented Lagrangian that stops at a chosen
//! stiffness. Its fixed point t = t₋ is t = k g exactly. Around it stands the law of theory C.1:
//!
//! * opening, damage and softening read the physical gap, never g − a;
//! * the compressive and the virgin branch take the mixed traction, capped by (1−D) f_t; an opened
//!   point whose secant stiffness is below k' takes the secant itself, a stiffer one mixes with it;
//! * the shear traction is mixed in the same way, and limited by the bound g(σ₋, D) of the last
//!   iterate's normal traction, so that the tangent stays symmetric. Slip is implicit:
//!   δ_p = δ − τ/k_s, and D follows it.
//!
//! At the fixed point every branch is that of [`InterfaceLaw::update`], because σ₋ = σ and the
//! direction of the mixed shear is that of δ − δ_p,n. The tangent leaves out ∂D and negative
//! stiffness; it is symmetric and positive semidefinite, and exact for the lagged problem otherwise.

use nalgebra::{Matrix3, Vector2};

use crate::law::{InterfaceHistory, InterfaceLaw, InterfaceResponse};

/// What the shifted law knows of the last iterate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    /// Numerical stiffness, normal and shear [N/mm³]; at most the physical one counts.
    pub stiffness: [f64; 2],
    /// Traction of the last iterate [MPa].
    pub traction: [f64; 3],
}

/// Passes for D(δ_p(D)): each gains a factor g_D H'/k_s ≈ 1e-4.
const PASSES: usize = 6;

impl InterfaceLaw {
    /// One iterate of the shifted law at the total gap `[u, δ₁, δ₂]` [mm].
    pub fn update_shifted(
        &self,
        gap: [f64; 3],
        old: &InterfaceHistory,
        shift: &Shift,
    ) -> InterfaceResponse {
        let u = gap[0];
        let slip = Vector2::new(gap[1], gap[2]);
        let plastic = Vector2::from(old.plastic_slip);
        let k_s = self.shear_stiffness;
        let k_shear = shift.stiffness[1].min(k_s);
        let last = Vector2::new(shift.traction[1], shift.traction[2]);
        let opening_max = old.opening_max.max(u);

        let trial = k_shear * (slip - plastic) + (1.0 - k_shear / k_s) * last;
        let size = trial.norm();
        let mut damage = self.damage(opening_max, old.slip_max, old).value;
        let bound = |damage: f64| {
            // A tensile traction of the last iterate counts only as far as D allows it now.
            let sigma = shift.traction[0].min((1.0 - damage) * self.f_t);
            self.limit(sigma, damage).value
        };
        let mut limit = bound(damage);
        let slides = size > limit;
        let mut history = InterfaceHistory {
            opening: u,
            opening_max,
            slip_max: old.slip_max,
            slip: slip.into(),
            plastic_slip: old.plastic_slip,
            damage,
            traction: [0.0; 3],
        };
        let mut tangent = Matrix3::zeros();
        let shear = if slides {
            let n = trial / size;
            for _ in 0..PASSES {
                let plastic_now = slip - n * (limit / k_s);
                history.slip_max = old.slip_max.max(plastic_now.norm());
                damage = self.damage(opening_max, history.slip_max, old).value;
                let next = bound(damage);
                let settled = (next - limit).abs() <= 1e-15 * limit;
                limit = next;
                if settled {
                    break;
                }
            }
            history.plastic_slip = (slip - n * (limit / k_s)).into();
            let across = k_shear * limit / size;
            for i in 0..2 {
                for j in 0..2 {
                    let unit = if i == j { 1.0 } else { 0.0 };
                    tangent[(1 + i, 1 + j)] = across * (unit - n[i] * n[j]);
                }
            }
            n * limit
        } else {
            tangent[(1, 1)] = k_shear;
            tangent[(2, 2)] = k_shear;
            trial
        };
        history.damage = damage;
        let (sigma, slope) = self.shifted_normal(u, damage, old, shift);
        tangent[(0, 0)] = slope;
        self.respond(sigma, shear, tangent, history, old, slides)
    }

    /// σ and its non-negative slope. The secant of an opened point is that of the step's start: the
    /// soft iterates open farther than the law will, and must not be taken for failed.
    fn shifted_normal(
        &self,
        u: f64,
        damage: f64,
        old: &InterfaceHistory,
        shift: &Shift,
    ) -> (f64, f64) {
        let k_n = self.normal_stiffness;
        let k = shift.stiffness[0].min(k_n);
        let last = shift.traction[0];
        let mixed = k * u + (1.0 - k / k_n) * last;
        if mixed <= 0.0 {
            return (mixed, k);
        }
        let envelope = (1.0 - damage).max(0.0) * self.f_t;
        let secant = self.secant_stiffness(old.opening_max, damage);
        let (traction, slope) = if secant <= k {
            (secant * u, secant)
        } else {
            (k * u + (1.0 - k / secant) * last, k)
        };
        if traction >= envelope {
            // On the envelope σ falls with u: no stiffness.
            (envelope, 0.0)
        } else if traction <= 0.0 {
            (0.0, 0.0)
        } else {
            (traction, slope)
        }
    }
}
