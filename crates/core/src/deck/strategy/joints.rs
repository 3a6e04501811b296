//! Interfaces of expanded units: stiffness, strength and energy of the joints and of the units beside them.

use super::units::{LEAST_CLOSING, Solid, weight};
use crate::deck::quantity::{
    FractureEnergy, InterfaceStiffness, Length, Number, Pressure, Quantity,
};
use crate::deck::schema::{DeckSimplified, Interface, JointKind};
use crate::deck::wall_defaults::PENALTY;
use wythe_contact::CapCurve;

/// Sizes normal to a joint.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layers {
    /// Size of a unit [mm].
    pub(super) unit: f64,
    /// Thickness of the joint [mm].
    pub(super) joint: f64,
    /// Part of the joint that is filled [-].
    pub(super) filled: f64,
}

/// A kind of joints of a wall.
pub(super) struct Joint<'a> {
    /// Interface of the detailed model.
    pub(super) of: &'a Interface,
    pub(super) unit: &'a Solid,
    /// The mortar; none in a dry joint.
    pub(super) mortar: Option<&'a Solid>,
    pub(super) layers: Layers,
    /// Values that the deck gives.
    pub(super) said: &'a DeckSimplified,
    /// Whether the joint has the compliance of the unit, too.
    pub(super) is_rigid: bool,
}

/// Stiffness over E/h of the unit beyond which a joint counts as rigid: the penalty factor of the paper.
const STIFFEST: f64 = 500.0;

/// Part of the compressive strength: mortar that cracks by shear at lower pressures changes the force of walls.
const WEAK: f64 = 0.12;

/// Factor 4.1 of Hilsdorf between the thickness of joint and unit.
const SPREAD: f64 = 4.1;

