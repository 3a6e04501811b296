//! Report of `wythe check`: warnings, notes on derived values, and the size of the model.

mod laws;
mod memory;
mod scene;
mod time;

use super::schema::Deck;
use super::{findings, masonry, tables, wall_defaults};
use crate::error::Warning;
use crate::material::MaterialParameters;
use crate::model::Model;
use crate::model::mirrored;
use crate::model::scene::Fidelity;
use crate::model::sizes::{Sizes, sizes};
use laws::{energy_notes, interface_notes, material_note, scatter_note};
use memory::memory_mb;
use scene::{
    beams_notes, block_notes, damping_notes, fidelity_note, floor_notes, pivot_note, rigid_note,
    symmetry_note, wall_notes,
};
use std::borrow::Cow;
use std::fmt;

/// Findings about a deck without errors.
#[derive(Clone, Debug)]
pub struct CheckReport {
    /// Title of the deck.
    pub title: String,
    /// Warnings.
    pub warnings: Vec<Warning>,
    /// Values derived from the deck, one line each.
    pub notes: Vec<String>,
    /// Size of the model.
    pub sizes: Sizes,
    /// Estimated peak memory [MB]: of the mirror half where one is solved, with factors of single precision where
    /// they are tried.
    pub memory_mb: f64,
    /// Estimated processor time [s] of the solution where little cracks, and where units snap. Motion with inertia is
    /// not foreseen.
    pub time_s: [f64; 2],
}

impl fmt::Display for CheckReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: syntax, units and ranges are right", self.title)?;
        for warning in &self.warnings {
            writeln!(f, "warning: {warning}")?;
        }
        for note in &self.notes {
            writeln!(f, "note: {note}")?;
        }
        let Sizes {
            units,
            elements,
            nodes,
            dofs,
            contact_points,
        } = self.sizes;
        writeln!(
            f,
            "{units} units, {elements} elements, {nodes} nodes, {dofs} unknowns"
        )?;
        writeln!(
            f,
            "{contact_points} contact points, about {:.0} MB and {} of processor time",
            self.memory_mb,
            time::in_words(self.time_s)
        )
    }
}

/// Reports on a model and the deck from which it was built.
pub fn check(deck: &Deck, model: &Model) -> CheckReport {
    let sizes = sizes(model);
    let (planes, least) = mirrored::reduced(model);
    let [memory_mb, in_double] = match &least {
        // Factor 2: the check of symmetry needs as much again.
        Cow::Owned(half) if model.fidelity != Fidelity::Full => memory_mb(deck, half, 2.0),
        _ => memory_mb(deck, model, 1.0),
    };
    let mut notes = notes(deck, model);
    notes.extend(fidelity_note(model.fidelity, &planes, &least));
    if in_double - memory_mb > WORTH_TELLING_MB {
        notes.push(format!(
            "memory: about {in_double:.0} MB if factors in double precision are needed, as for tall slender walls under their weight"
        ));
    }
    CheckReport {
        title: model.title.clone(),
        warnings: model.warnings.clone(),
        notes,
        sizes,
        memory_mb,
        time_s: time::seconds(deck, &least),
    }
}

/// A difference in memory that is worth a note [MB].
const WORTH_TELLING_MB: f64 = 500.0;

fn notes(deck: &Deck, model: &Model) -> Vec<String> {
    let mut notes = Vec::new();
    let mut elements: Vec<Vec<usize>> = vec![Vec::new(); model.materials.len()];
    for (e, material) in model.mesh.material.iter().enumerate() {
        elements[usize::from(*material)].push(e);
    }
    for (material, elements) in model.materials.iter().zip(&elements) {
        notes.extend(material_note(model, material, elements));
        if let (MaterialParameters::DamagePlasticity(p), false) =
            (&material.parameters, elements.is_empty())
        {
            notes.extend(energy_notes(deck, &material.name, p));
            if p.has_bands() {
                let widths = findings::band_widths(model, elements);
                notes.extend(tables::band_notes(deck, &material.name, p, widths));
            }
        }
    }
    notes.extend(deck.assumed().iter().map(ToString::to_string));
    notes.extend(deck.derived.iter().cloned());
    for (name, f) in findings::interfaces(deck, model) {
        let is_derived = deck.is_generated(&format!("interfaces.{name}"));
        notes.extend(interface_notes(name, f, model, is_derived));
        notes.extend(scatter_note(deck, name, model));
    }
    for wall in masonry::lay_all(deck).unwrap_or_default() {
        notes.extend(wall_notes(deck, &wall));
    }
    notes.extend(wall_defaults::notes(deck));
    notes.extend(symmetry_note(deck));
    notes.extend(rigid_note(deck, model));
    notes.extend(beams_notes(deck, model));
    notes.extend(floor_notes(model));
    if deck.has_blocks() {
        notes.extend(block_notes(deck, model));
    }
    notes.extend(pivot_note(model));
    notes.extend(damping_notes(deck));
    notes
}
