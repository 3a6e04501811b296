//! `[materials.NAME]`: elastic constants, the law, and the keys that it reads (theory/damage-plasticity.md,
//! theory/drucker-prager.md).

use super::named_or_whole;
use super::registry::SolidKind;
use crate::deck::quantity::{Angle, Density, FractureEnergy, Length, Number, Pressure, Time};
use crate::material::by_energy::UNIT_LENGTH;
use crate::material::parameters::{DILATION_ANGLE, ECCENTRICITY, FB0_FC0, K_C};
use crate::material::{
    Branch, ByEnergy, CrackBand, DamagePlasticityParameters, DruckerPragerParameters,
    ElasticParameters, Interpolation, MaterialParameters, TableRow,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

/// Parameters of a material.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(transform = named_or_whole)]
#[expect(
    non_snake_case,
    reason = "E, K_c and G_I are spelt in the deck as in the theory"
)]
// More than 15 fields: one for each key of the table.
pub struct Material {
    /// Law; concrete damaged plasticity, which is linear elastic without tables, if absent.
    #[serde(default)]
    pub kind: SolidKind,
    /// Name in the catalogue of materials, from which absent keys take their values.
    pub name: Option<String>,
    /// Compressive strength of a unit by test f_b [MPa], beside `name`: other values follow from it.
    pub f_b: Option<Pressure>,
    /// Young's modulus E [MPa].
    pub E: Pressure,
    /// Poisson's ratio ν [-].
    pub nu: Number,
    /// Density [tonne/mm³]; 0: no mass.
    #[serde(default)]
    pub density: Density,
    /// Drucker–Prager: cohesion of Mohr–Coulomb c [MPa].
    pub c: Option<Pressure>,
    /// Drucker–Prager: friction angle φ of Mohr–Coulomb [deg].
    pub phi: Option<Angle>,
    /// Drucker–Prager: dilation angle ψ [deg]; φ if absent.
    pub psi: Option<Angle>,
    /// Uniaxial tensile strength f_t [MPa]; of damage plasticity with `G_ft`, instead of the table `tension`.
    pub f_t: Option<Pressure>,
    /// Damage plasticity: fracture energy in tension [N/mm], with `f_t`.
    pub G_ft: Option<FractureEnergy>,
    /// Damage plasticity: uniaxial compressive strength f_c [MPa], with `G_fc`, instead of the table `compression`.
    pub f_c: Option<Pressure>,
    /// Damage plasticity: fracture energy in compression beyond the peak [N/mm], with `f_c`.
    pub G_fc: Option<FractureEnergy>,
    /// Drucker–Prager: fracture energy in tension [N/mm]; if absent, no softening.
    pub G_I: Option<FractureEnergy>,
    /// Drucker–Prager: fracture energy in compression [N/mm]; if absent, no softening.
    pub G_c: Option<FractureEnergy>,
    /// Uniaxial tension; empty: linear elastic.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tension: Vec<Row>,
    /// Uniaxial compression; empty: linear elastic.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub compression: Vec<Row>,
    /// Dilation angle ψ [deg].
    #[serde(default = "dilation_angle")]
    pub dilation_angle: Angle,
    /// Eccentricity of the flow potential [-].
    #[serde(default = "eccentricity")]
    pub eccentricity: Number,
    /// Ratio f_b0/f_c0 of the biaxial to the uniaxial compressive strength [-].
    #[serde(default = "fb0_fc0")]
    pub fb0_fc0: Number,
    /// Shape of the deviatoric section K_c, the paper's ρ [-].
    #[serde(default = "k_c")]
    pub K_c: Number,
    /// Stiffness recovery w_t on reversal to tension [-].
    #[serde(default)]
    pub tension_recovery: Number,
    /// Stiffness recovery w_c on reversal to compression [-].
    #[serde(default = "one")]
    pub compression_recovery: Number,
    /// Viscosity in step time [s]; 0: none.
    #[serde(default)]
    pub viscosity: Time,
    /// Length l_ref for which the tables hold [mm]; if absent, tables are not scaled. Fracture energies do not need
    /// it.
    pub reference_length: Option<Length>,
    /// Length of an element that is compared with `reference_length`: its length across the crack, or the cube root
    /// of its volume; the former if absent.
    pub crack_band: Option<CrackBand>,
    /// Interpolation between rows of the tables.
    #[serde(default)]
    pub interpolation: Interpolation,
}

/// A row of a uniaxial table: stress [MPa], inelastic strain [-], damage [-].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(expecting = "a row [stress, inelastic strain, damage]")]
pub struct Row(pub Pressure, pub Number, pub Number);

fn dilation_angle() -> Angle {
    Angle::new(DILATION_ANGLE)
}
fn eccentricity() -> Number {
    Number::new(ECCENTRICITY)
}
fn fb0_fc0() -> Number {
    Number::new(FB0_FC0)
}
fn k_c() -> Number {
    Number::new(K_C)
}
fn one() -> Number {
    Number::new(1.0)
}

