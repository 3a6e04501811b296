//! Parameters of a material, before they are adjusted to the size of an element.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::by_energy::{ByEnergy, UNIT_LENGTH};
use super::solid_law::{CustomLaw, LawOutput, SolidLaw};

/// Usual dilation angle ψ [deg]. This and the next three are those of quasi-brittle materials in Table 2 of D'Altri
/// et al. (2018).
pub const DILATION_ANGLE: f64 = 10.0;
/// Usual eccentricity of the flow potential [-].
pub const ECCENTRICITY: f64 = 0.1;
/// Usual f_b0/f_c0 [-].
pub const FB0_FC0: f64 = 1.16;
/// Usual K_c [-].
pub const K_C: f64 = 2.0 / 3.0;

/// Parameters of a solid.
#[derive(Clone, Debug, PartialEq)]
pub enum MaterialParameters {
    /// Linear elastic.
    Elastic(ElasticParameters),
    /// Concrete damaged plasticity.
    DamagePlasticity(DamagePlasticityParameters),
    /// Hyperbolic Drucker–Prager plasticity.
    DruckerPrager(DruckerPragerParameters),
    /// A user-defined law.
    Custom(CustomLaw),
}

/// Isotropic linear elasticity.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(non_snake_case)]
pub struct ElasticParameters {
    /// Young's modulus E [MPa].
    pub E: f64,
    /// Poisson's ratio ν [-].
    pub nu: f64,
    /// Density [tonne/mm³].
    pub density: f64,
}

/// One row of a uniaxial table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableRow {
    /// Nominal stress, positive in tension and in compression alike [MPa].
    pub stress: f64,
    /// Inelastic strain ε − σ/E [-], from 0.
    pub inelastic_strain: f64,
    /// Damage [-], from 0.
    pub damage: f64,
}

/// How a table is interpolated between its rows (theory/damage-plasticity.md, eq. 9).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    /// σ and effective σ̄ linear in the plastic strain between rows.
    #[default]
    Eff1,
    /// σ and d linear in the inelastic strain, with 20 pieces per interval.
    Lit,
}

/// Width of the band in which softening localises, l of l_ref/l (theory/crack-band.md, eqs 1 and 2).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CrackBand {
    /// V^(1/3), independent of the crack direction: the printed formula of D'Altri et al. (2018).
    Volume,
    /// Length of the element across the crack: along the first principal direction in tension, along the last
    /// in compression, as they are when softening begins.
    #[default]
    Projected,
}

/// Concrete damaged plasticity (theory/damage-plasticity.md).
#[derive(Clone, Debug, PartialEq)]
pub struct DamagePlasticityParameters {
    /// Elastic constants and density.
    pub elastic: ElasticParameters,
    /// Uniaxial tension; the first row is first yield.
    pub tension: Vec<TableRow>,
    /// Uniaxial compression; the first row is first yield.
    pub compression: Vec<TableRow>,
    /// Dilation angle ψ [rad].
    pub dilation_angle: f64,
    /// Eccentricity ε of the flow potential [-].
    pub eccentricity: f64,
    /// Ratio of biaxial to uniaxial compressive strength f_b0/f_c0 [-].
    pub fb0_fc0: f64,
    /// Shape of the deviatoric section K_c [-] (the paper's ρ).
    pub k_c: f64,
    /// Stiffness recovery w_t when the stress changes to tension [-].
    pub tension_recovery: f64,
    /// Stiffness recovery w_c when the stress changes to compression [-].
    pub compression_recovery: f64,
    /// Viscosity μ of theory/damage-plasticity.md, eq. 13, in step time [s]; 0 = none.
    pub viscosity: f64,
    /// Length l_ref for which the tables hold [mm]. `None`: tables are used as given in every element.
    pub reference_length: Option<f64>,
    /// Length of the element that is compared with the reference length.
    pub crack_band: CrackBand,
    /// Interpolation between rows.
    pub interpolation: Interpolation,
}

/// Hyperbolic Drucker–Prager plasticity (docs/theory/drucker-prager.md).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DruckerPragerParameters {
    /// Elastic constants and density.
    pub elastic: ElasticParameters,
    /// Mohr–Coulomb cohesion c [MPa].
    pub cohesion: f64,
    /// Mohr–Coulomb friction angle φ [rad].
    pub friction_angle: f64,
    /// Dilation angle ψ [rad]; φ for associated flow.
    pub dilation_angle: f64,
    /// Uniaxial tensile strength f_t [MPa].
    pub tensile_strength: f64,
    /// Fracture energy in tension 𝒢_t [N/mm]; `None`: no softening.
    pub tension_energy: Option<f64>,
    /// Fracture energy in compression 𝒢_c [N/mm]; `None`: no softening.
    pub compression_energy: Option<f64>,
    /// Length used for a point without size [mm].
    pub reference_length: Option<f64>,
}

impl DamagePlasticityParameters {
    /// A material with strengths and fracture energies, whose crack bands are projected (theory/crack-band.md, eqs 10
    /// to 13). The surface and the flow are the usual ones: dilation 10°, eccentricity 0.1, f_b0/f_c0 = 1.16, K_c =
    /// 2/3. A strength or energy that is not positive is an error when the law is built.
    pub fn by_energy(elastic: ElasticParameters, tension: ByEnergy, compression: ByEnergy) -> Self {
        Self {
            elastic,
            tension: tension.tension(UNIT_LENGTH),
            compression: compression.compression(elastic.E, UNIT_LENGTH),
            dilation_angle: DILATION_ANGLE.to_radians(),
            eccentricity: ECCENTRICITY,
            fb0_fc0: FB0_FC0,
            k_c: K_C,
            tension_recovery: 0.0,
            compression_recovery: 1.0,
            viscosity: 0.0,
            reference_length: Some(UNIT_LENGTH),
            crack_band: CrackBand::Projected,
            interpolation: Interpolation::default(),
        }
    }

    /// Whether each point has a band width of its own.
    pub fn has_bands(&self) -> bool {
        self.crack_band == CrackBand::Projected && self.reference_length.is_some()
    }
}

impl MaterialParameters {
    /// The elastic constants.
    pub fn elastic(&self) -> &ElasticParameters {
        match self {
            Self::Elastic(e) => e,
            Self::DamagePlasticity(p) => &p.elastic,
            Self::DruckerPrager(p) => &p.elastic,
            Self::Custom(law) => law.elastic(),
        }
    }

    /// Parameters of a user-defined law.
    pub fn custom(law: impl SolidLaw + 'static) -> Self {
        Self::Custom(CustomLaw(Arc::new(law)))
    }

    /// Whether the law is nonlinear.
    pub fn yields(&self) -> bool {
        !matches!(self, Self::Elastic(_))
    }

    /// Additional history variables that the law writes to the results.
    pub fn outputs(&self) -> &'static [LawOutput] {
        match self {
            Self::Elastic(_) | Self::DamagePlasticity(_) => &[],
            Self::DruckerPrager(_) => &super::drucker_prager::OUTPUTS,
            Self::Custom(law) => law.outputs(),
        }
    }
}

impl ElasticParameters {
    /// Shear modulus G = E/2(1+ν) [MPa].
    pub fn shear_modulus(&self) -> f64 {
        self.E / (2.0 * (1.0 + self.nu))
    }

    /// Bulk modulus K = E/3(1−2ν) [MPa].
    pub fn bulk_modulus(&self) -> f64 {
        self.E / (3.0 * (1.0 - 2.0 * self.nu))
    }
}
