//! Resultants of sections: the forces that one part of a model exerts on the other across a cut.
//!
//! The nodal forces of an element are those that its nodes exert on it, and they balance. Part A (on the side of the
//! normal) acts on part B with
//!
//! ```text
//! F = − Σ (f_a − m_a g) (nodes between A and B, elements a of A) − Σ f_c (nodes of B, contact cells c between A and B)
//! ```
//!
//! and with the moment of these forces about the centre of the section, at the present positions of the nodes
//! (theory/sections.md, eqs 1 and 2). Both are in equilibrium with the loads and reactions of either part to the
//! tolerance of the increment.

use rustc_hash::FxHashSet;

use super::bulk::Bulk;
use super::mass::nodal_masses;
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
    /// Masses of the nodes of these elements, their parts of the mass of each [tonne].
    masses: Vec<[f64; 8]>,
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
#[derive(Clone, Copy, Debug, Default)]
struct Resultant {
    force: [f64; 3],
    moment: [f64; 3],
}

impl Resultant {
    /// Subtracts a nodal force at distance `arm` [mm] from the centre.
    fn take(&mut self, force: &[f64; 3], arm: [f64; 3]) {
        let moment = cross(arm, *force);
        for i in 0..3 {
            self.force[i] -= force[i];
            self.moment[i] -= moment[i];
        }
    }
}

impl Cut {
    /// Prepares all sections of a model.
    pub fn all(model: &Model, bulk: &Bulk) -> Vec<Self> {
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
        let cuts = sections.map(|section| {
            let mut cut = Self::of(model, section, [&slave, &master, &general]);
            let masses = cut.solids.iter();
            cut.masses = masses
                .map(|(e, _)| nodal_masses(model, bulk, *e as usize))
                .collect();
            cut
        });
        cuts.collect()
    }

    /// Prepares a section. `behind`: elements behind the slave facets, the master facets, and those of general contact.
    fn of(model: &Model, section: &Section, behind: [&Vec<Option<u32>>; 3]) -> Self {
        let mesh = &model.mesh;
        let mut side = vec![0; mesh.elements.len()];
        section.above.iter().for_each(|e| side[*e as usize] = 1);
        section.below.iter().for_each(|e| side[*e as usize] = -1);
        let below = section
            .below
            .iter()
            .flat_map(|e| mesh.elements[*e as usize]);
        let below: FxHashSet<u32> = below.collect();
        let common = section.above.iter().filter_map(|e| {
            let nodes = mesh.elements[*e as usize].map(|n| below.contains(&n));
            nodes.contains(&true).then_some((*e, nodes))
        });
        let above = section.above.iter();
        let above = above.flat_map(|e| mesh.elements[*e as usize]);
        let above: FxHashSet<u32> = above.filter(|n| !below.contains(n)).collect();
        let common: Vec<(u32, [bool; 8])> = common.collect();
        let sides = |behind: &Vec<Option<u32>>| -> Vec<Side> {
            let of = |element: &Option<u32>| element.map_or(0, |e| side[e as usize]);
            behind.iter().map(of).collect()
        };
        let [slave, master, general] = behind.map(sides);
        Self {
            solids: common,
            masses: Vec::new(),
            slave,
            master,
            general,
            nodes_below: below,
            nodes_above: above,
            nodes: nodes_at(model, section),
            section: section.clone(),
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

impl System {
    /// Values of the columns of a section at a trial, whose forces are up to date [kN, kN m].
    ///
    /// `weights`: acceleration of the weights, less that of the ground [mm/s²].
    pub fn section_values(&self, cut: &Cut, trial: &Trial, weights: [f64; 3]) -> [f64; COLUMNS] {
        let centre = cut.centre(trial);
        let mut sum = Resultant::default();
        let mut take = |nodes: &[u32], forces: &[[f64; 3]], which: &dyn Fn(usize) -> bool| {
            for (a, (node, force)) in nodes.iter().zip(forces).enumerate() {
                if which(a) {
                    let x = trial.x[*node as usize];
                    sum.take(force, [0, 1, 2].map(|i| x[i] - centre[i]));
                }
            }
        };
        let forces = &trial.cells.force;
        for ((e, common), mass) in cut.solids.iter().zip(&cut.masses) {
            let e = *e as usize;
            let weighs = mass.map(|m| weights.map(|g| -m * g));
            take(&self.bulk.elements[e], &forces[e], &|a| common[a]);
            take(&self.bulk.elements[e], &weighs, &|a| common[a]);
        }
        let first = self.bulk.elements.len();
        for (facet, side) in cut.slave.iter().enumerate().filter(|(_, side)| **side != 0) {
            let masters = self.contact.masters_of(facet);
            for ((cell, nodes), master) in self.contact.cells_of(facet).zip(masters) {
                if cut.master[*master as usize] == -side {
                    let below = |a: usize| (a < 4) == (*side < 0);
                    take(nodes, &forces[first + cell], &below);
                }
            }
        }
        let first = first + self.contact.cell_count();
        let cells = self.general.cells().iter().zip(self.general.pairs());
        for (cell, (nodes, [a, b])) in cells.enumerate() {
            let sides = [a, b].map(|facet| cut.general[*facet as usize]);
            if sides[0] * sides[1] == -1 {
                let below = |a: usize| (a < 4) == (sides[0] < 0);
                take(nodes, &forces[first + cell], &below);
            }
        }
        // Ties between both parts.
        for (nodes, along) in self.ties.forces(&trial.ties.segments) {
            if nodes.iter().any(|(n, _)| cut.nodes_above.contains(n)) {
                let below = nodes.iter().filter(|(n, _)| cut.nodes_below.contains(n));
                for (n, weight) in below {
                    take(&[*n], &[along.map(|f| weight * f)], &|_| true);
                }
            }
        }
        cut.section.values(sum.force, sum.moment)
    }
}
