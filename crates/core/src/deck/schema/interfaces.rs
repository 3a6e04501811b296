//! `[interfaces.NAME]`: the law of a joint, by its kind (theory/joint.md, theory/joint-cap.md).

use super::JointKind;
use super::joint_kinds::named_or_whole;
use crate::deck::quantity::{
    FractureEnergy, InterfaceStiffness, InverseLength, Length, Number, Pressure, Quantity,
};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;
use wythe_contact::softening::Softening;
use wythe_contact::{Cap, CapCurve, CohesiveFrictional, Coupling, InterfaceLaw, JointLaw as _};

/// Parameters of an interface.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(transform = named_or_whole)]
#[expect(
    non_snake_case,
    reason = "energies and weights are spelt in the deck as in the theory"
)]
// More than 15 fields: one for each key of the table.
pub struct Interface {
    /// Law of the joint.
    #[serde(default)]
    pub kind: JointKind,
    /// Name in the catalogue of joints, from which absent keys take their values.
    pub name: Option<String>,
    /// Tensile strength f_t [MPa].
    pub f_t: Option<Pressure>,
    /// Cohesion c [MPa].
    pub c: Option<Pressure>,
    /// Initial friction tan φ [-].
    pub tan_phi: Option<Number>,
    /// Residual friction μ [-].
    pub mu: Option<Number>,
    /// Brittleness in tension ζ [-]; not needed by a dry joint.
    pub zeta: Option<Number>,
    /// Brittleness in shear ξ [-]; not needed by a dry joint.
    pub xi: Option<Number>,
    /// Ultimate opening u_k [mm]; or `G_I`.
    pub u_k: Option<Length>,
    /// Fracture energy in tension G_I [N/mm]; or `u_k`.
    pub G_I: Option<FractureEnergy>,
    /// Ultimate slip δ_k [mm]; or `G_II`.
    pub delta_k: Option<Length>,
    /// Fracture energy in shear without normal stress G_II [N/mm]; or `delta_k`.
    pub G_II: Option<FractureEnergy>,
    /// Compressive strength f_m [MPa]; of `cap`.
    pub f_m: Option<Pressure>,
    /// Energy of crushing above the residual strength f_m/7, G_fc [N/mm]; of `cap`.
    pub G_fc: Option<FractureEnergy>,
    /// Plastic closing at the compressive strength κ_p [mm]; of `cap`.
    pub kappa_p: Option<Length>,
    /// Weight of the normal traction in the cap C_nn [-]; of `cap`, 1 if absent.
    pub C_nn: Option<Number>,
    /// Weight of the shear traction in the cap C_ss [-]; of `cap`, 9 if absent.
    pub C_ss: Option<Number>,
    /// Whether an opened joint closes without traction until its faces meet; of `cap`, true if absent. Otherwise it
    /// unloads elastically and meets at its plastic opening (Lourenço & Rots 1997).
    pub closes: Option<bool>,
    /// Dilatancy tan ψ₀ at the start of slip, without normal stress [-]; of `cap`, 0 if absent.
    pub tan_psi: Option<Number>,
    /// Pressure σ_u above which slip does not dilate [MPa]; of `cap`, unlimited if absent.
    pub sigma_u: Option<Pressure>,
    /// Decay of the dilatancy with plastic slip δ [1/mm]; of `cap`, 0 if absent.
    pub delta: Option<InverseLength>,
    /// Stiffness over the representative stiffness of the facing elements [-]. The default is 500, or 50 for joints
    /// of walls with mortar in decks without general contact.
    pub penalty_factor: Option<Number>,
    /// Explicit normal stiffness k_n [N/mm³].
    pub normal_stiffness: Option<InterfaceStiffness>,
    /// Explicit shear stiffness k_s [N/mm³].
    pub shear_stiffness: Option<InterfaceStiffness>,
    /// Coupling of opening and slip.
    #[serde(default)]
    #[schemars(with = "CouplingSchema")]
    pub coupling: Coupling,
    /// Scatter of the bond strength from unit to unit; none if absent.
    pub scatter: Option<Scatter>,
}

/// `[interfaces.NAME.scatter]`: every unit has its own bond strength.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Scatter {
    /// Coefficient of variation of the strengths [-].
    pub cv: Number,
    /// Seed of the random numbers; another seed gives other strengths.
    #[serde(default)]
    pub seed: u64,
}

// Schema of `Coupling`, whose crate does not depend on schemars.
/// Combination of the damage by opening and by slip.
#[derive(JsonSchema)]
#[schemars(rename = "Coupling")]
#[serde(rename_all = "kebab-case")]
#[expect(dead_code, reason = "its schema is what counts")]
enum CouplingSchema {
    /// The larger one of the two.
    Max,
    /// Their sum.
    Additive,
}

/// Penalty factor of the paper: k_n = 500 E/h (theory/joint.md, eq. 32).
const PENALTY: f64 = 500.0;

impl Interface {
    /// Stiffness over the representative stiffness E/h of the facing elements [-].
    pub fn penalty(&self) -> f64 {
        self.penalty_factor.map_or(PENALTY, Number::get)
    }

    /// Tensile strength f_t [MPa]; 0 if the kind has none.
    pub fn tensile_strength(&self) -> f64 {
        self.f_t.map_or(0.0, Pressure::get)
    }

    /// Cohesion c [MPa]; 0 if the kind has none.
    pub fn cohesion(&self) -> f64 {
        self.c.map_or(0.0, Pressure::get)
    }

