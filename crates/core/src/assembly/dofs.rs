//! Generalised degrees of freedom: free nodes, level beams, supports.
//!
//! A nodal displacement is a generalised displacement, `u[node][i] = ±q[slot]`, or zero at a support
//! (theory/equilibrium.md, eq. 1). A level beam, which does not rotate, is three generalised displacements
//! shared by many nodes, so a tie needs no constraint equation. Node slots come first, in the order of nodes;
//! beam slots follow. A settlement is a beam whose nodes each make a part of its displacement.
//! Which beam slots are unknowns depends on the step ([`Equations`]), so a locked beam needs
//! no new numbering of the nodes. An image node beyond a plane of symmetry shares the slots of its original,
//! with the opposite sign along the normal.

use crate::model::Model;
use crate::model::mesh::Reflected;
use crate::model::scene::{Beam, BeamMotion, Step, Support};

/// Slot of a nodal displacement that a support keeps at zero.
pub const HELD: u32 = u32::MAX;

/// Equation of a slot that is not an unknown.
pub const PRESCRIBED: u32 = u32::MAX;

/// Part of its slot that each nodal displacement makes: the shape of a settlement, else 1. `[node][xyz]`
fn parts(nodes: usize, beams: &[Beam]) -> Vec<[f64; 3]> {
    let mut parts = vec![[1.0; 3]; nodes];
    for beam in beams {
        for (&n, part) in beam.nodes.iter().zip(&beam.shape) {
            parts[n as usize] = [*part; 3];
        }
        for &(n, i) in &beam.free {
            parts[n as usize][i] = 1.0;
        }
    }
    parts
}

/// Map from generalised to nodal displacements.
#[derive(Clone, Debug)]
pub struct DofMap {
    /// Slot of each nodal displacement or [`HELD`]. `[node][xyz]`
    pub slot: Vec<[u32; 3]>,
    /// Sign of the nodal displacement relative to the slot's: −1 along the normal for an image in a plane of
    /// symmetry, the part of a settlement, else 1. `[node][xyz]`
    pub sign: Vec<[f64; 3]>,
    /// Number of generalised displacements.
    pub slots: usize,
    /// First slot of the beams; beam `b` owns `beam_start + 3 b ..+ 3`.
    pub beam_start: usize,
    /// First node that each slot moves, and its direction. `[slot]`
    owner: Vec<(u32, u8)>,
    /// Images in planes of symmetry.
    reflected: Vec<Reflected>,
}

impl DofMap {
    /// Numbers the generalised displacements of a model.
    pub fn new(model: &Model) -> Self {
        let nodes = model.mesh.nodes.len();
        Self::of(nodes, &model.beams, &model.supports, &model.mesh.reflected)
    }

    /// Numbers the generalised displacements of `nodes` nodes with these beams, supports and images.
    pub fn of(nodes: usize, beams: &[Beam], supports: &[Support], reflected: &[Reflected]) -> Self {
        const UNSET: u32 = u32::MAX - 1;
        let mut slot = vec![[UNSET; 3]; nodes];
        // Ties are set first and supports over them: a supported node does not follow its beam.
        for (b, beam) in beams.iter().enumerate() {
            for &n in &beam.nodes {
                slot[n as usize] = [0, 1, 2].map(|i| UNSET - 1 - (3 * b as u32 + i));
            }
            for &(n, i) in &beam.free {
                slot[n as usize][i] = UNSET;
            }
        }
        for support in supports {
            for &n in &support.nodes {
                for i in 0..3 {
                    if support.fixed[i] {
                        slot[n as usize][i] = HELD;
                    }
                }
            }
        }
        // Images take the slots of their originals below.
        for image in reflected {
            slot[image.node as usize] = [HELD; 3];
        }
        let mut next = 0_u32;
        for s in slot.iter_mut().flatten().filter(|s| **s == UNSET) {
            *s = next;
            next += 1;
        }
        let beam_start = next;
        for s in slot
            .iter_mut()
            .flatten()
            .filter(|s| **s != HELD && **s >= beam_start)
        {
            *s = beam_start + (UNSET - 1 - *s);
        }
        let mut sign = parts(nodes, beams);
        for image in reflected {
            slot[image.node as usize] = slot[image.of as usize];
            let of = sign[image.of as usize];
            sign[image.node as usize] = [0, 1, 2].map(|i| image.sign[i] * of[i]);
        }
        let slots = beam_start as usize + 3 * beams.len();
        let mut owner = vec![(u32::MAX, 0); slots];
        for (n, s) in slot.iter().enumerate() {
            for i in 0..3 {
                if s[i] != HELD && sign[n][i] != 0.0 && owner[s[i] as usize].0 == u32::MAX {
                    owner[s[i] as usize] = (n as u32, i as u8);
                }
            }
        }
        Self {
            slot,
            sign,
            slots,
            beam_start: beam_start as usize,
            owner,
            reflected: reflected.to_vec(),
        }
    }

    /// A node that the slot moves, and its direction.
    pub fn node_of(&self, slot: usize) -> (usize, usize) {
        let (node, direction) = self.owner[slot];
        (node as usize, direction as usize)
    }

    /// Slot of direction `i` of beam `b`.
    pub fn beam_slot(&self, b: usize, i: usize) -> usize {
        self.beam_start + 3 * b + i
    }

    /// Generalised displacement of a slot from the displacement of the node that [`Self::node_of`] gives [mm].
    pub fn of_node(&self, slot: usize, u: &[f64; 3]) -> f64 {
        let (node, i) = self.node_of(slot);
        u[i] / self.sign[node][i]
    }

