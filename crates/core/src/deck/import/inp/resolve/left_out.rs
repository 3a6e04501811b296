//! Parts of an `.inp` that are not imported, and the notes about them.

use std::collections::{BTreeMap, BTreeSet};

use super::{Frame, NODES};
use crate::deck::import::inp::raw::Raw;
use crate::deck::import::inp::reader::instead_of;
use crate::deck::import::{ImportedMesh, Place};

/// Notes on keywords that are read with another meaning, and on those that are not read.
pub(super) fn notes(raw: &Raw) -> Vec<String> {
    let mut notes = Vec::new();
    let types: Vec<&str> = raw.types.keys().map(String::as_str).collect();
    if !types.is_empty() && types != ["C3D8I"] {
        notes.push(format!(
            "{} are read as hex8 of the deck's element.formulation: b-bar is nearest to C3D8, incompatible to \
             C3D8I; none has reduced integration",
            types.join(", ")
        ));
    }
    if let Some((count, place)) = raw.long {
        notes.push(format!(
            "{count} hexahedra have more labels on their line than those of eight nodes, which are taken; the others are \
             left out (the first is at line {})",
            place.line
        ));
    }
    for material in &raw.materials {
        if let Some(why) = &material.unusable {
            notes.push(format!(
                "material {} is left out: {why}; write it in the deck where it is used",
                material.name
            ));
        }
    }
    if !raw.skipped.is_empty() {
        let each = |(name, place): (&String, &Place)| format!("*{name} (line {})", place.line);
        let skipped: Vec<String> = raw.skipped.iter().map(each).collect();
        notes.push(format!("not read: {}", skipped.join(", ")));
    }
    notes
}

/// Adds a note for each element type that is not read, and stores the labels of its elements.
pub(super) fn leave_others_out(mesh: &mut ImportedMesh, frames: &mut [Frame<'_>]) {
    let mut of_hexahedra = vec![false; mesh.nodes.len()];
    for n in mesh.elements.iter().flatten() {
        of_hexahedra[*n as usize] = true;
    }
    // By type: number of elements, number of those that share nodes with hexahedra, label and place of the first.
    let mut kinds: BTreeMap<&str, (usize, usize, u64, Place)> = BTreeMap::new();
    for frame in frames {
        for other in frame.scopes.iter().flat_map(|s| &s.others) {
            frame.others.insert(other.label);
            let kind = kinds.entry(&other.kind);
            let (count, joined, ..) = kind.or_insert((0, 0, other.label, other.place));
            *count += 1;
            let indices = other
                .nodes
                .iter()
                .filter_map(|n| frame.labels[NODES].get(n));
            let mut shared = indices.map(|n| of_hexahedra[*n as usize]);
            *joined += usize::from(shared.any(|shared| shared));
        }
    }
    for (kind, (count, joined, first, place)) in kinds {
        let joined = match joined {
            0 => String::new(),
            joined => format!(", {joined} of them with nodes of hexahedra"),
        };
        mesh.notes.push(format!(
            "{count} elements of the type {kind} are left out{joined} (the first is {first}, line {}): {}",
            place.line,
            instead_of(kind)
        ));
        *mesh.left_out.entry(kind.to_owned()).or_default() += count;
    }
}

/// Adds a note about parts without an instance.
pub(super) fn leave_parts_out(mesh: &mut ImportedMesh, raw: &Raw) {
    let placed = raw.instances.iter().map(|i| i.part.to_uppercase());
    let placed: BTreeSet<String> = placed.collect();
    let unused: Vec<&str> = raw
        .parts
        .keys()
        .map(String::as_str)
        .filter(|name| !placed.contains(*name))
        .collect();
    if !unused.is_empty() {
        mesh.notes.push(format!(
            "no *INSTANCE puts them anywhere, so these parts are left out: {}",
            unused.join(", ")
        ));
    }
}

impl ImportedMesh {
    /// Removes nodes that belong to no element, such as reference points: they would have no stiffness.
    pub(in crate::deck::import) fn take_unused_nodes_out(&mut self) {
        let mut used = vec![false; self.nodes.len()];
        for n in self.elements.iter().flatten() {
            used[*n as usize] = true;
        }
        let unused: Vec<u64> = (0..used.len())
            .filter(|n| !used[*n])
            .map(|n| self.node_labels[n])
            .collect();
        let Some(first) = unused.first() else {
            return;
        };
        self.notes.push(format!(
            "{} nodes belong to no element and are left out (the first is {first})",
            unused.len()
        ));
        let mut to = vec![u32::MAX; used.len()];
        let mut next = 0;
        for (n, used) in used.iter().enumerate() {
            if *used {
                to[n] = next;
                self.nodes[next as usize] = self.nodes[n];
                self.node_labels[next as usize] = self.node_labels[n];
                next += 1;
            }
        }
        self.nodes.truncate(next as usize);
        self.node_labels.truncate(next as usize);
        for n in self.elements.iter_mut().flatten() {
            *n = to[*n as usize];
        }
        for set in self.node_sets.values_mut() {
            set.retain(|n| to[*n as usize] != u32::MAX);
            for n in set {
                *n = to[*n as usize];
            }
        }
    }
}
