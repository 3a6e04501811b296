//! The same law for a solver that iterates with a softer stiffness.
//!
//! A penalty of 50 or 500 times the elements' stiffness is a constant of the law, not of the solver. Let
//! t be the traction, g the gap, k the physical and k' < k the numerical stiffness. Where the law
//! is elastic, the solver uses
//!
//! ```text
//! t = k' (g − a),   a = −t₋ (1/k' − 1/k)   ⟺   t = k' g + (1 − k'/k) t₋
//! ```
//!
//! with t₋ the traction of the last iterate: an augmented Lagrangian that stops at a chosen
//! stiffness. Its fixed point t = t₋ is t = k g exactly. Around it stands the law of theory/joint.md, eqs 9 to 18,
//! as a return of this mixed traction T to the law's bounds:
//!
//! * normal: T below zero or on the virgin branch is taken; beyond the envelope (1−D) f_t the
//!   traction is the envelope, and the opening is what the elastic parts leave of the gap,
//!   u = (1−D) f_t/k + (T − (1−D) f_t)/k'. A soft iterate opens by σ/k' ≫ f_t/k without having
//!   failed: to read its gap as the opening would crack joints that hold. An opened point whose
//!   secant stiffness is below k' takes the secant itself, a stiffer one mixes with it;
//! * shear: T is limited by the bound g(σ₋, D) of an earlier iterate's normal traction, so that the
//!   tangent stays symmetric. Slip is implicit: δ_p = δ_p,n + (|T| − g)/k' T/|T|, and D follows it.
//!
//! At the fixed point every branch is that of [`CohesiveFrictional::update`], because σ₋ = σ and both
//! returns leave g − t/k. The tangent leaves out ∂D and negative stiffness; it is symmetric and
//! positive semidefinite, and exact for the lagged problem otherwise.
//!
//! Three branches have no stiffness: the envelope, slip along its way, and the opening of what has no bond.
//! Newton's method goes far along them, comes back by a branch that is stiff, and circles. A point that has
//! left such a branch and come back since the increment began, or the other way round, is held on it
//! ([`InterfaceResponse::hold`]): its tangent is a secant there. The fixed point is the same.

use nalgebra::{Matrix3, Vector2};

use crate::cohesive::Wholes;
use crate::law::{CohesiveFrictional, InterfaceHistory, InterfaceResponse};

/// What the shifted law knows of the last iterate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    /// Numerical stiffness, normal and shear [N/mm³]; at most the physical one counts.
    pub stiffness: [f64; 2],
    /// Traction of the last iterate [MPa].
    pub traction: [f64; 3],
    /// Normal traction that bounds the shear [MPa]: that of the last iterate, or a mean of the last
    /// ones where it swings.
    pub bounding: f64,
}

/// The branches without stiffness: whether a point opens along the envelope, slides, is open without traction.
pub type Loose = [bool; 3];

/// Most passes for D, the opening and the slip, which depend on one another: a plain one gains a factor of the
/// softening slope over k', one by the secant of the last two its square, or nearly.
const PASSES: usize = 12;
/// Change of D that is rounding of the softening curves.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Normal part of an iterate.
struct Normal {
    /// σ [MPa].
    traction: f64,
    /// Non-negative slope [N/mm³].
    slope: f64,
    /// Opening that the law reads [mm].
    opening: f64,
}

/// Shear part of an iterate.
struct Shear {
    traction: Vector2<f64>,
    plastic: Vector2<f64>,
    slides: bool,
}

impl InterfaceResponse {
    /// Which of the branches without stiffness an iterate from `old` is on.
    #[inline(always)]
    pub fn loose(&self, old: &InterfaceHistory) -> Loose {
        let (now, sigma) = (&self.history, self.traction[0]);
        let opens = sigma > 0.0 && now.damage > 0.0 && now.opening > old.opening_max;
        [opens, now.plastic_slip != old.plastic_slip, sigma == 0.0]
    }

    /// Gives the tangent of an iterate on one of the branches `held` a stiffness: the secant, `stiffness` [N/mm³] at
    /// most, along the envelope, all of that where nothing bonds, the secant of slip along it.
    #[inline(always)]
    pub fn hold(&mut self, held: Loose, loose: Loose, stiffness: f64) {
        let [opens, slides, open] = [0, 1, 2].map(|i| held[i] && loose[i]);
        let k = &mut self.tangent;
        if k[(0, 0)] == 0.0 {
            if opens {
                k[(0, 0)] = (self.traction[0] / self.history.opening).min(stiffness);
            } else if open {
                k[(0, 0)] = stiffness;
            }
        }
        if slides {
            // Across its way it has that secant, along it nothing.
            let secant = k[(1, 1)] + k[(2, 2)];
            for i in 1..3 {
                for j in 1..3 {
                    k[(i, j)] = if i == j { secant } else { 0.0 };
                }
            }
        }
    }
}

