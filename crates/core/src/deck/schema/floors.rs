//! `[[floors]]`: floors that load and tie the walls on which they rest.

use super::Names;
use crate::deck::quantity::{Length, Mass, MembraneStiffness, Pressure};
use crate::model::ties::Tie;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

/// A floor: mass on the faces that carry it, and springs between them.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckFloor {
    /// Name; the names of its columns in the history begin with it.
    pub name: String,
    /// Faces that carry it: those along x face each other along y, and those along y along x.
    pub on: Names,
    /// Weight over its area in plan, at 9.81 m/s² [MPa].
    pub load: Option<Pressure>,
    /// Its mass [tonne], instead of `load`.
    pub mass: Option<Mass>,
    /// Whether it is a concrete slab, 200 mm thick, that hardly deforms in its plane.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub rigid: bool,
    /// Stiffness of its joists, for each width: E A over their distance [N/mm].
    pub axial: Option<MembraneStiffness>,
    /// Stiffness against shear in its plane, G t [N/mm].
    pub shear: Option<MembraneStiffness>,
    /// Largest distance of the springs that stand for joists [mm]; 1 m if absent.
    pub spacing: Option<Length>,
}

/// Stiffness of a rigid floor [N/mm]: E t and G t of 200 mm of concrete with E = 30 GPa, ν = 0.2.
const SLAB: [f64; 2] = [6e6, 2.5e6];

/// Distance of the springs if the deck gives none [mm].
const SPACING: f64 = 1000.0;

impl DeckFloor {
    /// Stiffness of its joists and against shear [N/mm]; 0 for one that is not given.
    pub fn stiffness(&self) -> [f64; 2] {
        if self.rigid {
            return SLAB;
        }
        [self.axial, self.shear].map(|k| k.map_or(0.0, MembraneStiffness::get))
    }

    /// Largest distance of its springs [mm].
    pub fn spring_spacing(&self) -> f64 {
        self.spacing.map_or(SPACING, Length::get)
    }

    /// Names of its ties, joists and braces, with the stiffness of each for each width [N/mm]; 0 if it has none.
    pub fn ties(&self) -> [(String, f64); 2] {
        let [axial, shear] = self.stiffness();
        [("joists", axial), ("braces", shear)].map(|(kind, k)| (format!("{}-{kind}", self.name), k))
    }

    /// Names of its columns in the history.
    pub fn columns(&self) -> Vec<String> {
        let ties = self.ties().into_iter().filter(|(_, k)| *k > 0.0);
        ties.flat_map(|(name, _)| Tie::columns(&name)).collect()
    }
}
