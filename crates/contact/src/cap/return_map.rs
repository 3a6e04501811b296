//! Implicit return of an elastic trial traction to the three yield surfaces (docs/theory/joint-cap.md, "Algorithm").
//!
//! Plastic slip follows the direction of the trial shear traction, so that the unknowns are σ and τ = |τ|. Each case
//! is one scalar equation with a bracket around its root. The tangent follows from the derivatives of all equations.

use nalgebra::{Matrix5, SMatrix};

use super::Cap;

/// An elastic trial traction and the history at the start of the step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Trial {
    /// σ* [MPa].
    pub sigma: f64,
    /// |τ*| [MPa].
    pub tau: f64,
    /// Stiffness used in the return, normal and shear [N/mm³].
    pub stiffness: [f64; 2],
    /// Remaining fraction of the bond, 1 − D [-].
    pub left: f64,
    /// Accumulated plastic slip s_p [mm].
    pub slip: f64,
    /// Plastic displacement of the cap κ_c [mm].
    pub crushing: f64,
}

/// Result of a return.
#[derive(Clone, Copy, Debug)]
pub(super) struct Returned {
    /// σ [MPa].
    pub sigma: f64,
    /// |τ| [MPa].
    pub tau: f64,
    /// ∂(σ, |τ|)/∂(σ*, |τ*|) [-]. `[value][trial value]`
    pub slopes: [[f64; 2]; 2],
    /// Increment of the plastic opening [mm].
    pub opening: f64,
    /// Part of it by tension λ₁ [mm].
    pub gap: f64,
    /// Increment of the plastic slip along τ [mm].
    pub slip: f64,
    /// Increment of the slip on the friction surface λ₂ [mm].
    pub friction_slip: f64,
    /// 1 − D [-].
    pub left: f64,
    /// κ_c [mm].
    pub crushing: f64,
}

/// Plastic multipliers of tension λ₁ [mm], friction λ₂ [mm] and cap μ' [mm/MPa]. Multipliers of inactive surfaces are
/// 0.
#[derive(Clone, Copy, Debug, Default)]
struct Multipliers {
    tension: f64,
    friction: f64,
    cap: f64,
    active: [bool; 3],
}

/// Excess of an inactive surface that counts as rounding, divided by the sum of the strengths.
const ROUNDING: f64 = 1e-10;

/// Root of a function that is positive at `low` and not positive at `high`. Regula falsi with the Illinois
/// modification: the value at an end that stays is halved. Every third step is a bisection.
fn root(mut low: f64, mut high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (mut at_low, mut at_high) = (f(low), f(high));
    if at_low.is_nan() || at_low <= 0.0 {
        return low;
    }
    if at_high > 0.0 {
        return high;
    }
    let (mut side, mut halve, mut width) = (0, 0, high - low);
    for _ in 0..200 {
        if at_high == 0.0 || high - low <= f64::EPSILON * high.abs() {
            return high;
        }
        halve += 1;
        let middle = 0.5 * (low + high);
        let secant = high - at_high * (high - low) / (at_high - at_low);
        let next = if halve == 3 { middle } else { secant };
        let next = if next > low && next < high {
            next
        } else {
            middle
        };
        if next <= low || next >= high {
            return high;
        }
        let value = f(next);
        if value > 0.0 {
            (low, at_low) = (next, value);
            if side == 1 {
                at_high *= 0.5;
            }
            side = 1;
        } else {
            (high, at_high) = (next, value);
            if side == 2 {
                at_low *= 0.5;
            }
            side = 2;
        }
        if halve == 3 {
            if high - low > 0.5 * width {
                side = 0;
            }
            (halve, width) = (0, high - low);
        }
    }
    high
}

impl Cap {
    /// f_t/G_I: decay rate of the bond with plastic opening [1/mm].
    pub(super) fn loss_by_opening(&self) -> f64 {
        if self.f_t > 0.0 {
            self.f_t / self.mode_1
        } else {
            0.0
        }
    }

    /// c/G_II: decay rate of the bond with plastic slip [1/mm].
    pub(super) fn loss_by_slip(&self) -> f64 {
        if self.c > 0.0 {
            self.c / self.mode_2
        } else {
            0.0
        }
    }