impl CohesiveFrictional {
    /// One iterate of the shifted law at the total gap `[u, δ₁, δ₂]` [mm].
    #[inline(always)]
    #[expect(
        clippy::too_many_lines,
        reason = "one fixed point with its locals, inlined in the hot loop"
    )]
    pub fn update_shifted(
        &self,
        gap: [f64; 3],
        old: &InterfaceHistory,
        shift: &Shift,
    ) -> InterfaceResponse {
        let slip = Vector2::new(gap[1], gap[2]);
        let k_s = self.shear_stiffness;
        let k_shear = shift.stiffness[1].min(k_s);
        let last = Vector2::new(shift.traction[1], shift.traction[2]);
        let plastic = Vector2::from(old.plastic_slip);
        let trial = k_shear * (slip - plastic) + (1.0 - k_shear / k_s) * last;
        let size = trial.norm();

        let unit = if size > 0.0 { trial / size } else { trial };
        let mut damage = old.damage;
        let mut wholes = Wholes::default();
        let mut last_pass: Option<(f64, f64)> = None;
        let mut passes = 0;
        // What presses knows nothing of D.
        let mut normal = self.shifted_normal(gap[0], damage, old, shift);
        let pressed = normal.traction < 0.0;
        let (shear, limit, opening_max, slip_max) = loop {
            if !pressed && passes > 0 {
                normal = self.shifted_normal(gap[0], damage, old, shift);
            }
            // A tensile traction of an earlier iterate counts only as far as D allows it now.
            let sigma = shift.bounding.min((1.0 - damage) * self.f_t);
            let limit = self.limit(sigma, damage).value;
            let shear = if size > limit {
                Shear {
                    traction: unit * limit,
                    plastic: plastic + unit * ((size - limit) / k_shear),
                    slides: true,
                }
            } else {
                Shear {
                    traction: trial,
                    plastic,
                    slides: false,
                }
            };
            let opening_max = old.opening_max.max(normal.opening);
            let slip_max = if shear.slides {
                old.slip_max.max(shear.plastic.norm())
            } else {
                old.slip_max
            };
            let next = self.damage(opening_max, slip_max, old, &mut wholes).value;
            let rest = next - damage;
            passes += 1;
            if rest.abs() <= ROUNDING || passes == PASSES {
                break (shear, limit, opening_max, slip_max);
            }
            let secant = last_pass.map_or(next, |(before, rest_before)| {
                damage - rest * (damage - before) / (rest - rest_before)
            });
            // A pass that gains little has come over a corner of the law: the next one is plain.
            let gains = last_pass.is_none_or(|(_, before)| rest.abs() < 0.5 * before.abs());
            last_pass = Some((damage, rest));
            damage = if gains && secant >= old.damage && secant <= 1.0 {
                secant
            } else {
                next
            };
        };

        let mut tangent = Matrix3::zeros();
        tangent[(0, 0)] = normal.slope;
        if shear.slides {
            let across = k_shear * limit / size;
            for i in 0..2 {
                for j in 0..2 {
                    let one = if i == j { 1.0 } else { 0.0 };
                    tangent[(1 + i, 1 + j)] = across * (one - unit[i] * unit[j]);
                }
            }
        } else {
            tangent[(1, 1)] = k_shear;
            tangent[(2, 2)] = k_shear;
        }
        let history = InterfaceHistory {
            opening: normal.opening,
            opening_max,
            slip_max,
            slip: slip.into(),
            plastic_slip: shear.plastic.into(),
            damage,
            traction: [0.0; 3],
            slots: old.slots,
        };
        self.respond(
            normal.traction,
            shear.traction,
            tangent,
            history,
            old,
            shear.slides,
        )
    }

    /// σ, its slope and the opening. The secant of an opened point is that of the step's start.
    #[inline(always)]
    fn shifted_normal(&self, u: f64, damage: f64, old: &InterfaceHistory, shift: &Shift) -> Normal {
        let k_n = self.normal_stiffness;
        let k = shift.stiffness[0].min(k_n);
        let last = shift.traction[0];
        let mixed = k * u + (1.0 - k / k_n) * last;
        if mixed <= 0.0 {
            return Normal {
                traction: mixed,
                slope: k,
                opening: mixed / k_n,
            };
        }
        let envelope = (1.0 - damage).max(0.0) * self.f_t;
        let secant = self.secant_stiffness(old.opening_max, damage);
        // (T, slope, stiffness of what the law would make of T)
        let (traction, slope) = if secant <= k {
            (secant * u, secant)
        } else {
            (k * u + (1.0 - k / secant) * last, k)
        };
        if traction >= envelope {
            // On the envelope σ falls with u: no stiffness.
            let opening = if secant <= k {
                u
            } else {
                envelope / secant + (traction - envelope) / k
            };
            Normal {
                traction: envelope,
                slope: 0.0,
                opening,
            }
        } else if traction <= 0.0 {
            Normal {
                traction: 0.0,
                slope: 0.0,
                opening: u.max(0.0),
            }
        } else {
            let opening = if secant <= k { u } else { traction / secant };
            Normal {
                traction,
                slope,
                opening,
            }
        }
    }

    /// A guessed traction brought within the bounds of a point's history.
    pub fn within_bounds(&self, guess: [f64; 3], old: &InterfaceHistory) -> [f64; 3] {
        let sigma = guess[0].min((1.0 - old.damage) * self.f_t);
        let limit = self.limit(sigma, old.damage).value;
        let size = guess[1].hypot(guess[2]);
        let part = if size > limit { limit / size } else { 1.0 };
        [sigma, part * guess[1], part * guess[2]]
    }

    /// Steepest softening, in opening and in slip [N/mm³] (theory/joint.md, eq. 23): a numerical stiffness below
    /// it would snap back.
    pub fn softening_slopes(&self) -> [f64; 2] {
        if self.is_dry() {
            return [0.0; 2];
        }
        [
            self.f_t * self.opening_curve().steepest(),
            self.c * self.slip_curve().steepest(),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Coupling;

    /// Normal and shear stiffness of an iterate [N/mm³].
    const SOFT: [f64; 2] = [300.0, 130.0];

    fn iterate(
        law: &CohesiveFrictional,
        gap: [f64; 3],
        bounding: f64,
    ) -> (InterfaceResponse, Loose) {
        let shift = Shift {
            stiffness: SOFT,
            traction: [0.0; 3],
            bounding,
        };
        let response = law.update_shifted(gap, &law.virgin(), &shift);
        let loose = response.loose(&law.virgin());
        (response, loose)
    }

    #[test]
    fn a_point_is_held_only_where_it_has_no_stiffness() {
        let law = CohesiveFrictional {
            f_t: 0.2,
            c: 0.2,
            tan_phi: 0.75,
            mu: 0.75,
            u_k: 0.36,
            zeta: 4.38,
            delta_k: 0.4,
            xi: 1.1,
            normal_stiffness: 150_000.0,
            shear_stiffness: 65_000.0,
            coupling: Coupling::Max,
        };
        let every = [true; 3];
        // Bonded: nothing to hold.
        let (mut bonded, loose) = iterate(&law, [1e-4, 1e-4, 0.0], 0.0);
        let before = bonded.tangent;
        assert_eq!(loose, [false; 3]);
        bonded.hold(every, loose, SOFT[0]);
        assert_eq!(bonded.tangent, before);
        // Just beyond the envelope the secant is stiffer than the iterate; far beyond it is the softer one.
        for (gap, stiff) in [(0.7e-3, true), (0.1, false)] {
            let (mut opening, loose) = iterate(&law, [gap, 0.0, 0.0], 0.0);
            assert_eq!(loose, [true, false, false]);
            assert_eq!(opening.tangent[(0, 0)], 0.0);
            opening.hold([false, true, true], loose, SOFT[0]);
            assert_eq!(opening.tangent[(0, 0)], 0.0, "of another branch");
            opening.hold(every, loose, SOFT[0]);
            let secant = opening.traction[0] / opening.history.opening;
            assert_eq!(secant > SOFT[0], stiff);
            assert_eq!(opening.tangent[(0, 0)], secant.min(SOFT[0]));
        }
        // Slip: what it has across its way it gets along it, too.
        let (mut sliding, loose) = iterate(&law, [-1e-3, 0.01, 0.0], -0.3);
        assert_eq!(loose, [false, true, false]);
        let across = sliding.tangent[(2, 2)];
        assert!(across > 0.0 && sliding.tangent[(1, 1)].abs() < 1e-12 * across);
        sliding.hold(every, loose, SOFT[0]);
        // Rounding of a projector.
        assert!((sliding.tangent[(1, 1)] / across - 1.0).abs() < 1e-12);
        assert_eq!(sliding.tangent[(1, 2)], 0.0);
        // What has no bond and is open.
        let dry = CohesiveFrictional::dry(0.6, 150_000.0, 65_000.0);
        let (mut open, loose) = iterate(&dry, [1e-3, 0.0, 0.0], 0.0);
        assert_eq!(loose, [false, false, true]);
        open.hold(every, loose, SOFT[0]);
        assert_eq!(open.tangent[(0, 0)], SOFT[0]);
    }
}
