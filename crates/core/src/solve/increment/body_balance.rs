//! Balance of single bodies (docs/theory/equilibrium.md, eq. 18b).
//!
//! A light body beside heavy ones has forces far below the mean nodal force of the scene. Its own resultant tells
//! whether it is in equilibrium. Units that mortar bonds are parts of a whole and need no balance of their own.

use wythe_contact::JointLaw;

use crate::assembly::{System, Trial};
use crate::model::Model;
use crate::model::surfaces::ContactSurfaces;
use crate::state::{QUIET, State};

/// Largest resultant of the out-of-balance forces on a body over the forces that act on it.
pub(in crate::solve) const RESULTANT: f64 = 4e-3;

/// Least scale of the resultant on a node of a body, as a part of the scale of the scene.
pub(in crate::solve) const LEAST: f64 = 1e-6;

/// Way over the smallest edge of a body below which its motion is that of an elastic structure.
const NEAR: f64 = 1e-3;

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
    /// Smallest edge of the box around a body at rest [mm]. `[body]`
    edge: Vec<f64>,
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
        let edge = mesh.smallest_edges();
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
            edge,
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
        let acting = self.acting((system, trial), loads, least);
        let over = |(r, acting): (&[f64; 3], &f64)| norm(r) / acting.max(f64::MIN_POSITIVE);
        resultant.iter().zip(&acting).map(over).fold(0.0, f64::max)
    }

    /// Half the sum of the sizes of the forces on the nodes of each body, at least `least` on each [N]. `[body]`
    fn acting(
        &self,
        (system, trial): (&System, &Trial),
        loads: impl Iterator<Item = f64>,
        least: f64,
    ) -> Vec<f64> {
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
        acting
    }

    /// Whether a body moves beside its own forces (docs/theory/inertia.md, eq. 10b). `loads`: [N] `[slot]`; `since`:
    /// displacements of the last equilibrium [mm] `[slot]`.
    pub(in crate::solve) fn any_moves(
        &self,
        (system, trial): (&System, &Trial),
        state: &State,
        loads: &[f64],
        since: &[f64],
    ) -> bool {
        let mut kinetic = vec![0.0; self.nodes.len()];
        let mut way = vec![[0.0; 3]; self.nodes.len()];
        for (slot, &(body, i)) in self.of_slot.iter().enumerate() {
            if body != NONE {
                let (body, v) = (body as usize, state.velocity[slot]);
                kinetic[body] += 0.5 * system.mass.slot[slot] * v * v;
                way[body][i as usize] += state.q[slot] - since[slot];
            }
        }
        let acting = self.acting((system, trial), loads.iter().map(|f| f.abs()), 0.0);
        (0..self.nodes.len()).any(|body| {
            let way = norm(&way[body]) / f64::from(self.nodes[body].max(1));
            let way = way.max(NEAR * self.edge[body]);
            kinetic[body] > 0.0 && kinetic[body] >= QUIET * acting[body] * way
        })
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
