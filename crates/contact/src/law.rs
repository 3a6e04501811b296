//! The cohesive-frictional law of one interface point (theory/joint.md, eqs 9 to 31).

use nalgebra::{Matrix3, Vector2};
use serde::{Deserialize, Serialize};

use crate::cohesive::Wholes;
use crate::softening::Softening;

/// Coupling of the damage by opening and by slip (theory/joint.md, eqs 12 and 13).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Coupling {
    /// D = max(Q, H), the paper's Q = H.
    #[default]
    Max,
    /// dD = Q'(Q⁻¹(D)) ⟨dw⟩ + H'(H⁻¹(D)) ⟨ds⟩.
    Additive,
}

/// Number of additional history variables that a law may use.
pub const SLOTS: usize = 4;

/// Parameters of the cohesive-frictional law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CohesiveFrictional {
    /// Tensile strength f_t [MPa].
    pub f_t: f64,
    /// Cohesion c [MPa].
    pub c: f64,
    /// Initial friction tan φ [-].
    pub tan_phi: f64,
    /// Residual friction μ [-].
    pub mu: f64,
    /// Ultimate opening u_k [mm].
    pub u_k: f64,
    /// Ultimate slip δ_k [mm].
    pub delta_k: f64,
    /// Brittleness in tension ζ [-].
    pub zeta: f64,
    /// Brittleness in shear ξ [-].
    pub xi: f64,
    /// Normal stiffness k_n [N/mm³].
    pub normal_stiffness: f64,
    /// Shear stiffness k_s [N/mm³].
    pub shear_stiffness: f64,
    /// Coupling of the modes.
    pub coupling: Coupling,
}

/// History of one interface point. Slips are components in the tangential frame of the point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InterfaceHistory {
    /// Opening u at the end of the step [mm].
    pub opening: f64,
    /// Largest opening so far u_max [mm].
    pub opening_max: f64,
    /// Largest plastic slip so far s_max [mm].
    pub slip_max: f64,
    /// Total slip δ [mm].
    pub slip: [f64; 2],
    /// Plastic slip δ_p [mm].
    pub plastic_slip: [f64; 2],
    /// Damage D = Q = H [-].
    pub damage: f64,
    /// Traction [σ, τ₁, τ₂] at the end of the step [MPa].
    pub traction: [f64; 3],
    /// Additional variables of a law, see [`Output`](crate::Output). They are scalars and do not rotate with the
    /// frame.
    pub slots: [f64; SLOTS],
}

/// Contact status of an interface point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PointStatus {
    /// In contact or bonded, without sliding.
    #[default]
    Stick,
    /// Sliding in this step.
    Slip,
    /// Open beyond the elastic opening, with or without remaining cohesion.
    Open,
}

/// Response of a law to one gap.
#[derive(Clone, Copy, Debug)]
pub struct InterfaceResponse {
    /// [σ, τ₁, τ₂] [MPa].
    pub traction: [f64; 3],
    /// d[σ, τ₁, τ₂]/d[u, δ₁, δ₂] [N/mm³].
    pub tangent: Matrix3<f64>,
    /// History at the end of the step.
    pub history: InterfaceHistory,
    /// Contact status.
    pub status: PointStatus,
    /// Free energy ψ at the end of the step (theory/joint.md, eq. 20) [N/mm].
    pub elastic_energy: f64,
    /// Dissipation of the step [N/mm] by the trapezoidal rule: ½ u_n u_{n+1} (k_n − k_{n+1}) with the secant
    /// stiffnesses, plus ½ (τ_n + τ_{n+1})·Δδ_p. With work from the same rule the energy balance closes.
    pub dissipation: f64,
}

impl InterfaceResponse {
    /// Response of a law with one elastic stiffness `[k_n, k_s]` [N/mm³]: traction [MPa] and tangent [N/mm³] at the
    /// total `gap` [mm]. `plastic_old` and `plastic` are the plastic parts `[u_p, δ_p1, δ_p2]` [mm] before and after
    /// the step, `damage` is that of the bond, and `slots` are the law's own variables. Slip, largest opening and
    /// slip, energies and status follow. Points count as open beyond `opens_at` [mm].
    ///
    /// The dissipation is that of the trapezoidal rule, ½ (t_n + t_{n+1})·Δp, so that the energy balance closes.
    #[expect(
        clippy::too_many_arguments,
        reason = "each argument is another input of the record that a law returns"
    )]
    pub fn new(
        old: &InterfaceHistory,
        gap: [f64; 3],
        traction: [f64; 3],
        tangent: Matrix3<f64>,
        [plastic_old, plastic]: [[f64; 3]; 2],
        damage: f64,
        slots: [f64; SLOTS],
        [normal, shear]: [f64; 2],
        opens_at: f64,
    ) -> Self {
        let slides = plastic[1] != plastic_old[1] || plastic[2] != plastic_old[2];
        let status = if gap[0] > opens_at && traction[0] >= 0.0 {
            PointStatus::Open
        } else if slides {
            PointStatus::Slip
        } else {
            PointStatus::Stick
        };
        let mut dissipation = 0.0;
        for i in 0..3 {
            let mean = 0.5 * (traction[i] + old.traction[i]);
            dissipation += mean * (plastic[i] - plastic_old[i]);
        }
        let reach = plastic[1].hypot(plastic[2]);
        let [sigma, tau_1, tau_2] = traction;
        Self {
            traction,
            tangent,
            history: InterfaceHistory {
                opening: gap[0],
                opening_max: old.opening_max.max(gap[0]),
                slip_max: old.slip_max.max(reach),
                slip: [gap[1], gap[2]],
                plastic_slip: [plastic[1], plastic[2]],
                damage,
                traction,
                slots,
            },
            status,
            elastic_energy: 0.5 * sigma * sigma / normal
                + 0.5 * (tau_1 * tau_1 + tau_2 * tau_2) / shear,
            dissipation,
        }
    }
}