    /// tan φ for the remaining fraction `left` of the bond [-].
    pub(super) fn friction(&self, left: f64) -> f64 {
        self.mu + (self.tan_phi - self.mu) * left
    }

    /// tan ψ at σ and s_p [-], and its derivatives by σ [1/MPa] and by s_p [1/mm].
    fn dilatancy(&self, sigma: f64, slip: f64) -> [f64; 3] {
        if self.tan_psi == 0.0 {
            return [0.0; 3];
        }
        let start = self.tan_psi * (-self.decay * slip).exp();
        let (weight, slope) = if sigma >= 0.0 {
            (1.0, 0.0)
        } else if sigma > -self.sigma_u {
            (1.0 + sigma / self.sigma_u, 1.0 / self.sigma_u)
        } else {
            (0.0, 0.0)
        };
        [start * weight, start * slope, -self.decay * start * weight]
    }

    /// √(C_nn ⟨−σ⟩² + C_ss τ²) [MPa].
    pub(super) fn cap_size(&self, sigma: f64, tau: f64) -> f64 {
        let sigma = sigma.min(0.0);
        (self.c_nn * sigma * sigma + self.c_ss * tau * tau).sqrt()
    }

    /// Plastic displacement of the cap per unit of its multiplier [MPa].
    fn cap_rate(&self, sigma: f64, tau: f64) -> f64 {
        (self.c_nn * sigma.min(0.0)).hypot(self.c_ss * tau)
    }

    /// Returns a trial traction to the admissible set. Single surfaces are tried first, then pairs.
    pub(super) fn return_map(&self, trial: &Trial) -> Returned {
        let strength = self.curve.evaluate(trial.crushing).0;
        let Trial {
            sigma, tau, left, ..
        } = *trial;
        let tension = sigma > self.f_t * left;
        let friction = tau + self.friction(left) * sigma > self.c * left;
        let cap = self.cap_size(sigma, tau) > strength;
        if !(tension || friction || cap) {
            return self.finish(trial, &Multipliers::default());
        }
        let most = ROUNDING * (self.curve.strength + self.f_t + self.c);
        let one = |surface: usize| {
            let mut active = [false; 3];
            active[surface] = true;
            active
        };
        if tension {
            let m = Multipliers {
                tension: self.tension_multiplier(trial),
                active: one(0),
                ..Multipliers::default()
            };
            if self.holds(trial, &m, most) {
                return self.finish(trial, &m);
            }
        }
        if friction {
            let m = Multipliers {
                friction: self.friction_multiplier(trial, 0.0),
                active: one(1),
                ..Multipliers::default()
            };
            if self.holds(trial, &m, most) {
                return self.finish(trial, &m);
            }
        }
        if cap {
            let m = Multipliers {
                cap: self.cap_multiplier(trial, false),
                active: one(2),
                ..Multipliers::default()
            };
            if self.holds(trial, &m, most) {
                return self.finish(trial, &m);
            }
        }
        if tension || friction {
            let m = self.tension_and_friction(trial);
            if (m.tension >= 0.0 && m.friction >= 0.0) || !cap {
                return self.finish(trial, &m);
            }
        }
        let cap = self.cap_multiplier(trial, true);
        let m = Multipliers {
            tension: 0.0,
            friction: self.friction_multiplier(trial, cap),
            cap,
            active: [false, true, true],
        };
        self.finish(trial, &m)
    }

    /// λ₁ from σ* − k_n λ₁ = f_t (1 − D(λ₁)).
    fn tension_multiplier(&self, trial: &Trial) -> f64 {
        let (k, loss) = (trial.stiffness[0], self.loss_by_opening());
        let strength = self.f_t * trial.left;
        root(0.0, trial.sigma / k, |l| {
            trial.sigma - k * l - strength * (-loss * l).exp()
        })
    }

    /// σ for given multipliers of friction and cap: σ (1 + k_n C_nn μ') = σ* − k_n λ₂ tan ψ(σ).
    fn sigma(&self, trial: &Trial, friction: f64, cap: f64) -> f64 {
        let k = trial.stiffness[0];
        let slip = trial.slip + friction;
        let lift = k * friction * self.tan_psi * (-self.decay * slip).exp();
        if trial.sigma - lift >= 0.0 {
            return trial.sigma - lift;
        }
        let divisor = 1.0 + k * self.c_nn * cap;
        if lift == 0.0 || trial.sigma / divisor <= -self.sigma_u {
            trial.sigma / divisor
        } else {
            (trial.sigma - lift) / (divisor + lift / self.sigma_u)
        }
    }