    /// Nodal displacements of generalised ones: `u[node][i] = ±q[slot]` or 0 [mm].
    pub fn spread(&self, q: &[f64], u: &mut [[f64; 3]]) {
        for ((u, s), sign) in u.iter_mut().zip(&self.slot).zip(&self.sign) {
            for i in 0..3 {
                u[i] = if s[i] == HELD {
                    0.0
                } else {
                    sign[i] * q[s[i] as usize]
                };
            }
        }
    }

    /// A map in which rigid bodies have two nodes each, `hosts`, for translation and rotation, of which the directions
    /// `free` are unknowns; their other nodes have no slots. A last node that has none either is added. `body_of`: body
    /// of each node, if any (an index into `hosts`). `[node]`
    pub(super) fn with_bodies(
        &self,
        body_of: &[u32],
        hosts: &[[u32; 2]],
        free: &[[[bool; 3]; 2]],
    ) -> WithBodies {
        let nodes = self.slot.len();
        let mut slot = vec![[HELD; 3]; nodes + 1];
        let mut owner = Vec::new();
        let mut new = vec![HELD; self.slots];
        for n in 0..nodes {
            if let Some(hosts) = hosts.get(body_of[n] as usize) {
                if hosts[0] as usize != n {
                    continue;
                }
                // Both belong to the first node, so that they are eliminated together.
                for (host, free) in hosts.iter().zip(&free[body_of[n] as usize]) {
                    for i in (0..3).filter(|i| free[*i]) {
                        slot[*host as usize][i] = owner.len() as u32;
                        owner.push((n as u32, i as u8));
                    }
                }
                continue;
            }
            for i in 0..3 {
                let own = self.slot[n][i] as usize;
                if own < self.beam_start {
                    if new[own] == HELD {
                        new[own] = owner.len() as u32;
                        owner.push(self.owner[own]);
                    }
                    slot[n][i] = new[own];
                }
            }
        }
        let beam_start = owner.len();
        for own in self.beam_start..self.slots {
            new[own] = owner.len() as u32;
            owner.push(self.owner[own]);
        }
        for (to, from) in slot.iter_mut().zip(&self.slot) {
            for i in 0..3 {
                if from[i] != HELD && from[i] as usize >= self.beam_start {
                    to[i] = new[from[i] as usize];
                }
            }
        }
        let mut sign = self.sign.clone();
        sign.push([1.0; 3]);
        let slots = new.iter().enumerate().filter(|(_, new)| **new != HELD);
        WithBodies {
            slots: slots.map(|(own, new)| (own as u32, *new)).collect(),
            dofs: Self {
                slot,
                sign,
                slots: owner.len(),
                beam_start,
                owner,
                reflected: self.reflected.clone(),
            },
        }
    }

    /// Images in planes of symmetry, by node.
    pub fn reflected(&self) -> &[Reflected] {
        &self.reflected
    }

    /// Adds forces on images to their originals and clears them.
    pub fn fold(&self, f: &mut [[f64; 3]]) {
        for image in &self.reflected {
            let own = std::mem::take(&mut f[image.node as usize]);
            let of = &mut f[image.of as usize];
            (0..3).for_each(|i| of[i] += image.sign[i] * own[i]);
        }
    }

    /// Generalised forces [N] from nodal forces [N], summed in node order.
    pub fn collect(&self, f: &[[f64; 3]], p: &mut [f64]) {
        p.fill(0.0);
        for ((f, s), sign) in f.iter().zip(&self.slot).zip(&self.sign) {
            for i in 0..3 {
                if s[i] != HELD {
                    p[s[i] as usize] += sign[i] * f[i];
                }
            }
        }
    }
}

/// A map with rigid bodies.
pub(super) struct WithBodies {
    pub(super) dofs: DofMap,
    /// Slots before that belong to no body, and those of the map.
    pub(super) slots: Vec<(u32, u32)>,
}

/// The unknowns of one step.
#[derive(Clone, Debug)]
pub struct Equations {
    /// Equation of each slot, or [`PRESCRIBED`]. `[slot]`
    pub of_slot: Vec<u32>,
    /// Slot of each equation. `[equation]`
    pub slot_of: Vec<u32>,
}

impl Equations {
    /// Numbers the unknowns of a step: all node slots, then the free directions of the beams.
    pub fn new(dofs: &DofMap, step: &Step) -> Self {
        let mut of_slot: Vec<u32> = (0..dofs.beam_start as u32).collect();
        let mut slot_of = of_slot.clone();
        for motion in step.motion.iter().flatten() {
            let slot = of_slot.len() as u32;
            if matches!(motion, BeamMotion::Force(_)) {
                of_slot.push(slot_of.len() as u32);
                slot_of.push(slot);
            } else {
                of_slot.push(PRESCRIBED);
            }
        }
        Self { of_slot, slot_of }
    }

    /// The unknowns of the same step for a map with rigid bodies, made from `own`.
    pub(super) fn with_bodies(&self, own: &DofMap, bodies: &DofMap) -> Self {
        let mut of_slot: Vec<u32> = (0..bodies.beam_start as u32).collect();
        let mut slot_of = of_slot.clone();
        for of_beam in &self.of_slot[own.beam_start..] {
            let slot = of_slot.len() as u32;
            if *of_beam == PRESCRIBED {
                of_slot.push(PRESCRIBED);
            } else {
                of_slot.push(slot_of.len() as u32);
                slot_of.push(slot);
            }
        }
        Self { of_slot, slot_of }
    }

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.slot_of.len()
    }

    /// True if there are no unknowns.
    pub fn is_empty(&self) -> bool {
        self.slot_of.is_empty()
    }
}