impl CohesiveFrictional {
    /// A dry joint: friction only, D = 1 from the beginning (theory/joint.md, eq. 19).
    pub fn dry(mu: f64, normal_stiffness: f64, shear_stiffness: f64) -> Self {
        Self {
            f_t: 0.0,
            c: 0.0,
            tan_phi: mu,
            mu,
            u_k: 1.0,
            delta_k: 1.0,
            zeta: 1.0,
            xi: 1.0,
            normal_stiffness,
            shear_stiffness,
            coupling: Coupling::Max,
        }
    }

    /// True if the joint has no bond.
    pub fn is_dry(&self) -> bool {
        self.f_t == 0.0 && self.c == 0.0
    }

    /// Initial history of a point.
    pub fn virgin(&self) -> InterfaceHistory {
        let damage = if self.is_dry() { 1.0 } else { 0.0 };
        InterfaceHistory {
            damage,
            ..InterfaceHistory::default()
        }
    }

    /// Opening beyond which a point counts as open, f_t/k_n [mm].
    pub fn opens_at(&self) -> f64 {
        self.elastic_opening()
    }

    /// Softening curve Q(w) as a function of the opening after onset.
    pub fn opening_curve(&self) -> Softening {
        Softening {
            ultimate: self.u_k,
            brittleness: self.zeta,
        }
    }

    /// Softening curve H(s) as a function of the plastic slip.
    pub fn slip_curve(&self) -> Softening {
        Softening {
            ultimate: self.delta_k,
            brittleness: self.xi,
        }
    }

    /// Mode I energy G_I = f_t u_k (1/ζ − 1/(e^ζ−1)) [N/mm] (theory/joint.md, eq. 30).
    pub fn mode_1_energy(&self) -> f64 {
        self.f_t * self.u_k * Softening::shape_integral(self.zeta)
    }

    /// Mode II energy above the residual friction at normal traction σ ≤ 0 [N/mm] (theory/joint.md, eq. 30).
    pub fn mode_2_energy(&self, sigma: f64) -> f64 {
        let pressure = (-sigma).max(0.0);
        (self.c + (self.tan_phi - self.mu) * pressure)
            * self.delta_k
            * Softening::shape_integral(self.xi)
    }

