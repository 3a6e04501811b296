//! The cohesive-frictional law with a numerical stiffness below the physical one (theory/shifted-penalty.md).
//!
//! The penalty stiffness, 50 or 500 times that of the elements, is a constant of the law and not of the solver. Let t
//! be the traction, g the gap, k the physical and k' < k the numerical stiffness. On an elastic branch the solver
//! uses
//!
//! ```text
//! t = k' (g − a),   a = −t₋ (1/k' − 1/k)   ⟺   t = k' g + (1 − k'/k) t₋
//! ```
//!
//! where t₋ is the traction of the last iterate. This is an augmented Lagrangian with a finite stiffness. Its fixed
//! point t = t₋ is exactly t = k g. The law of theory/joint.md, eqs 9 to 18, is applied as a return of this mixed
//! traction T to the admissible set:
//!
//! * Normal: T is accepted if it is negative or on the undamaged branch. Beyond the envelope the traction is (1−D)
//!   f_t, and the opening is u = (1−D) f_t/k + (T − (1−D) f_t)/k', the gap without the elastic parts. A soft iterate
//!   opens by σ/k' ≫ f_t/k without failure, so that reading its gap as the opening would damage sound joints. A
//!   damaged point uses its secant stiffness directly if that is below k'; otherwise the secant takes the place of k
//!   in the mixed traction.
//! * Shear: T is limited by g(σ₋, D) with the normal traction of an earlier iterate, so that the tangent stays
//!   symmetric. Slip is implicit: δ_p = δ_p,n + (|T| − g)/k' T/|T|, and D follows from it.
//!
//! At the fixed point every branch equals that of [`CohesiveFrictional::update`], because σ₋ = σ and both returns
//! leave g − t/k. The tangent neglects ∂D and negative stiffness. It is symmetric and positive semidefinite, and
//! otherwise exact for the problem with lagged σ₋.
//!
//! Three branches have zero stiffness: the envelope, slip in its direction, and the open state without bond. Newton's
//! method takes long steps along them, returns on a stiff branch, and cycles. A point that has entered and left such
//! a branch within the increment, or left and entered it, is held ([`InterfaceResponse::hold`]): its tangent there is
//! a secant. The fixed point does not change.

use nalgebra::{Matrix3, Vector2};

use crate::cohesive::Wholes;
use crate::law::{CohesiveFrictional, InterfaceHistory, InterfaceResponse};

/// State of the last iterate that the shifted law uses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shift {
    /// Numerical stiffness, normal and shear [N/mm³]; values above the physical stiffness are reduced to it.
    pub stiffness: [f64; 2],
    /// Traction of the last iterate [MPa].
    pub traction: [f64; 3],
    /// Normal traction that bounds the shear [MPa]: that of the last iterate, or an average of recent iterates if it
    /// oscillates.
    pub bounding: f64,
}

/// Which of the three branches without stiffness a point is on: opening along the softening curve, slip, open without
/// traction.
pub type FlatBranches = [bool; 3];

/// Largest number of passes for D, opening and slip, which depend on each other. A plain pass reduces the error by
/// the ratio of softening slope to k'; a secant step through the last two passes converges nearly quadratically.
const PASSES: usize = 12;
/// Change of D within rounding of the softening curves.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Normal part of an iterate.
struct Normal {
    /// σ [MPa].
    traction: f64,
    /// Non-negative slope [N/mm³].
    slope: f64,
    /// Opening for the evaluation of the law [mm].
    opening: f64,
}

/// Shear part of an iterate.
struct Shear {
    traction: Vector2<f64>,
    plastic: Vector2<f64>,
    slides: bool,
}

impl InterfaceResponse {
    /// The branches with zero stiffness that an iterate from `old` is on.
    #[inline(always)]
    pub fn flat_branches(&self, old: &InterfaceHistory) -> FlatBranches {
        let (now, sigma) = (&self.history, self.traction[0]);
        let opens = sigma > 0.0 && now.damage > 0.0 && now.opening > old.opening_max;
        [opens, now.plastic_slip != old.plastic_slip, sigma == 0.0]
    }

