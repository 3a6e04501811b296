//! Damage and normal traction of an interface point (theory/joint.md, eqs 9 to 14).

use crate::law::{CohesiveFrictional, Coupling, InterfaceHistory};

/// Damage D with its derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Damage {
    /// D [-].
    pub value: f64,
    /// ∂D/∂u while the opening grows [1/mm].
    pub by_opening: f64,
    /// ∂D/∂s_max [1/mm].
    pub by_slip: f64,
}

/// The denominators 1 − e^{−ζ} and 1 − e^{−ξ}, stored after their first evaluation.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Wholes(Option<f64>, Option<f64>);

/// Normal traction σ with its partial derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Normal {
    /// σ [MPa].
    pub traction: f64,
    /// ∂σ/∂u [N/mm³].
    pub by_gap: f64,
    /// ∂σ/∂D [MPa].
    pub by_damage: f64,
}

impl CohesiveFrictional {
    /// u₀ = f_t/k_n, the elastic opening [mm].
    pub(crate) fn elastic_opening(&self) -> f64 {
        self.f_t / self.normal_stiffness
    }

    /// D for the largest opening and slip of this step. `wholes` caches denominators between calls.
    #[inline]
    #[expect(
        clippy::too_many_lines,
        reason = "each rule of coupling is a block of formulas over the same locals, inlined in the hot loop"
    )]
    pub(crate) fn damage(
        &self,
        opening_max: f64,
        slip_max: f64,
        old: &InterfaceHistory,
        wholes: &mut Wholes,
    ) -> Damage {
        let unchanged = |value| Damage {
            value,
            by_opening: 0.0,
            by_slip: 0.0,
        };
        if self.is_dry() {
            return unchanged(1.0);
        }
        let (opened, slid) = (opening_max > old.opening_max, slip_max > old.slip_max);
        if !(opened || slid) || old.damage >= 1.0 {
            return unchanged(old.damage);
        }
        let u0 = self.elastic_opening();
        let w = (opening_max - u0).max(0.0);
        let opens = opened && w > 0.0;
        match self.coupling {
            Coupling::Max => {
                // A mode whose largest displacement has not grown cannot increase D.
                let (q, q_slope) = if opens {
                    self.opening_curve().evaluate_with(w, &mut wholes.0)
                } else {
                    (0.0, 0.0)
                };
                let (h, h_slope) = if slid {
                    self.slip_curve().evaluate_with(slip_max, &mut wholes.1)
                } else {
                    (0.0, 0.0)
                };
                if old.damage >= q.max(h) {
                    unchanged(old.damage)
                } else if q >= h {
                    Damage {
                        value: q,
                        by_opening: q_slope,
                        by_slip: 0.0,
                    }
                } else {
                    Damage {
                        value: h,
                        by_opening: 0.0,
                        by_slip: h_slope,
                    }
                }
            }
            Coupling::Additive => {
                // The two terms of the rate are integrated one after the other. This is explicit, exact in a pure
                // mode, and of first order in a mixed step.
                let (opening, slip) = (self.opening_curve(), self.slip_curve());
                let dw = w - (old.opening_max - u0).max(0.0);
                let w_old = opening.inverse(old.damage);
                let (first, first_slope) = if dw > 0.0 {
                    opening.evaluate(w_old + dw)
                } else {
                    (old.damage, 0.0)
                };
                let ds = slip_max - old.slip_max;
                let s_first = slip.inverse(first);
                let (value, by_slip) = slip.evaluate(s_first + ds.max(0.0));
                // D(D₁) = H(H⁻¹(D₁) + Δs): dD/dD₁ = H'(s₁ + Δs)/H'(s₁).
                let carried = slip.evaluate(s_first).1;
                let through = if carried > 0.0 {
                    by_slip / carried
                } else {
                    0.0
                };
                let by_opening = if opens { first_slope * through } else { 0.0 };
                let value = value.max(old.damage);
                Damage {
                    value,
                    by_opening,
                    by_slip,
                }
            }
        }
    }

    /// Secant stiffness of an opened point, (1−D) f_t/max(u_max, (1−D)u₀) [N/mm³].
    pub(crate) fn secant_stiffness(&self, opening_max: f64, damage: f64) -> f64 {
        let left = 1.0 - damage;
        if left <= 0.0 || self.f_t <= 0.0 {
            return 0.0;
        }
        if opening_max <= left * self.elastic_opening() {
            self.normal_stiffness
        } else {
            left * self.f_t / opening_max
        }
    }

    /// σ(u, D) with its slopes (theory/joint.md, eqs 14 and 24). `grows`: u is the largest opening so far.
    pub(crate) fn normal(&self, u: f64, opening_max: f64, damage: f64, grows: bool) -> Normal {
        let k_n = self.normal_stiffness;
        if u <= 0.0 {
            return Normal {
                traction: k_n * u,
                by_gap: k_n,
                by_damage: 0.0,
            };
        }
        let left = 1.0 - damage;
        if left <= 0.0 || self.f_t <= 0.0 {
            return Normal {
                traction: 0.0,
                by_gap: 0.0,
                by_damage: 0.0,
            };
        }
        if opening_max <= left * self.elastic_opening() {
            Normal {
                traction: k_n * u,
                by_gap: k_n,
                by_damage: 0.0,
            }
        } else if grows {
            Normal {
                traction: left * self.f_t,
                by_gap: 0.0,
                by_damage: -self.f_t,
            }
        } else {
            let secant = left * self.f_t / opening_max;
            Normal {
                traction: secant * u,
                by_gap: secant,
                by_damage: -self.f_t * u / opening_max,
            }
        }
    }
}