impl Material {
    /// A linear elastic material; all other keys have their defaults.
    pub fn elastic(modulus: Pressure, nu: Number, density: Density) -> Self {
        Self {
            kind: SolidKind::default(),
            name: None,
            f_b: None,
            E: modulus,
            nu,
            density,
            c: None,
            phi: None,
            psi: None,
            f_t: None,
            G_ft: None,
            f_c: None,
            G_fc: None,
            G_I: None,
            G_c: None,
            tension: Vec::new(),
            compression: Vec::new(),
            dilation_angle: dilation_angle(),
            eccentricity: eccentricity(),
            fb0_fc0: fb0_fc0(),
            K_c: k_c(),
            tension_recovery: Number::default(),
            compression_recovery: one(),
            viscosity: Time::default(),
            reference_length: None,
            crack_band: None,
            interpolation: Interpolation::default(),
        }
    }

    /// Parameters of its law.
    pub fn parameters(&self) -> MaterialParameters {
        (self.kind.registered().parameters)(self)
    }

    fn elastic_parameters(&self) -> ElasticParameters {
        ElasticParameters {
            E: self.E.get(),
            nu: self.nu.get(),
            density: self.density.get(),
        }
    }

    /// Of Drucker–Prager plasticity; what is required and absent, which the checks refuse, is 0.
    pub(super) fn drucker_prager(&self) -> MaterialParameters {
        let radians = |angle: Option<Angle>| angle.map_or(0.0, |a| a.get().to_radians());
        MaterialParameters::DruckerPrager(DruckerPragerParameters {
            elastic: self.elastic_parameters(),
            cohesion: self.c.map_or(0.0, Pressure::get),
            friction_angle: radians(self.phi),
            dilation_angle: radians(self.psi.or(self.phi)),
            tensile_strength: self.f_t.map_or(0.0, Pressure::get),
            tension_energy: self.G_I.map(FractureEnergy::get),
            compression_energy: self.G_c.map(FractureEnergy::get),
            reference_length: self.reference_length.map(Length::get),
        })
    }

    /// Strength and fracture energy of a branch that the deck gives by them.
    pub fn by_energy(&self, branch: Branch) -> Option<ByEnergy> {
        let (strength, energy) = match branch {
            Branch::Tension => (self.f_t, self.G_ft),
            Branch::Compression => (self.f_c, self.G_fc),
        };
        Some(ByEnergy {
            strength: strength?.get(),
            energy: energy?.get(),
        })
    }

    /// Returns whether any branch is given by a fracture energy.
    pub fn has_energies(&self) -> bool {
        self.G_ft.is_some() || self.G_fc.is_some()
    }

    /// Returns whether its softening is scaled to the elements.
    pub(super) fn has_bands(&self) -> bool {
        let has_tables = !self.tension.is_empty() && self.reference_length.is_some();
        self.kind == SolidKind::default() && (has_tables || self.has_energies())
    }

    /// Measure of the size of an element by which softening is scaled: the length of its crack band.
    pub fn band(&self) -> CrackBand {
        self.crack_band.unwrap_or_default()
    }

    /// Rows of a branch: the table, or those of its strength and energy for the reference length; empty without
    /// either.
    fn rows(&self, branch: Branch) -> Vec<TableRow> {
        let table = match branch {
            Branch::Tension => &self.tension,
            Branch::Compression => &self.compression,
        };
        let length = self.reference_length.map_or(UNIT_LENGTH, Length::get);
        match self.by_energy(branch) {
            Some(of) if table.is_empty() => match branch {
                Branch::Tension => of.tension(length),
                Branch::Compression => of.compression(self.E.get(), length),
            },
            _ => table.iter().map(Row::row).collect(),
        }
    }

    /// Of concrete damaged plasticity; linear elastic without tables and energies.
    pub(super) fn damage_plasticity(&self) -> MaterialParameters {
        let elastic = self.elastic_parameters();
        let [tension, compression] = [Branch::Tension, Branch::Compression].map(|b| self.rows(b));
        if tension.is_empty() || compression.is_empty() {
            return MaterialParameters::Elastic(elastic);
        }
        let length = self.reference_length.map(Length::get);
        MaterialParameters::DamagePlasticity(DamagePlasticityParameters {
            elastic,
            tension,
            compression,
            dilation_angle: self.dilation_angle.get().to_radians(),
            eccentricity: self.eccentricity.get(),
            fb0_fc0: self.fb0_fc0.get(),
            k_c: self.K_c.get(),
            tension_recovery: self.tension_recovery.get(),
            compression_recovery: self.compression_recovery.get(),
            viscosity: self.viscosity.get(),
            reference_length: length.or(self.has_energies().then_some(UNIT_LENGTH)),
            crack_band: self.band(),
            interpolation: self.interpolation,
        })
    }
}

impl Row {
    /// The row with bare numbers.
    fn row(&self) -> TableRow {
        TableRow {
            stress: self.0.get(),
            inelastic_strain: self.1.get(),
            damage: self.2.get(),
        }
    }
}
