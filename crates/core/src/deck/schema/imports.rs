//! `[[imports]]`: meshes of other programs, whose bodies stand in the scene.

use super::{Deck, Names, Rotation};
use crate::deck::quantity::{Length, Velocity};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;
use std::collections::BTreeMap;

/// A mesh of Abaqus (`.inp`) or Gmsh (`.msh`).
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckImport {
    /// Name; its bodies, sets and surfaces are called `NAME.SET`.
    pub name: String,
    /// File, relative to the folder of the deck.
    pub file: String,
    /// Units of force, length and time in the file.
    #[serde(default = "of_wythe")]
    pub units: String,
    /// Displacement of the mesh [mm].
    #[serde(default)]
    pub at: [Length; 3],
    /// Rotation about its origin, before the displacement.
    pub rotate: Option<Rotation>,
    /// Materials of the deck by sets of elements of the file; other elements have the material of the file.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub materials: BTreeMap<String, String>,
    /// Velocity at the start of the first step with inertia [mm/s].
    #[serde(default)]
    pub velocity: [Velocity; 3],
}

fn of_wythe() -> String {
    "N, mm, s".to_owned()
}

impl Deck {
    /// Every name of a body, a face or a set that the deck mentions.
    pub fn mentions(&self) -> impl Iterator<Item = &str> {
        let contacts = self.contacts.iter().flat_map(|c| [&c.slave, &c.master]);
        let contacts = contacts.flatten();
        let held = self.supports.iter().map(|s| &s.on);
        let sprung = self.springs.iter().map(|s| &s.on);
        let probed = self.probes.iter().filter_map(|p| p.on.as_ref());
        let taken_off = self
            .probes
            .iter()
            .filter_map(|p| p.minus.as_ref()?.on.as_ref());
        let cut = self.sections.iter().filter_map(|s| s.of.as_ref());
        let moved = self.steps.iter().filter_map(|s| s.face.as_ref());
        let all = contacts.chain(held).chain(sprung).chain(probed);
        let settled = self.settlements.iter().map(|s| &s.on);
        let moved = moved.chain(settled);
        let laid = self.beams.iter().map(|b| &b.on);
        let carried = self.floors.iter().map(|f| &f.on);
        let all = all.chain(taken_off).chain(cut).chain(moved);
        let covered = self.layers.iter().map(|layer| &layer.on);
        let loads = self.steps.iter().flat_map(|step| &step.loads);
        let loaded = loads.filter_map(|load| load.on.as_ref());
        let all = all.chain(laid).chain(carried).chain(covered).chain(loaded);
        all.flat_map(|Names(names)| names.iter().map(String::as_str))
    }
}
