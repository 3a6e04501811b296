//! Balance of single bodies (docs/theory/equilibrium.md, eq. 18b).
//!
//! A light body beside heavy ones has forces far below the mean nodal force of the scene. Its own resultant tells
//! whether it is in equilibrium. Units that mortar bonds are parts of a whole and need no balance of their own.

use wythe_contact::JointLaw;

use crate::assembly::{System, Trial};
use crate::model::Model;
use crate::model::surfaces::ContactSurfaces;

/// Largest resultant of the out-of-balance forces on a body over the forces that act on it.
pub(in crate::solve) const RESULTANT: f64 = 1e-2;

/// Least scale of the resultant on a node of a body, as a part of the scale of the scene.
pub(in crate::solve) const LEAST: f64 = 1e-6;

/// Mark of nodes and slots of no body.
const NONE: u32 = u32::MAX;

/// Bodies of the nodes and slots of a scene, but for those that a bond holds.
pub(in crate::solve) struct Bodies {
    /// `[node]`
    of_node: Vec<u32>,
    /// Body and direction of each slot. Those of beams have none. `[slot]`
    of_slot: Vec<(u32, u8)>,
    /// Number of nodes. `[body]`
    nodes: Vec<u32>,
}

impl Bodies {
    /// Finds the bodies of a scene that no bond holds.
    pub(in crate::solve) fn new(model: &Model, system: &System) -> Self {
        let mesh = &model.mesh;
        let mut of_node = vec![NONE; mesh.nodes.len()];
        let bonded = bonded(&model.contact, mesh.names.len());
        let elements = mesh.elements.iter().zip(&mesh.unit);
        for (nodes, &unit) in elements.filter(|(_, unit)| !bonded[**unit as usize]) {
            for &n in nodes {
                of_node[n as usize] = unit;
            }
        }
        let mut nodes = vec![0; mesh.names.len()];
        for &body in of_node.iter().filter(|body| **body != NONE) {
            nodes[body as usize] += 1;
        }
        let dofs = &system.dofs;
        let of_slot = (0..dofs.slots).map(|slot| {
            if slot >= dofs.beam_start {
                return (NONE, 0);
            }
            let (node, direction) = dofs.node_of(slot);
            (of_node.get(node).copied().unwrap_or(NONE), direction as u8)
        });
        Self {
            of_slot: of_slot.collect(),
            of_node,
            nodes,
        }
    }

    /// Largest resultant of the out-of-balance forces on a body over the forces that act on it. `residual`: [N]
    /// `[equation]`; `slot_of`: slot of each equation; `loads`: sizes of the loads, those of inertia included [N] `[slot]`;
    /// `least`: smallest scale of a node [N].
    pub(in crate::solve) fn worst(
        &self,
        (system, trial): (&System, &Trial),
        (residual, slot_of): (&[f64], &[u32]),
        loads: impl Iterator<Item = f64>,
        least: f64,
    ) -> f64 {
        let mut resultant = vec![[0.0; 3]; self.nodes.len()];
        for (r, &slot) in residual.iter().zip(slot_of) {
            let (body, i) = self.of_slot[slot as usize];
            if body != NONE {
                resultant[body as usize][i as usize] += r;
            }
        }
        let mut acting: Vec<f64> = (self.nodes.iter())
            .map(|&nodes| least * f64::from(nodes))
            .collect();
        for (&(body, _), load) in self.of_slot.iter().zip(loads) {
            if body != NONE {
                acting[body as usize] += 0.5 * load;
            }
        }
        let forces = system.forces_on_solids(trial);
        for (&body, force) in self.of_node.iter().zip(&forces) {
            if body != NONE {
                acting[body as usize] += 0.5 * norm(force);
            }
        }
        let over = |(r, acting): (&[f64; 3], &f64)| norm(r) / acting.max(f64::MIN_POSITIVE);
        resultant.iter().zip(&acting).map(over).fold(0.0, f64::max)
    }
}

/// Whether facets of a body have a joint with a bond. `[body]`
fn bonded(contact: &ContactSurfaces, bodies: usize) -> Vec<bool> {
    let mut bonded = vec![false; bodies];
    for (&body, &law) in contact.slave_body.iter().zip(&contact.slave_law) {
        bonded[body as usize] |= !contact.laws[law as usize].is_dry();
    }
    bonded
}

fn norm(v: &[f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}
