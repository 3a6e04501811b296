//! The cohesive-frictional law of one interface point (theory C).

use serde::{Deserialize, Serialize};

/// How opening and slip damage the same bond (theory C.3).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Coupling {
    /// D = max(Q, H), the paper's Q = H.
    #[default]
    Max,
    /// dD = Q'(Q⁻¹(D)) ⟨dw⟩ + H'(H⁻¹(D)) ⟨ds⟩.
    Additive,
}

/// Parameters of an interface point, stiffnesses resolved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InterfaceLaw {
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

/// History of one interface point. Slips are components in the point's tangent frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct InterfaceHistory {
    /// Largest opening ever u_max [mm].
    pub opening_max: f64,
    /// Largest plastic slip ever s_max [mm].
    pub slip_max: f64,
    /// Total slip δ [mm].
    pub slip: [f64; 2],
    /// Plastic slip δ_p [mm].
    pub plastic_slip: [f64; 2],
    /// Damage D = Q = H [-].
    pub damage: f64,
    /// Traction [σ, τ₁, τ₂] at the end of the step [MPa].
    pub traction: [f64; 3],
}

/// What an interface point does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PointStatus {
    /// Touching or bonded, not sliding.
    #[default]
    Stick,
    /// Sliding in this step.
    Slip,
    /// Open: beyond the elastic opening, with or without remaining cohesion.
    Open,
}