    /// One implicit step: traction, consistent tangent and new history at the total gap
    /// `[u, δ₁, δ₂]` [mm], u positive when open.
    #[expect(
        clippy::too_many_lines,
        reason = "the formulas of one implicit step and its consistent tangent"
    )]
    pub fn update(&self, gap: [f64; 3], old: &InterfaceHistory) -> InterfaceResponse {
        let u = gap[0];
        let slip = Vector2::new(gap[1], gap[2]);
        let plastic = Vector2::from(old.plastic_slip);
        let k_s = self.shear_stiffness;
        let opening_max = old.opening_max.max(u);
        let grows = u > 0.0 && u >= opening_max;
        let normal_at = |damage: f64| self.normal(u, opening_max, damage, grows);

        let trial = k_s * (slip - plastic);
        let size = trial.norm();
        let mut wholes = Wholes::default();
        let mut damage = self.damage(opening_max, old.slip_max, old, &mut wholes);
        let mut normal = normal_at(damage.value);
        let limit = self.limit(normal.traction, damage.value);
        let mut history = InterfaceHistory {
            opening: u,
            opening_max,
            slip_max: old.slip_max,
            slip: slip.into(),
            plastic_slip: old.plastic_slip,
            damage: damage.value,
            traction: [0.0; 3],
            slots: old.slots,
        };
        if size <= limit.value || size == 0.0 {
            // Stick: σ may still depend on u through D(u).
            let mut tangent = Matrix3::from_diagonal(&[0.0, k_s, k_s].into());
            tangent[(0, 0)] = normal.by_gap + normal.by_damage * damage.by_opening;
            return self.respond(normal.traction, trial, tangent, history, old, false);
        }

        let n = trial / size;
        let dg = self.return_slip(size, n, plastic, opening_max, old, normal_at, &mut wholes);
        let new_plastic = plastic + dg * n;
        let reach = new_plastic.norm();
        let further = reach > old.slip_max;
        history.slip_max = old.slip_max.max(reach);
        history.plastic_slip = new_plastic.into();
        damage = self.damage(opening_max, history.slip_max, old, &mut wholes);
        normal = normal_at(damage.value);
        history.damage = damage.value;

        // Consistent tangent, theory/joint.md, eqs 24 to 29.
        let limit = self.limit(normal.traction, damage.value);
        let by_damage = limit.by_traction * normal.by_damage + limit.by_damage;
        let d_s = if further { damage.by_slip } else { 0.0 };
        let m = if reach > 0.0 { new_plastic / reach } else { n };
        let projector = (nalgebra::Matrix2::identity() - n * n.transpose()) * (k_s / size);
        let den = k_s + by_damage * d_s * m.dot(&n);
        let dg_du = -(limit.by_traction * normal.by_gap + by_damage * damage.by_opening) / den;
        let projected = projector * m;
        let dg_dslip = (k_s * n - by_damage * d_s * dg * projected) / den;
        let dd_du = damage.by_opening + d_s * m.dot(&n) * dg_du;
        let dd_dslip = d_s * (m.dot(&n) * dg_dslip + dg * projected);
        let dtau_du = -k_s * dg_du * n;
        let dtau_dslip = k_s * (n * n.transpose()) - k_s * n * dg_dslip.transpose()
            + (size - k_s * dg) * projector;
        let mut tangent = Matrix3::zeros();
        tangent[(0, 0)] = normal.by_gap + normal.by_damage * dd_du;
        for j in 0..2 {
            tangent[(0, 1 + j)] = normal.by_damage * dd_dslip[j];
            tangent[(1 + j, 0)] = dtau_du[j];
            for i in 0..2 {
                tangent[(1 + i, 1 + j)] = dtau_dslip[(i, j)];
            }
        }
        // On the surface |τ| = g. |τ_tr| − k_s Δγ differs only by rounding, which grows with the slip.
        let shear = limit.value * n;
        self.respond(normal.traction, shear, tangent, history, old, true)
    }

    /// Free energy ψ of a point (theory/joint.md, eq. 20) [N/mm].
    pub fn free_energy(&self, history: &InterfaceHistory) -> f64 {
        let [sigma, tau_1, tau_2] = history.traction;
        let normal = if sigma <= 0.0 {
            0.5 * sigma * sigma / self.normal_stiffness
        } else {
            let u = history.opening.max(0.0);
            0.5 * self.secant_stiffness(history.opening_max, history.damage) * u * u
        };
        normal + 0.5 * (tau_1 * tau_1 + tau_2 * tau_2) / self.shear_stiffness
    }

    /// Spurious work of the trapezoidal rule for a point that opens or closes within an increment: ½ u₀ u₁ (k₀ − k₁)
    /// with the stiffness of each branch [N/mm]. It is not dissipation: closing and opening cancel.
    pub fn crossing_work(&self, old: &InterfaceHistory, new: &InterfaceHistory) -> f64 {
        if old.opening * new.opening >= 0.0 {
            return 0.0;
        }
        let branch = |h: &InterfaceHistory| {
            if h.opening > 0.0 {
                self.secant_stiffness(h.opening_max, h.damage)
            } else {
                self.normal_stiffness
            }
        };
        0.5 * old.opening * new.opening * (branch(old) - branch(new))
    }

    /// Adds status and energies to a response.
    #[inline(always)]
    #[expect(
        clippy::too_many_arguments,
        reason = "the parts of a response, joined in the hot loop"
    )]
    pub(crate) fn respond(
        &self,
        sigma: f64,
        shear: Vector2<f64>,
        tangent: Matrix3<f64>,
        mut history: InterfaceHistory,
        old: &InterfaceHistory,
        slides: bool,
    ) -> InterfaceResponse {
        let traction = [sigma, shear.x, shear.y];
        history.traction = traction;
        let u = history.opening;
        let status = if u > self.elastic_opening() {
            PointStatus::Open
        } else if slides {
            PointStatus::Slip
        } else {
            PointStatus::Stick
        };
        let mut opening_work = 0.0;
        if u > 0.0 && old.opening > 0.0 {
            let secant = self.secant_stiffness(history.opening_max, history.damage);
            let secant_old = self.secant_stiffness(old.opening_max, old.damage);
            opening_work = 0.5 * u * old.opening * (secant_old - secant);
        }
        let mut slip_work = 0.0;
        for i in 0..2 {
            slip_work += 0.5
                * (traction[1 + i] + old.traction[1 + i])
                * (history.plastic_slip[i] - old.plastic_slip[i]);
        }
        let elastic_energy = self.free_energy(&history);
        InterfaceResponse {
            traction,
            tangent,
            history,
            status,
            elastic_energy,
            dissipation: opening_work + slip_work,
        }
    }
}
