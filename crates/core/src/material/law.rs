//! What every law of the solids takes and gives.

use nalgebra::{Matrix6, Vector6};
use serde::{Deserialize, Serialize};

/// History of one material point. One record serves every law of the solids, so that histories lie
/// flat in memory: `[element][gauss point]`. Vectors are engineering Voigt, order xx, yy, zz, xy, yz, zx.
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
    /// Viscoplastic strain ε_v [-] (theory/damage-plasticity.md, eq. 13); equals `plastic_strain` where viscosity is zero.
    pub viscous_strain: Vector6<f64>,
    /// Viscous damage d_v [-] (theory/damage-plasticity.md, eq. 13); equals `damage` where viscosity is zero.
    pub viscous_damage: f64,
    /// Tensile damage d_t [-], never decreasing.
    pub tensile_damage: f64,
    /// Compressive damage d_c [-], never decreasing.
    pub compressive_damage: f64,
    /// Change of `viscous_strain` in the last committed step: what IMPL-EX extrapolates (theory/return-map.md, eq. 19).
    pub viscous_strain_step: Vector6<f64>,
    /// Change of `viscous_damage` in the last committed step.
    pub viscous_damage_step: f64,
    /// Width of the band in which it cracks [mm] (theory/crack-band.md, eq. 2); 0 before, or where no width is asked for.
    pub crack_band: f64,
    /// Width of the band in which it is crushed [mm].
    pub crush_band: f64,
    /// Nominal stress σ [MPa] at the end of the step.
    pub stress: Vector6<f64>,
}

impl MaterialHistory {
    /// True if nothing has ever happened to the point: all is zero but the stress.
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

    /// True if its extrapolation is C₀ : ε, whatever the ratio.
    pub fn extrapolates_elastically(&self) -> bool {
        self.viscous_damage == 0.0
            && self.viscous_damage_step == 0.0
            && self.viscous_strain == Vector6::zeros()
            && self.viscous_strain_step == Vector6::zeros()
    }
}

/// Energy densities of one point [N/mm² = MJ/m³], each integrated where it arises (theory/damage-plasticity.md, eq. 16).
/// Dissipations are those of this step (trapezoidal rule between its ends).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PointEnergy {
    /// ½ (1−d_v) (ε−ε_v):C₀:(ε−ε_v) at the end of the step.
    pub elastic: f64,
    /// Plastic work and damage of the inviscid law in this step. The stiffness recovery is part of it
    /// and may make it negative (theory/damage-plasticity.md, eq. 16).
    pub plastic_damage: f64,
    /// Part of `plastic_damage` which the stiffness recovery (a falling d) returned; ≤ 0.
    pub recovery: f64,
    /// Work on the overstress of the viscous law in this step.
    pub viscous: f64,
}

/// Answer of a law to one strain.
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

/// The law could not answer: the increment is cut.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LocalFailure {
    /// The strain handed in is not finite.
    #[error("the strain is not finite")]
    StrainNotFinite,
    /// The scalar return map found no root in its iterations.
    #[error("the return map did not converge (residual {residual:.3e} MPa)")]
    ReturnMap {
        /// Value of the yield function where it stopped [MPa].
        residual: f64,
    },
    /// An element has turned inside out.
    #[error("the element has turned inside out (det F = {determinant:.3e})")]
    Inverted {
        /// Determinant of the centroid deformation gradient [-].
        determinant: f64,
    },
}

impl PointEnergy {
    /// Adds the energy of a point that stands for `volume` [mm³].
    pub fn add(&mut self, other: &Self, volume: f64) {
        self.elastic += volume * other.elastic;
        self.plastic_damage += volume * other.plastic_damage;
        self.recovery += volume * other.recovery;
        self.viscous += volume * other.viscous;
    }
}
