//! Joint law for expanded units: tension cut-off, Coulomb friction and a compression cap (docs/theory/joint-cap.md;
//! Lourenço & Rots 1997, doi 10.1061/(ASCE)0733-9399(1997)123:7(660)).

mod curve;
mod law;
mod return_map;

pub use curve::CapCurve;

/// Parameters of the cap law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cap {
    /// Normal stiffness k_n [N/mm³].
    pub normal_stiffness: f64,
    /// Shear stiffness k_s [N/mm³].
    pub shear_stiffness: f64,
    /// Tensile strength f_t [MPa].
    pub f_t: f64,
    /// Fracture energy in tension G_I [N/mm].
    pub mode_1: f64,
    /// Cohesion c [MPa].
    pub c: f64,
    /// Fracture energy in shear G_II at zero normal stress [N/mm].
    pub mode_2: f64,
    /// Initial friction tan φ₀ [-].
    pub tan_phi: f64,
    /// Residual friction μ [-].
    pub mu: f64,
    /// Dilatancy tan ψ₀ at zero normal stress and zero slip [-].
    pub tan_psi: f64,
    /// Pressure σ_u at and beyond which the dilatancy is zero [MPa].
    pub sigma_u: f64,
    /// Decay of dilatancy with plastic slip δ [1/mm].
    pub decay: f64,
    /// Compressive strength with its hardening and softening.
    pub curve: CapCurve,
    /// Weight of the normal traction in the cap C_nn [-].
    pub c_nn: f64,
    /// Weight of the shear traction in the cap C_ss [-].
    pub c_ss: f64,
    /// Whether an opened joint closes without traction until its faces meet. Otherwise it unloads elastically and meets
    /// them at the plastic opening.
    pub closes: bool,
}

/// Indices of this law's variables in [`InterfaceHistory::slots`](crate::InterfaceHistory::slots).
pub(crate) mod slot {
    /// Plastic opening u_p [mm].
    pub const OPENING: usize = 0;
    /// Accumulated plastic slip s_p [mm].
    pub const SLIP: usize = 1;
    /// Plastic displacement of the cap κ_c [mm].
    pub const CRUSHING: usize = 2;
    /// Part of the plastic opening that closes without traction, the gap w [mm].
    pub const GAP: usize = 3;
}
