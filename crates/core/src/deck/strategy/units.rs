//! Strength and energy of a solid, and the interface in the middle of units that crack.

use crate::deck::quantity::{FractureEnergy, Length, Number, Pressure};
use crate::deck::schema::{Interface, JointKind, Material};
use crate::material::by_energy::areas;
use crate::material::{Branch, DamagePlasticityParameters, MaterialParameters, TableRow};
use wythe_contact::CapCurve;

/// Constants and strengths of a material.
#[derive(Clone, Debug, Default)]
pub(super) struct Solid {
    /// Name.
    pub(super) name: String,
    /// Young's modulus [MPa].
    pub(super) modulus: f64,
    /// Shear modulus [MPa].
    pub(super) shear: f64,
    /// Strengths; none if it is elastic or of another law than damage plasticity.
    pub(super) strength: Option<Strength>,
}

/// Uniaxial strengths and energies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Strength {
    /// Tensile strength [MPa].
    pub(super) f_t: f64,
    /// Compressive strength [MPa].
    pub(super) f_c: f64,
    /// Fracture energy in tension [N/mm], or for 1 mm of a layer [N/mm²] if `is_per_length`.
    mode_1: f64,
    /// Energy of crushing beyond the peak, likewise.
    crushing: f64,
    /// Whether the tables belong to no length.
    is_per_length: bool,
    /// Inelastic strain at the compressive strength [-].
    pub(super) at_peak: f64,
}

impl Solid {
    /// Constants and strengths of the material `name`.
    pub(super) fn of(name: &str, material: &Material) -> Self {
        let parameters = material.parameters();
        let elastic = parameters.elastic();
        let strength = match &parameters {
            MaterialParameters::DamagePlasticity(p) => Some(Strength::of(p)),
            _ => None,
        };
        Self {
            name: name.to_owned(),
            modulus: elastic.E,
            shear: elastic.shear_modulus(),
            strength,
        }
    }

    /// Interface in the middle of a unit of this length [mm]: its tensile strength and energy, in shear the Coulomb line
    /// that touches the circles of both uniaxial strengths, and a cap at the compressive strength (theory/strategies.md,
    /// eq. 6). None if the unit does not crack.
    pub(super) fn crack(&self, of: &Interface, length: f64) -> Option<Interface> {
        let s = self.strength?;
        let root = (s.f_c * s.f_t).sqrt();
        let (c, friction) = (0.5 * root, 0.5 * (s.f_c - s.f_t) / root);
        let [mode_1, crushing] = [s.mode_1, s.crushing].map(|energy| s.over(energy, length));
        if !(mode_1 > 0.0 && friction > 0.0 && crushing > 0.0) {
            return None;
        }
        let peak = (s.at_peak * length).max(LEAST_CLOSING);
        let crushing = CapCurve::RISING * s.f_c * peak + crushing;
        Some(Interface {
            kind: JointKind::Cap,
            name: None,
            f_t: Some(Pressure::new(s.f_t)),
            c: Some(Pressure::new(c)),
            tan_phi: Some(Number::new(friction)),
            mu: Some(Number::new(friction)),
            zeta: None,
            xi: None,
            u_k: None,
            G_I: Some(FractureEnergy::new(mode_1)),
            delta_k: None,
            // Bond and cohesion vanish over equal displacements.
            G_II: Some(FractureEnergy::new(mode_1 * c / s.f_t)),
            f_m: Some(Pressure::new(s.f_c)),
            G_fc: Some(FractureEnergy::new(crushing)),
            kappa_p: Some(Length::new(peak)),
            C_nn: None,
            C_ss: Some(Number::new(weight(c, s.f_c, friction))),
            closes: None,
            tan_psi: None,
            sigma_u: None,
            delta: None,
            penalty_factor: None,
            normal_stiffness: None,
            shear_stiffness: None,
            scatter: None,
            ..of.clone()
        })
    }
}

/// Least plastic closing at the compressive strength [mm]: the law needs one.
pub(super) const LEAST_CLOSING: f64 = 1e-3;

/// C_ss with which the cap, where it meets friction `t`, is reached as the larger principal stress of σ and τ = t σ
/// reaches the compressive strength: (½ + √(¼ + t²))² = 1 + C_ss t². It is less where the residual of the cap must hold the
/// cohesion (theory/joint-cap.md, Decisions).
pub(super) fn weight(c: f64, f_m: f64, t: f64) -> f64 {
    let own = if t > SMALL {
        ((0.5 + (0.25 + t * t).sqrt()).powi(2) - 1.0) / (t * t)
    } else {
        2.0 // the limit
    };
    if c > 0.0 {
        own.min(0.999 * (CapCurve::RESIDUAL * f_m / c).powi(2))
    } else {
        own
    }
}

/// Friction below which the weight of the cap is its limit.
const SMALL: f64 = 1e-3;

impl Strength {
    fn of(p: &DamagePlasticityParameters) -> Self {
        let length = p.reference_length.unwrap_or(1.0);
        let rows = |branch: Branch| -> &[TableRow] {
            match branch {
                Branch::Tension => &p.tension,
                Branch::Compression => &p.compression,
            }
        };
        let [f_t, f_c] = [Branch::Tension, Branch::Compression].map(|branch| {
            let stresses = rows(branch).iter().map(|row| row.stress);
            stresses.fold(0.0, f64::max)
        });
        let [mode_1, crushing] =
            [Branch::Tension, Branch::Compression].map(|branch| length * areas(rows(branch))[1]);
        let peak = p.compression.iter().find(|row| row.stress >= f_c);
        Self {
            f_t,
            f_c,
            mode_1,
            crushing,
            is_per_length: p.reference_length.is_none(),
            at_peak: peak.map_or(0.0, |row| row.inelastic_strain),
        }
    }

    /// Energy of crushing of a layer of this thickness [N/mm].
    pub(super) fn crushing_of(&self, thickness: f64) -> f64 {
        self.over(self.crushing, thickness)
    }

    /// One of the energies for a layer of this thickness [N/mm].
    fn over(&self, energy: f64, thickness: f64) -> f64 {
        if self.is_per_length {
            energy * thickness
        } else {
            energy
        }
    }
}
