//! Resultants of sections: the forces that one part of a model exerts on the other across a cut.
//!
//! The nodal forces of an element are those that its nodes exert on it, and they balance. Part A (on the side of the
//! normal) acts on part B with
//!
//! ```text
//! F = − Σ (f_A − w r) (nodes that A and B share) − Σ f_c (nodes of B, contact cells c and ties between A and B)
//! ```
//!
//! and with the moment of these forces about the centre of the section, at the present positions of the nodes
//! (theory/sections.md, eqs 1 and 2). f_A: forces that a node exerts on elements, facets and ties of A; r: external force
//! on the node; w: part of the volume at the node that is A's. Both are in equilibrium with the loads and
//! reactions of either part to the tolerance of the increment.

use rustc_hash::{FxHashMap, FxHashSet};

use super::{System, Trial};
use crate::element::hexahedron::{cross, difference, dot};
use crate::model::Model;
use crate::model::boundary_facets::BoundaryFacets;
use crate::model::sections::{COLUMNS, Section};

/// Side of a facet at a section: 1 above, −1 below, 0 beside it.
type Side = i8;

/// Cut of one section, prepared for a mesh.
#[derive(Clone, Debug)]
pub struct Cut {
    section: Section,
    /// Elements above that have nodes in common with elements below, and which nodes these are.
    solids: Vec<(u32, [bool; 8])>,
    /// These nodes, ascending, and the part of the volume at each that lies above.
    common: Vec<(u32, f64)>,
    /// Side of each slave facet, of each master facet, and of each facet of general contact. `[facet]`
    slave: Vec<Side>,
    master: Vec<Side>,
    general: Vec<Side>,
    /// Nodes of elements below, and those of elements above that are none of them.
    nodes_below: FxHashSet<u32>,
    nodes_above: FxHashSet<u32>,
    /// Nodes whose mean displacement moves the centre.
    nodes: Vec<u32>,
}

/// Force [N] and moment [N mm] of one part on the other.
#[derive(Debug)]
struct Resultant<'a> {
    force: [f64; 3],
    moment: [f64; 3],
    /// Point to which the moment refers [mm].
    centre: [f64; 3],
    /// Positions of the nodes [mm].
    x: &'a [[f64; 3]],
}

impl Resultant<'_> {
    /// Subtracts a force at a node.
    fn take(&mut self, node: u32, force: [f64; 3]) {
        let arm = difference(self.x[node as usize], self.centre);
        let moment = cross(arm, force);
        for i in 0..3 {
            self.force[i] -= force[i];
            self.moment[i] -= moment[i];
        }
    }
}

impl Cut {
    /// Prepares all sections of a model.
    pub fn all(model: &Model) -> Vec<Self> {
        if model.sections.is_empty() {
            return Vec::new();
        }
        let skin = BoundaryFacets::of(&model.mesh);
        let contact = &model.contact;
        let slave = skin.behind(&contact.slave_facets);
        let master = skin.behind(&contact.master_facets);
        let general = contact.general.as_ref();
        let general = general.map_or_else(Vec::new, |general| skin.behind(&general.skin.facets));
        let sections = model.sections.iter();
        sections
            .map(|section| Self::of(model, section, [&slave, &master, &general]))
            .collect()
    }

    /// Prepares a section. `behind`: elements behind the slave facets, the master facets, and those of general contact.
    fn of(model: &Model, section: &Section, behind: [&Vec<Option<u32>>; 3]) -> Self {
        let mesh = &model.mesh;
        let mut side: Vec<Side> = vec![0; mesh.elements.len()];
        section.above.iter().for_each(|e| side[*e as usize] = 1);
        section.below.iter().for_each(|e| side[*e as usize] = -1);
        let below = section
            .below
            .iter()
            .flat_map(|e| mesh.elements[*e as usize]);
        let below: FxHashSet<u32> = below.collect();
        let solids = section.above.iter().filter_map(|e| {
            let nodes = mesh.elements[*e as usize].map(|n| below.contains(&n));
            nodes.contains(&true).then_some((*e, nodes))
        });
        let above = section.above.iter();
        let above = above.flat_map(|e| mesh.elements[*e as usize]);
        let (common, above): (FxHashSet<u32>, FxHashSet<u32>) =
            above.partition(|n| below.contains(n));
        let sides = |behind: &Vec<Option<u32>>| -> Vec<Side> {
            let of = |element: &Option<u32>| element.map_or(0, |e| side[e as usize]);
            behind.iter().map(of).collect()
        };
        let [slave, master, general] = behind.map(sides);
        Self {
            solids: solids.collect(),
            common: parts_above(model, &side, &common),
            slave,
            master,
            general,
            nodes_below: below,
            nodes_above: above,
            nodes: nodes_at(model, section),
            section: section.clone(),
        }
    }

    /// Part of the volume at a node that lies above, if both parts share the node.
    fn part_above(&self, node: u32) -> Option<f64> {
        let at = self.common.binary_search_by_key(&node, |(n, _)| *n);
        at.ok().map(|at| self.common[at].1)
    }

    /// Whether the force of a contact cell on its node at this place counts: `sides` are those of its two facets.
    fn counts(&self, sides: [Side; 2], place: usize, node: u32) -> bool {
        let half = place / 4;
        match (sides[half], sides[1 - half]) {
            // Elsewhere it balances the forces of the elements above.
            (1, _) => self.part_above(node).is_some(),
            (-1, 1) => true,
            _ => false,
        }
    }