    /// Initial friction tan φ [-]; 0 if the kind has none.
    pub fn initial_friction(&self) -> f64 {
        self.tan_phi.map_or(0.0, Number::get)
    }

    /// Residual friction μ, which holds a body that is pressed [-]; 0 if the kind has none.
    pub fn residual_friction(&self) -> f64 {
        self.mu.map_or(0.0, Number::get)
    }

    /// Returns whether the joint has no bond: it is dry and has D = 1 from the start (theory/joint.md, eq. 19).
    pub fn is_dry(&self) -> bool {
        self.law(1.0, 1.0).is_dry()
    }

    /// ζ, or 1 if a dry joint, which does not use it, leaves it out.
    fn zeta(&self) -> f64 {
        self.zeta.map_or(1.0, Number::get)
    }

    /// ξ, or 1 if a dry joint, which does not use it, leaves it out.
    fn xi(&self) -> f64 {
        self.xi.map_or(1.0, Number::get)
    }

    /// Ultimate opening u_k [mm]: the given one, or from G_I = f_t u_k (1/ζ − 1/(e^ζ − 1)) (theory/joint.md, eq.
    /// 30). Zero for a dry joint, which does not use it.
    pub fn ultimate_opening(&self) -> f64 {
        match (self.u_k, self.G_I) {
            (Some(u_k), _) => u_k.get(),
            (None, Some(g)) if self.tensile_strength() > 0.0 => {
                g.get() / (self.tensile_strength() * Softening::shape_integral(self.zeta()))
            }
            _ => 0.0,
        }
    }

    /// Ultimate slip δ_k [mm]: the given one, or from G_II = c δ_k (1/ξ − 1/(e^ξ − 1)), the energy without normal
    /// stress (theory/joint.md, eq. 31). Zero for a dry joint, which does not use it.
    pub fn ultimate_slip(&self) -> f64 {
        match (self.delta_k, self.G_II) {
            (Some(delta_k), _) => delta_k.get(),
            (None, Some(g)) if self.cohesion() > 0.0 => {
                g.get() / (self.cohesion() * Softening::shape_integral(self.xi()))
            }
            _ => 0.0,
        }
    }

    /// The curve of the cap; `None` if `f_m`, `kappa_p` or `G_fc` is missing or they do not fit together.
    pub fn cap_curve(&self) -> Option<CapCurve> {
        let [strength, peak] = [self.f_m?.get(), self.kappa_p?.get()];
        CapCurve::with_energy(strength, peak, self.G_fc?.get())
    }

    /// C_nn and C_ss [-].
    pub fn cap_weights(&self) -> [f64; 2] {
        [(self.C_nn, 1.0), (self.C_ss, 9.0)].map(|(given, own)| given.map_or(own, Number::get))
    }

    /// The law of `kind = "cap"`. A deck that was read has its keys.
    pub(super) fn cap(&self, normal_stiffness: f64, shear_stiffness: f64) -> Cap {
        let energy = |given: Option<FractureEnergy>| given.map_or(1.0, Quantity::get);
        let [c_nn, c_ss] = self.cap_weights();
        Cap {
            normal_stiffness,
            shear_stiffness,
            f_t: self.tensile_strength(),
            mode_1: energy(self.G_I),
            c: self.cohesion(),
            mode_2: energy(self.G_II),
            tan_phi: self.initial_friction(),
            mu: self.residual_friction(),
            tan_psi: self.tan_psi.map_or(0.0, Number::get),
            sigma_u: self.sigma_u.map_or(f64::INFINITY, Quantity::get),
            decay: self.delta.map_or(0.0, Quantity::get),
            curve: self.cap_curve().unwrap_or(CapCurve {
                strength: f64::INFINITY,
                peak: 1.0,
                middle: 2.0,
            }),
            c_nn,
            c_ss,
            closes: self.closes.unwrap_or(true),
        }
    }

    /// Fracture energy in tension G_I [N/mm] (theory/joint.md, eq. 30).
    pub fn mode_1_energy(&self) -> f64 {
        self.curves().mode_1_energy()
    }

    /// Fracture energy in shear G_II [N/mm] under the normal stress `sigma` ≤ 0 [MPa], above the residual friction
    /// (theory/joint.md, eq. 31).
    pub fn mode_2_energy(&self, sigma: f64) -> f64 {
        self.curves().mode_2_energy(sigma)
    }

    /// The law for quantities that do not depend on its stiffnesses.
    fn curves(&self) -> CohesiveFrictional {
        self.cohesive_frictional(f64::INFINITY, f64::INFINITY)
    }

    /// The law with these stiffnesses [N/mm³]; of mean strength, if its strength scatters.
    pub fn law(&self, normal_stiffness: f64, shear_stiffness: f64) -> InterfaceLaw {
        self.kind.law(self, normal_stiffness, shear_stiffness)
    }

    /// The law of `kind = "cohesive-frictional"`.
    pub(super) fn cohesive_frictional(
        &self,
        normal_stiffness: f64,
        shear_stiffness: f64,
    ) -> CohesiveFrictional {
        CohesiveFrictional {
            f_t: self.tensile_strength(),
            c: self.cohesion(),
            tan_phi: self.initial_friction(),
            mu: self.residual_friction(),
            u_k: self.ultimate_opening(),
            delta_k: self.ultimate_slip(),
            zeta: self.zeta(),
            xi: self.xi(),
            normal_stiffness,
            shear_stiffness,
            coupling: self.coupling,
        }
    }
}