impl Joint<'_> {
    /// The interface, and notes on values that had to be changed.
    pub(super) fn derive(&self) -> (Interface, Vec<String>) {
        let mut notes = Vec::new();
        let mut joint = self.of.clone();
        joint.name = None;
        let [normal, shear] = self.stiffness();
        let filled = self.layers.filled.max(1e-3);
        joint.normal_stiffness = normal.map(|k| InterfaceStiffness::new(filled * k));
        joint.shear_stiffness = shear.map(|k| InterfaceStiffness::new(filled * k));
        if joint.normal_stiffness.is_some() {
            joint.penalty_factor = None;
        } else if self.mortar.is_some() {
            joint.penalty_factor.get_or_insert(Number::new(PENALTY));
        }
        let strength = self.compressive_strength();
        match strength {
            Some((f_m, how)) if joint.kind != JointKind::Cap => {
                notes.push(how);
                self.add_cap(&mut joint, f_m, &mut notes);
            }
            _ => {}
        }
        if filled < 1.0 {
            scale(&mut joint, filled);
        }
        (joint, notes)
    }

    /// k_n and k_s [N/mm³]: those of the layers in series, less the part of the unit that the elements have. None if the
    /// joint is as stiff as the unit or stiffer: a penalty then stands for it.
    fn stiffness(&self) -> [Option<f64>; 2] {
        let Layers { unit, joint, .. } = self.layers;
        let mortar = self.mortar.filter(|_| joint > 0.0);
        let explicit = [self.of.normal_stiffness, self.of.shear_stiffness];
        let moduli = [
            (self.unit.modulus, mortar.map(|m| m.modulus)),
            (self.unit.shear, mortar.map(|m| m.shear)),
        ];
        let both = [0, 1].map(|i| {
            let (of_unit, of_mortar) = moduli[i];
            let mut compliance = explicit[i].map_or(0.0, |k| 1.0 / k.get());
            compliance += of_mortar.map_or(0.0, |e| joint * (1.0 / e - 1.0 / of_unit));
            if self.is_rigid {
                compliance += (unit + joint) / of_unit;
            }
            let least = unit / (STIFFEST * of_unit);
            (compliance > 0.0 || self.is_rigid).then(|| 1.0 / compliance.max(least))
        });
        // Both or none: an interface has explicit stiffnesses, or a penalty factor.
        if both.iter().all(Option::is_some) {
            both
        } else {
            [None; 2]
        }
    }

    /// Compressive strength of the masonry [MPa] and its origin; none if neither the deck nor the tables give one.
    ///
    /// Hilsdorf (1969), with stresses that are uniform: f_m = f_b (f_t + α f_j)/(f_t + α f_b), α = t/4.1 h. A unit between
    /// joints that spread fails by splitting.
    fn compressive_strength(&self) -> Option<(f64, String)> {
        if let Some(said) = self.said.f_m {
            return Some((said.get(), format!("f_m = {} MPa as given", said.get())));
        }
        let unit = self.unit.strength?;
        let Layers {
            unit: size, joint, ..
        } = self.layers;
        let Some(mortar) = self.mortar.filter(|_| joint > 0.0) else {
            let how = format!("f_m = {} MPa, the strength of {}", unit.f_c, self.unit.name);
            return Some((unit.f_c, how));
        };
        let crushed = mortar.strength?.f_c.min(unit.f_c);
        let alpha = joint / (SPREAD * size);
        let f_m = unit.f_c * (unit.f_t + alpha * crushed) / (unit.f_t + alpha * unit.f_c);
        let how = format!(
            "f_m = {f_m:.2} MPa by Hilsdorf from {} ({} MPa) and {} ({crushed} MPa)",
            self.unit.name, unit.f_c, mortar.name
        );
        Some((f_m, how))
    }

    /// A warning, if the mortar cracks by shear before the joint slides at pressures far below f_m: the larger principal
    /// stress of σ and τ on the Coulomb line is the tensile strength of the mortar, (c + t σ)² = f_t (f_t + σ).
    pub(super) fn caution(&self, derived: &Interface) -> Option<String> {
        let f_t = self
            .mortar
            .filter(|_| self.layers.joint > 0.0)?
            .strength?
            .f_t;
        let f_m = derived.f_m?.get();
        let (c, t) = (self.of.cohesion(), self.of.initial_friction());
        let half = t * c - 0.5 * f_t;
        let root = half * half + t * t * (f_t * f_t - c * c);
        let pressure = if root > 0.0 {
            (root.sqrt() - half) / (t * t)
        } else {
            0.0
        };
        (t > 0.0 && pressure < WEAK * f_m).then(|| {
            format!(
                "above {:.2} MPa the mortar (f_t = {f_t} MPa) cracks by shear before this joint slides, which the strategy \
                 leaves out: as the top does not rise, the force may be 10 to 40 % too high",
                pressure.max(0.0)
            )
        })
    }

    /// Makes the law of a joint one with a compression cap.
    fn add_cap(&self, joint: &mut Interface, f_m: f64, notes: &mut Vec<String>) {
        let Layers {
            unit: size,
            joint: thickness,
            ..
        } = self.layers;
        let layers = [
            (self.unit.strength, size),
            (self.mortar.and_then(|m| m.strength), thickness),
        ];
        let layers = layers.into_iter().filter_map(|(s, size)| Some((s?, size)));
        let layers: Vec<_> = layers.filter(|(_, size)| *size > 0.0).collect();
        let closing: f64 = layers.iter().map(|(s, size)| s.at_peak * size).sum();
        let said = self.said;
        let kappa_p = said
            .kappa_p
            .map_or(closing.max(LEAST_CLOSING), Quantity::get);
        // The weaker layer crushes.
        let weaker = layers.iter().min_by(|a, b| a.0.f_c.total_cmp(&b.0.f_c));
        let beyond = weaker.map_or(0.0, |(s, size)| s.crushing_of(*size));
        let energy = CapCurve::RISING * f_m * kappa_p + beyond.max(1e-3 * f_m);
        let (mode_1, mode_2) = (self.of.mode_1_energy(), self.of.mode_2_energy(0.0));
        let c = joint.cohesion();
        let steepest = joint.initial_friction().max(joint.residual_friction());
        if steepest > 0.0 && joint.tensile_strength() * steepest > c {
            let most = c / steepest;
            notes.push(format!(
                "f_t = {most:.4} MPa instead of {}, where the Coulomb line ends",
                joint.tensile_strength()
            ));
            joint.f_t = Some(Pressure::new(most * (1.0 - 1e-9)));
        }
        let c_ss = said
            .C_ss
            .map_or_else(|| weight(c, f_m, steepest), Number::get);
        joint.kind = JointKind::Cap;
        joint.f_m = Some(Pressure::new(f_m));
        joint.kappa_p = Some(Length::new(kappa_p));
        joint.G_fc = Some(said.G_fc.unwrap_or(FractureEnergy::new(energy)));
        joint.C_ss = Some(Number::new(c_ss));
        joint.G_I = (joint.tensile_strength() > 0.0).then(|| FractureEnergy::new(mode_1));
        joint.G_II = (c > 0.0).then(|| FractureEnergy::new(mode_2));
        (joint.u_k, joint.delta_k, joint.zeta, joint.xi) = (None, None, None, None);
        joint.coupling = wythe_contact::Coupling::default();
    }
}

/// Scales the strengths and energies of a joint that is filled in part.
fn scale(joint: &mut Interface, filled: f64) {
    for strength in [&mut joint.f_t, &mut joint.c, &mut joint.f_m] {
        *strength = strength.map(|f| Pressure::new(filled * f.get()));
    }
    for energy in [&mut joint.G_I, &mut joint.G_II, &mut joint.G_fc] {
        *energy = energy.map(|g| FractureEnergy::new(filled * g.get()));
    }
}
