//! The cap law as a [`JointLaw`].

use std::sync::Arc;

use nalgebra::{Matrix2, Matrix3, Vector2};

use super::return_map::{Returned, Trial};
use super::{Cap, CapCurve, slot};
use crate::joint::{JointLaw, Output, symmetric_blocks};
use crate::law::{InterfaceHistory, InterfaceResponse};
use crate::shifted::Shift;

const OUTPUTS: [Output; 3] = [
    Output::new("plastic_opening", "mm", slot::OPENING),
    Output::new("plastic_slip", "mm", slot::SLIP),
    Output::new("crushing", "mm", slot::CRUSHING),
];

/// Remaining fraction of the bond that defines the ultimate opening.
const NEXT_TO_NOTHING: f64 = 0.01;

impl Cap {
    /// Whether this is the law of a joint cut at its middle (see [`half`](Self::half)). No deck gives an infinite
    /// G_II.
    pub fn is_half(&self) -> bool {
        self.mode_2 == f64::INFINITY
    }

    /// Law of one half of a joint in a plane of symmetry. The stiffnesses are doubled, the mode I energy and the
    /// plastic displacements of the cap are halved. Slip is free.
    #[must_use]
    pub fn half(&self) -> Self {
        Self {
            normal_stiffness: 2.0 * self.normal_stiffness,
            shear_stiffness: 2.0 * self.shear_stiffness,
            mode_1: 0.5 * self.mode_1,
            mode_2: f64::INFINITY,
            c: 0.0,
            tan_phi: 0.0,
            mu: 0.0,
            tan_psi: 0.0,
            curve: CapCurve {
                peak: 0.5 * self.curve.peak,
                middle: 0.5 * self.curve.middle,
                ..self.curve
            },
            ..*self
        }
    }

    /// Largest shear traction that the friction surface allows at σ with 1 − D = `left` [MPa].
    fn limit(&self, sigma: f64, left: f64) -> f64 {
        (self.c * left - self.friction(left) * sigma).max(0.0)
    }

    /// Return of a trial with the gap `gap` at the start of the step [mm] and the gap at its end (docs/theory/joint-cap.md,
    /// eqs 13 and 14). The increment of the plastic opening has the change of the gap in it.
    fn close(&self, trial: &Trial, gap: f64) -> (Returned, f64) {
        let stays = !self.closes || gap == 0.0;
        if stays || trial.sigma >= 0.0 {
            let returned = self.return_map(trial);
            if stays || returned.sigma >= 0.0 {
                let grown = if self.closes { returned.gap } else { 0.0 };
                return (returned, gap + grown);
            }
        }
        // Open: no normal traction, whatever the opening.
        let opening = trial.sigma / trial.stiffness[0];
        let mut returned = self.return_map(&Trial {
            sigma: 0.0,
            stiffness: [0.0, trial.stiffness[1]],
            ..*trial
        });
        let left_open = gap + opening - returned.opening;
        if left_open >= 0.0 {
            returned.opening = opening;
            returned.slopes = [[0.0; 2], [0.0, returned.slopes[1][1]]];
            return (returned, left_open);
        }
        // Closed: the faces meet within the step.
        let mut returned = self.return_map(&Trial {
            sigma: trial.sigma + trial.stiffness[0] * gap,
            ..*trial
        });
        returned.opening -= gap;
        (returned, returned.gap)
    }

    /// Response to a trial traction that is returned with the given stiffness.
    fn answer(
        &self,
        gap: [f64; 3],
        old: &InterfaceHistory,
        trial: [f64; 3],
        stiffness: [f64; 2],
    ) -> InterfaceResponse {
        let shear = Vector2::new(trial[1], trial[2]);
        let size = shear.norm();
        let n = if size > 0.0 {
            shear / size
        } else {
            Vector2::x()
        };
        let (returned, left_open) = self.close(
            &Trial {
                sigma: trial[0],
                tau: size,
                stiffness,
                left: 1.0 - old.damage,
                slip: old.slots[slot::SLIP],
                crushing: old.slots[slot::CRUSHING],
            },
            old.slots[slot::GAP],
        );
        let tau = returned.tau * n;
        let traction = [returned.sigma, tau.x, tau.y];
        let before = [
            old.slots[slot::OPENING],
            old.plastic_slip[0],
            old.plastic_slip[1],
        ];
        let plastic = [
            before[0] + returned.opening,
            before[1] + returned.slip * n.x,
            before[2] + returned.slip * n.y,
        ];
        let mut slots = old.slots;
        slots[slot::OPENING] = plastic[0];
        slots[slot::SLIP] += returned.friction_slip;
        slots[slot::CRUSHING] = returned.crushing;
        slots[slot::GAP] = left_open;
        let mut response = InterfaceResponse::new(
            old,
            gap,
            traction,
            tangent(&returned, size, n, stiffness),
            [before, plastic],
            1.0 - returned.left,
            slots,
            self.stiffness(),
            self.opens_at(),
        );
        response.dissipation -= self.crossing_work(old, &response.history);
        response
    }
}