    /// Centre at the present positions of a trial [mm].
    fn centre(&self, trial: &Trial) -> [f64; 3] {
        let count = self.nodes.len().max(1) as f64;
        [0, 1, 2].map(|i| {
            let moved = self
                .nodes
                .iter()
                .map(|n| trial.displacement[*n as usize][i]);
            self.section.centre[i] + moved.sum::<f64>() / count
        })
    }
}

/// Part of the height of an element within which its nodes lie at the plane beside those nearest to it.
const LEVEL: f64 = 1e-6;

/// Nodes nearest to the plane of those elements that it cuts or touches.
fn nodes_at(model: &Model, section: &Section) -> Vec<u32> {
    let mesh = &model.mesh;
    let mut nodes = Vec::new();
    for e in section.above.iter().chain(&section.below) {
        let height = |x| dot(difference(x, section.centre), section.directions[0]);
        let heights = mesh.corners(*e as usize).map(height);
        let low = heights.iter().copied().fold(f64::INFINITY, f64::min);
        let high = heights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let near = LEVEL * (high - low);
        if low > near || high < -near {
            continue;
        }
        let least = heights
            .iter()
            .map(|h| h.abs())
            .fold(f64::INFINITY, f64::min);
        let at = mesh.elements[*e as usize].iter().zip(heights);
        nodes.extend(at.filter(|(_, h)| h.abs() <= least + near).map(|(n, _)| *n));
    }
    nodes.sort_unstable();
    nodes.dedup();
    nodes
}

/// Part of the volume at each of some nodes that lies above; ascending.
fn parts_above(model: &Model, side: &[Side], common: &FxHashSet<u32>) -> Vec<(u32, f64)> {
    let mut volumes: FxHashMap<u32, [f64; 2]> = common.iter().map(|n| (*n, [0.0; 2])).collect();
    for (e, nodes) in model.mesh.elements.iter().enumerate() {
        if !nodes.iter().any(|n| common.contains(n)) {
            continue;
        }
        for (n, volume) in nodes.iter().zip(model.mesh.nodal_volumes(e)) {
            if let Some([above, all]) = volumes.get_mut(n) {
                *all += volume;
                *above += if side[e] == 1 { volume } else { 0.0 };
            }
        }
    }
    let parts = volumes.into_iter();
    let mut parts: Vec<_> = parts.map(|(n, [above, all])| (n, above / all)).collect();
    parts.sort_unstable_by_key(|(n, _)| *n);
    parts
}

impl System {
    /// Values of the columns of a section at a trial, whose forces are up to date [kN, kN m].
    pub fn section_values(&self, cut: &Cut, trial: &Trial) -> [f64; COLUMNS] {
        let mut sum = Resultant {
            force: [0.0; 3],
            moment: [0.0; 3],
            centre: cut.centre(trial),
            x: &trial.x,
        };
        for (e, common) in &cut.solids {
            let e = *e as usize;
            let forces = self.bulk.elements[e].iter().zip(&trial.cells.force[e]);
            for ((node, force), _) in forces.zip(common).filter(|(_, common)| **common) {
                sum.take(*node, *force);
            }
        }
        self.take_contact(cut, &trial.cells.force, &mut sum);
        // Ties of A: their forces on nodes that both parts share, and on those of B.
        for (nodes, along) in self.ties.forces(&trial.ties.segments) {
            if nodes.iter().any(|(n, _)| cut.nodes_above.contains(n)) {
                let below = nodes.iter().filter(|(n, _)| cut.nodes_below.contains(n));
                for (n, weight) in below {
                    sum.take(*n, along.map(|f| weight * f));
                }
            }
        }
        self.give_outside(cut, trial, &mut sum);
        cut.section.values(sum.force, sum.moment)
    }

    /// Takes the forces of contact cells on facets of A at nodes that both parts share, and on facets of B that meet A.
    fn take_contact(&self, cut: &Cut, forces: &[[[f64; 3]; 8]], sum: &mut Resultant<'_>) {
        let mut take = |sides: [Side; 2], nodes: &[u32; 8], force: &[[f64; 3]; 8]| {
            if !sides.contains(&1) {
                return;
            }
            for (place, (node, force)) in nodes.iter().zip(force).enumerate() {
                if cut.counts(sides, place, *node) {
                    sum.take(*node, *force);
                }
            }
        };
        let first = self.bulk.elements.len();
        for (facet, slave) in cut.slave.iter().enumerate() {
            let masters = self.contact.masters_of(facet);
            for ((cell, nodes), master) in self.contact.cells_of(facet).zip(masters) {
                let sides = [*slave, cut.master[*master as usize]];
                take(sides, nodes, &forces[first + cell]);
            }
        }
        let first = first + self.contact.cell_count();
        let cells = self.general.cells().iter().zip(self.general.pairs());
        for (cell, (nodes, facets)) in cells.enumerate() {
            let sides = facets.map(|facet| cut.general[facet as usize]);
            take(sides, nodes, &forces[first + cell]);
        }
    }

    /// Gives A its part of the external forces on the nodes that both parts share: loads, weights, reactions, springs and
    /// inertia balance the forces of solids, joints and ties there.
    fn give_outside(&self, cut: &Cut, trial: &Trial, sum: &mut Resultant<'_>) {
        for (node, part) in &cut.common {
            let outside = trial.node_force[*node as usize];
            sum.take(*node, outside.map(|f| -part * f));
        }
        // Springs are in the sum of a node with the opposite sign.
        let springs = (self.springs).nodal_forces(&trial.displacement, &trial.spring_ends);
        for (node, force) in springs {
            if let Some(part) = cut.part_above(node) {
                sum.take(node, force.map(|f| -part * f));
            }
        }
    }
}
