//! History, response and errors that are common to all solid laws.

use nalgebra::{Matrix6, Vector6};
use serde::{Deserialize, Serialize};

/// History of one material point. All solid laws share one record, so that histories are contiguous in memory:
/// `[element][gauss point]`. Vectors are engineering Voigt, order xx, yy, zz, xy, yz, zx.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MaterialHistory {
    /// Inviscid plastic strain ε_p [-], engineering shear.
    pub plastic_strain: Vector6<f64>,
    /// Hardening variable in tension κ_t [-] (theory/damage-plasticity.md, eq. 8).
    pub kappa_t: f64,
    /// Hardening variable in compression κ_c [-] (theory/damage-plasticity.md, eq. 8).
    pub kappa_c: f64,
    /// Inviscid scalar damage d [-] (theory/damage-plasticity.md, eq. 12).
    pub damage: f64,
    /// Viscoplastic strain ε_v [-] (theory/damage-plasticity.md, eq. 13); equals `plastic_strain` without viscosity.
    pub viscous_strain: Vector6<f64>,
    /// Viscous damage d_v [-] (theory/damage-plasticity.md, eq. 13); equals `damage` without viscosity.
    pub viscous_damage: f64,
    /// Tensile damage d_t [-], which never decreases.
    pub tensile_damage: f64,
    /// Compressive damage d_c [-], which never decreases.
    pub compressive_damage: f64,
    /// Change of `viscous_strain` in the last accepted step, which IMPL-EX extrapolates (theory/return-map.md, eq.
    /// 19).
    pub viscous_strain_step: Vector6<f64>,
    /// Change of `viscous_damage` in the last accepted step.
    pub viscous_damage_step: f64,
    /// Width of the crack band [mm] (theory/crack-band.md, eq. 2); 0 before softening, or if bands have no width of
    /// their own.
    pub crack_band: f64,
    /// Width of the crush band [mm].
    pub crush_band: f64,
    /// Nominal stress σ [MPa] at the end of the step.
    pub stress: Vector6<f64>,
}

impl MaterialHistory {
    /// True if the history is initial: all variables except the stress are zero.
    pub fn is_virgin(&self) -> bool {
        self.extrapolates_elastically()
            && self.plastic_strain == Vector6::zeros()
            && [
                self.kappa_t,
                self.kappa_c,
                self.damage,
                self.tensile_damage,
                self.compressive_damage,
            ] == [0.0; 5]
    }

    /// True if the extrapolated stress is C₀ : ε for any ratio.
    pub fn extrapolates_elastically(&self) -> bool {
        self.viscous_damage == 0.0
            && self.viscous_damage_step == 0.0
            && self.viscous_strain == Vector6::zeros()
            && self.viscous_strain_step == Vector6::zeros()
    }
}

/// Energy densities of one point [N/mm² = MJ/m³] (theory/damage-plasticity.md, eq. 16). Dissipations are those of
/// this step, by the trapezoidal rule between its ends.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointEnergy {
    /// ½ (1−d_v) (ε−ε_v):C₀:(ε−ε_v) at the end of the step.
    pub elastic: f64,
    /// Plastic work and damage of the inviscid law in this step. It includes the stiffness recovery, which may make
    /// it negative (theory/damage-plasticity.md, eq. 16).
    pub plastic_damage: f64,
    /// Part of `plastic_damage` that the stiffness recovery (decreasing d) returned; ≤ 0.
    pub recovery: f64,
    /// Work on the overstress of the viscous law in this step.
    pub viscous: f64,
}

/// Response of a law to one strain.
#[derive(Clone, Copy, Debug)]
pub struct Response {
    /// Nominal stress σ [MPa].
    pub stress: Vector6<f64>,
    /// Consistent (algorithmic) tangent dσ/dε [MPa], unsymmetric in general.
    pub tangent: Matrix6<f64>,
    /// History at the end of the step.
    pub history: MaterialHistory,
    /// Energies of the step.
    pub energy: PointEnergy,
}

/// A law that has no solution; the increment is repeated with a smaller size.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LocalFailure {
    /// The given strain is not finite.
    #[error("the strain is not finite")]
    StrainNotFinite,
    /// The scalar return map did not converge.
    #[error("the return map did not converge (residual {residual:.3e} MPa)")]
    ReturnMap {
        /// Value of the yield function at the last iterate [MPa].
        residual: f64,
    },
    /// A number of a response is not finite.
    #[error("the law `{law}` gave a {what} that is not finite")]
    NotFinite {
        /// Name of the law.
        law: &'static str,
        /// The quantity: stress, tangent, history or energy.
        what: &'static str,
    },
    /// The law reports that it has no solution.
    #[error("the law `{law}` has no answer: {why}")]
    NoAnswer {
        /// Name of the law.
        law: &'static str,
        /// Reason given by the law.
        why: &'static str,
    },
    /// An element is inverted.
    #[error("the element has turned inside out (det F = {determinant:.3e})")]
    Inverted {
        /// Determinant of the centroid deformation gradient [-].
        determinant: f64,
    },
}

impl PointEnergy {
    /// Adds the energy of a point with the volume `volume` [mm³].
    pub fn add(&mut self, other: &Self, volume: f64) {
        self.elastic += volume * other.elastic;
        self.plastic_damage += volume * other.plastic_damage;
        self.recovery += volume * other.recovery;
        self.viscous += volume * other.viscous;
    }
}