/// dt/dg for a trial with shear traction `size` along `n`; `[k_n, k_s]` is the stiffness used in the return.
fn tangent(returned: &Returned, size: f64, n: Vector2<f64>, [k_n, k_s]: [f64; 2]) -> Matrix3<f64> {
    let [[nn, ns], [sn, ss]] = returned.slopes;
    let across = if size > 0.0 { returned.tau / size } else { ss };
    let along = n * n.transpose();
    let shear = k_s * (ss * along + across * (Matrix2::identity() - along));
    let mut tangent = Matrix3::zeros();
    tangent[(0, 0)] = k_n * nn;
    for i in 0..2 {
        tangent[(0, 1 + i)] = k_s * ns * n[i];
        tangent[(1 + i, 0)] = k_n * sn * n[i];
        for j in 0..2 {
            tangent[(1 + i, 1 + j)] = shear[(i, j)];
        }
    }
    tangent
}

impl JointLaw for Cap {
    fn name(&self) -> &'static str {
        "cap"
    }

    fn stiffness(&self) -> [f64; 2] {
        [self.normal_stiffness, self.shear_stiffness]
    }

    fn update(&self, gap: [f64; 3], old: &InterfaceHistory) -> InterfaceResponse {
        let [k_n, k_s] = self.stiffness();
        let trial = [
            k_n * (gap[0] - old.slots[slot::OPENING]),
            k_s * (gap[1] - old.plastic_slip[0]),
            k_s * (gap[2] - old.plastic_slip[1]),
        ];
        self.answer(gap, old, trial, [k_n, k_s])
    }

    /// Equation (1) of [`joint`](crate::joint) in closed form: the same return map, with the numerical stiffness and
    /// the trial traction k' (g − p) + (1 − k'/k) t₋.
    fn update_shifted(
        &self,
        gap: [f64; 3],
        old: &InterfaceHistory,
        shift: &Shift,
    ) -> InterfaceResponse {
        let [k_n, k_s] = self.stiffness();
        let soft = [shift.stiffness[0].min(k_n), shift.stiffness[1].min(k_s)];
        let before = [
            old.slots[slot::OPENING],
            old.plastic_slip[0],
            old.plastic_slip[1],
        ];
        let own = [soft[0], soft[1], soft[1]];
        let whole = [k_n, k_s, k_s];
        let trial = [0, 1, 2]
            .map(|i| own[i] * (gap[i] - before[i]) + (1.0 - own[i] / whole[i]) * shift.traction[i]);
        let mut response = self.answer(gap, old, trial, soft);
        // The history stores the opening that follows from the elastic and plastic parts.
        let opening = response.traction[0] / k_n + response.history.slots[slot::OPENING];
        response.history.opening = opening;
        response.history.opening_max = old.opening_max.max(opening);
        response.tangent = symmetric_blocks(&response.tangent, soft);
        response
    }

    /// Work of the trapezoidal rule on a gap that closes: no traction acts on it.
    fn crossing_work(&self, old: &InterfaceHistory, new: &InterfaceHistory) -> f64 {
        let closed = (new.slots[slot::GAP] - old.slots[slot::GAP]).min(0.0);
        0.5 * (old.traction[0] + new.traction[0]) * closed
    }

    fn outputs(&self) -> &'static [Output] {
        &OUTPUTS
    }

    /// A point that meets a face again has no bond and no gap. Its plastic opening from crushing and dilatancy remains.
    fn lost(&self, old: &InterfaceHistory) -> InterfaceHistory {
        let mut slots = old.slots;
        slots[slot::OPENING] -= slots[slot::GAP];
        slots[slot::GAP] = 0.0;
        InterfaceHistory {
            slip: old.plastic_slip,
            damage: 1.0,
            traction: [0.0; 3],
            opening: slots[slot::OPENING],
            slots,
            ..*old
        }
    }

    fn is_dry(&self) -> bool {
        self.f_t == 0.0 && self.c == 0.0
    }

    fn opens_at(&self) -> f64 {
        self.f_t / self.normal_stiffness
    }

    fn ultimate_opening(&self) -> f64 {
        if self.f_t > 0.0 {
            -NEXT_TO_NOTHING.ln() / self.loss_by_opening()
        } else {
            0.0
        }
    }

    fn utilisation(&self, traction: &[f64; 3], history: &InterfaceHistory) -> f64 {
        let [sigma, tau_1, tau_2] = *traction;
        if sigma >= 0.0 {
            return f64::INFINITY;
        }
        let tau = tau_1.hypot(tau_2);
        let strength = self.curve.evaluate(history.slots[slot::CRUSHING]).0;
        let crushing = self.cap_size(sigma, tau) / strength;
        crushing.max(tau / self.limit(sigma, 1.0 - history.damage))
    }

    fn exertion(&self, traction: &[f64; 3], history: &InterfaceHistory) -> f64 {
        let [sigma, tau_1, tau_2] = *traction;
        if sigma < 0.0 {
            return JointLaw::utilisation(self, traction, history);
        }
        let left = 1.0 - history.damage;
        let (strength, limit) = (self.f_t * left, self.limit(sigma, left));
        if strength > 0.0 && limit > 0.0 {
            (sigma / strength).max(tau_1.hypot(tau_2) / limit)
        } else {
            f64::INFINITY
        }
    }

    // Under pressure alone |σ| = f̄/√C_nn, in shear alone |τ| = f̄/√C_ss, and κ is the plastic displacement.
    fn softening_slopes(&self) -> [f64; 2] {
        [
            (self.f_t * self.loss_by_opening()).max(self.curve.steepest() / self.c_nn.sqrt()),
            (self.c * self.loss_by_slip()).max(self.curve.steepest() / self.c_ss.sqrt()),
        ]
    }

    fn halved(&self) -> Option<Arc<dyn JointLaw>> {
        Some(Arc::new(self.half()))
    }
}