    /// Gives the tangent a stiffness on those branches of `loose` that are also in `held`: on the envelope the
    /// secant, at most `stiffness` [N/mm³]; in the open state without bond `stiffness`; in slip its secant.
    #[inline(always)]
    pub fn hold(&mut self, held: FlatBranches, loose: FlatBranches, stiffness: f64) {
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
            // The tangent has the secant stiffness normal to the slip and zero along it. Use the secant in both
            // directions.
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
        // The normal traction in compression does not depend on D.
        let mut normal = self.shifted_normal(gap[0], damage, old, shift);
        let pressed = normal.traction < 0.0;
        let (shear, limit, opening_max, slip_max) = loop {
            if !pressed && passes > 0 {
                normal = self.shifted_normal(gap[0], damage, old, shift);
            }
            // A tensile traction of an earlier iterate is limited to the tensile strength at the present D.
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
            // After a pass with little progress (at a corner of the law) the next pass is plain.
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

    /// σ, its slope and the opening. The secant stiffness of an opened point has the largest opening at the start of
    /// the step.
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
        // Trial traction and its slope on the branch with the secant stiffness.
        let (traction, slope) = if secant <= k {
            (secant * u, secant)
        } else {
            (k * u + (1.0 - k / secant) * last, k)
        };
        if traction >= envelope {
            // On the envelope σ decreases with u; the stiffness is set to zero.
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

    /// A predicted traction, limited to the admissible values for the history `old`.
    pub fn within_bounds(&self, guess: [f64; 3], old: &InterfaceHistory) -> [f64; 3] {
        let sigma = guess[0].min((1.0 - old.damage) * self.f_t);
        let limit = self.limit(sigma, old.damage).value;
        let size = guess[1].hypot(guess[2]);
        let part = if size > limit { limit / size } else { 1.0 };
        [sigma, part * guess[1], part * guess[2]]
    }

    /// Steepest softening slopes in opening and in slip [N/mm³] (theory/joint.md, eq. 23). With a numerical stiffness
    /// below them an iterate would snap back.
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

    /// Numerical normal and shear stiffness [N/mm³].
    const SOFT: [f64; 2] = [300.0, 130.0];

    fn iterate(
        law: &CohesiveFrictional,
        gap: [f64; 3],
        bounding: f64,
    ) -> (InterfaceResponse, FlatBranches) {
        let shift = Shift {
            stiffness: SOFT,
            traction: [0.0; 3],
            bounding,
        };
        let response = law.update_shifted(gap, &law.virgin(), &shift);
        let loose = response.flat_branches(&law.virgin());
        (response, loose)
    }

    #[test]
    fn a_point_is_held_only_on_branches_without_stiffness() {
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
        // A bonded point has its stiffness.
        let (mut bonded, loose) = iterate(&law, [1e-4, 1e-4, 0.0], 0.0);
        let before = bonded.tangent;
        assert_eq!(loose, [false; 3]);
        bonded.hold(every, loose, SOFT[0]);
        assert_eq!(bonded.tangent, before);
        // Just beyond the envelope the secant is stiffer than the numerical stiffness, far beyond it is softer.
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
        // In slip the stiffness normal to the slip is used along it, too.
        let (mut sliding, loose) = iterate(&law, [-1e-3, 0.01, 0.0], -0.3);
        assert_eq!(loose, [false, true, false]);
        let across = sliding.tangent[(2, 2)];
        assert!(across > 0.0 && sliding.tangent[(1, 1)].abs() < 1e-12 * across);
        sliding.hold(every, loose, SOFT[0]);
        // Tolerance: rounding of a projector.
        assert!((sliding.tangent[(1, 1)] / across - 1.0).abs() < 1e-12);
        assert_eq!(sliding.tangent[(1, 2)], 0.0);
        // A joint without bond, open.
        let dry = CohesiveFrictional::dry(0.6, 150_000.0, 65_000.0);
        let (mut open, loose) = iterate(&dry, [1e-3, 0.0, 0.0], 0.0);
        assert_eq!(loose, [false, false, true]);
        open.hold(every, loose, SOFT[0]);
        assert_eq!(open.tangent[(0, 0)], SOFT[0]);
    }
}