    /// τ| for given multipliers of friction and cap.
    fn tau(&self, trial: &Trial, friction: f64, cap: f64) -> f64 {
        let k = trial.stiffness[1];
        (trial.tau - k * friction).max(0.0) / (1.0 + k * self.c_ss * cap)
    }

    /// λ₂ on the friction surface for a given multiplier of the cap; 0 if the trial lies inside the surface.
    fn friction_multiplier(&self, trial: &Trial, cap: f64) -> f64 {
        let loss = self.loss_by_slip();
        root(0.0, trial.tau / trial.stiffness[1], |l| {
            let left = trial.left * (-loss * l).exp();
            let sigma = self.sigma(trial, l, cap);
            self.tau(trial, l, cap) + self.friction(left) * sigma - self.c * left
        })
    }

    /// μ' on the cap, alone or together with friction.
    fn cap_multiplier(&self, trial: &Trial, with_friction: bool) -> f64 {
        let excess = |m: f64| {
            let friction = if with_friction {
                self.friction_multiplier(trial, m)
            } else {
                0.0
            };
            let sigma = self.sigma(trial, friction, m);
            let tau = self.tau(trial, friction, m);
            let kappa = trial.crushing + m * self.cap_rate(sigma, tau);
            self.cap_size(sigma, tau) - self.curve.evaluate(kappa).0
        };
        let mut high = 1.0 / trial.stiffness[0];
        for _ in 0..100 {
            if excess(high) <= 0.0 {
                break;
            }
            high *= 4.0;
        }
        root(0.0, high, excess)
    }

    /// Both multipliers at the corner of tension and friction. The unknown is the loss of the bond, −ln((1 − D)/(1 −
    /// Dₙ)).
    fn tension_and_friction(&self, trial: &Trial) -> Multipliers {
        let [k_n, k_s] = trial.stiffness;
        let losses = [self.loss_by_opening(), self.loss_by_slip()];
        let both = |loss: f64| {
            let left = trial.left * (-loss).exp();
            let sigma = self.f_t * left;
            let tau = (self.c * left - self.friction(left) * sigma).max(0.0);
            let friction = (trial.tau - tau) / k_s;
            let [dilatancy, ..] = self.dilatancy(sigma, trial.slip + friction);
            [(trial.sigma - sigma) / k_n - friction * dilatancy, friction]
        };
        let most = losses[0] * trial.sigma.max(0.0) / k_n + losses[1] * trial.tau / k_s;
        let loss = root(0.0, most, |loss| {
            let [tension, friction] = both(loss);
            losses[0] * tension + losses[1] * friction - loss
        });
        let [tension, friction] = both(loss);
        Multipliers {
            tension,
            friction,
            cap: 0.0,
            active: [true, true, false],
        }
    }

    /// σ, |τ|, 1 − D and κ_c for given multipliers.
    fn end(&self, trial: &Trial, m: &Multipliers) -> [f64; 4] {
        let loss = self.loss_by_opening() * m.tension + self.loss_by_slip() * m.friction;
        let left = trial.left * (-loss).exp();
        let (sigma, tau) = if m.active == [true, true, false] {
            let sigma = self.f_t * left;
            (
                sigma,
                (self.c * left - self.friction(left) * sigma).max(0.0),
            )
        } else if m.active[0] {
            (self.f_t * left, trial.tau)
        } else {
            let sigma = self.sigma(trial, m.friction, m.cap);
            let tau = if m.active[1] {
                // This is τ on the surface. It differs from `self.tau` only by rounding, which grows with the slip.
                (self.c * left - self.friction(left) * sigma).max(0.0)
            } else {
                self.tau(trial, m.friction, m.cap)
            };
            (sigma, tau)
        };
        let crushing = trial.crushing + m.cap * self.cap_rate(sigma, tau);
        [sigma, tau, left, crushing]
    }

    /// Whether no inactive surface is violated by more than `most`.
    fn holds(&self, trial: &Trial, m: &Multipliers, most: f64) -> bool {
        let [sigma, tau, left, crushing] = self.end(trial, m);
        let excess = [
            sigma - self.f_t * left,
            tau + self.friction(left) * sigma - self.c * left,
            self.cap_size(sigma, tau) - self.curve.evaluate(crushing).0,
        ];
        (0..3).all(|i| m.active[i] || excess[i] <= most)
    }

    /// Result for given multipliers, with its derivatives.
    fn finish(&self, trial: &Trial, m: &Multipliers) -> Returned {
        let [sigma, tau, left, crushing] = self.end(trial, m);
        let pressed = sigma.min(0.0);
        let [dilatancy, ..] = self.dilatancy(sigma, trial.slip + m.friction);
        let slopes = if m.active == [false; 3] {
            [[1.0, 0.0], [0.0, 1.0]]
        } else {
            self.slopes(trial, m, [sigma, tau, left, crushing])
        };
        Returned {
            sigma,
            tau,
            slopes,
            gap: m.tension,
            opening: m.tension + m.friction * dilatancy + self.c_nn * m.cap * pressed,
            slip: m.friction + self.c_ss * m.cap * tau,
            friction_slip: m.friction,
            left,
            crushing,
        }
    }

    /// Derivatives of the result by the trial traction, from the linearised system in σ, |τ|, λ₁, λ₂, μ'.
    fn slopes(
        &self,
        trial: &Trial,
        m: &Multipliers,
        [sigma, tau, left, crushing]: [f64; 4],
    ) -> [[f64; 2]; 2] {
        let [k_n, k_s] = trial.stiffness;
        let losses = [self.loss_by_opening(), self.loss_by_slip()];
        let pressed = sigma.min(0.0);
        let presses = if sigma < 0.0 { 1.0 } else { 0.0 };
        let [dilatancy, by_sigma, by_slip] = self.dilatancy(sigma, trial.slip + m.friction);
        let mut j = Matrix5::zeros();
        j[(0, 0)] = 1.0 + k_n * (m.friction * by_sigma + self.c_nn * m.cap * presses);
        j[(0, 2)] = k_n;
        j[(0, 3)] = k_n * (dilatancy + m.friction * by_slip);
        j[(0, 4)] = k_n * self.c_nn * pressed;
        j[(1, 1)] = 1.0 + k_s * self.c_ss * m.cap;
        j[(1, 3)] = k_s;
        j[(1, 4)] = k_s * self.c_ss * tau;
        if m.active[0] {
            j[(2, 0)] = 1.0;
            j[(2, 2)] = self.f_t * left * losses[0];
            j[(2, 3)] = self.f_t * left * losses[1];
        } else {
            j[(2, 2)] = 1.0;
        }
        if m.active[1] {
            let by_left = (self.tan_phi - self.mu) * sigma - self.c;
            j[(3, 0)] = self.friction(left);
            j[(3, 1)] = 1.0;
            j[(3, 2)] = -by_left * left * losses[0];
            j[(3, 3)] = -by_left * left * losses[1];
        } else {
            j[(3, 3)] = 1.0;
        }
        if m.active[2] {
            let size = self.cap_size(sigma, tau);
            let rate = self.cap_rate(sigma, tau);
            let slope = self.curve.evaluate(crushing).1;
            let over = |number: f64, by: f64| if by > 0.0 { number / by } else { 0.0 };
            j[(4, 0)] = over(self.c_nn * pressed, size)
                - slope * m.cap * over(self.c_nn * self.c_nn * pressed, rate);
            j[(4, 1)] = over(self.c_ss * tau, size)
                - slope * m.cap * over(self.c_ss * self.c_ss * tau, rate);
            j[(4, 4)] = -slope * rate;
        } else {
            j[(4, 4)] = 1.0;
        }
        let mut by = SMatrix::<f64, 5, 2>::zeros();
        by[(0, 0)] = 1.0;
        by[(1, 1)] = 1.0;
        let Some(x) = j.lu().solve(&by) else {
            return [[0.0; 2]; 2];
        };
        [[x[(0, 0)], x[(0, 1)]], [x[(1, 0)], x[(1, 1)]]]
    }
}
