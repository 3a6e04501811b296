//! Lumped mass from the densities, and the forces of a uniform acceleration.
//!
//! Each mass is a row sum of the consistent mass matrix of the element (Hughes 2000, §7.3.2; theory/inertia.md, eq.
//! 7):
//!
//! ```text
//! m_a = Σ_b ∫ ρ N_a N_b dV = ∫ ρ N_a dV
//! ```
//!
//! The 2×2×2 Gauss points of the element integrate the volume of a trilinear hexahedron exactly, so the total mass
//! is exact. Floors add their masses to nodes. Nodes tied to a beam add to its mass. Mass at supported displacements
//! moves nothing.

use nalgebra::DMatrix;

use super::dofs::{DofMap, HELD};
use super::{Bulk, RigidBodies};
use crate::element::hex8::CORNERS;
use crate::model::Model;

/// Consistent mass of a rigid body, M_ab = ∫ ρ N_a N_b dV, beside its lumped one. It gives the moments of inertia of
/// the solid (theory/rigid-bodies.md, eq. 7).
#[derive(Clone, Debug)]
pub(super) struct BodyMass {
    /// Slots of its nodes. `[node][xyz]`
    slots: Vec<[u32; 3]>,
    /// Consistent mass without the lumped one [tonne]; its rows sum to zero. `[node][node]`
    pub(super) coupling: DMatrix<f64>,
}

impl BodyMass {
    /// Visits the pairs of slots that it couples.
    fn each(&self, mut visit: impl FnMut(usize, usize, f64)) {
        for (a, rows) in self.slots.iter().enumerate() {
            for (b, columns) in self.slots.iter().enumerate() {
                for (row, column) in rows.iter().zip(columns) {
                    if *row != HELD && *column != HELD {
                        visit(*row as usize, *column as usize, self.coupling[(a, b)]);
                    }
                }
            }
        }
    }
}

/// Masses of nodes and of generalised displacements.
#[derive(Clone, Debug)]
pub struct Mass {
    /// Mass of each node [tonne]. `[node]`
    pub node: Vec<f64>,
    /// Mass that each generalised displacement moves [tonne], Σ w² m of its nodes, which make the parts w of it. `[slot]`
    pub slot: Vec<f64>,
    /// The same for uniform accelerations [tonne], Σ w m. `[slot]`
    lever: Vec<f64>,
    /// Direction of each slot's displacement. `[slot]`
    direction: Vec<u8>,
    /// Rigid bodies.
    bodies: Vec<BodyMass>,
    /// Number of elements, for the mean over their nodes. An element across a plane of symmetry counts in part.
    elements: f64,
}

impl Mass {
    /// Sums the masses of a model.
    pub fn new(model: &Model, bulk: &Bulk, dofs: &DofMap) -> Self {
        let mut node = vec![0.0; model.mesh.nodes.len()];
        for (e, nodes) in bulk.elements.iter().enumerate() {
            let material = &model.materials[model.mesh.material[e] as usize].parameters;
            let density = material.elastic().density;
            let volumes = nodal_volumes(&bulk.shape(e).weight);
            for (&n, volume) in nodes.iter().zip(volumes) {
                node[n as usize] += density * volume;
            }
        }
        for (n, mass) in model.floors.iter().flat_map(|floor| &floor.masses) {
            node[*n as usize] += mass;
        }
        let mut slot = vec![0.0; dofs.slots];
        let (mut lever, mut direction) = (slot.clone(), vec![0; dofs.slots]);
        let mut part = dofs.sign.clone();
        // The sign of an image is no part of a settlement.
        for image in dofs.reflected() {
            part[image.node as usize] = [1.0; 3];
        }
        for ((mass, slots), part) in node.iter().zip(&dofs.slot).zip(&part) {
            for (i, &s) in slots.iter().enumerate() {
                if s != HELD {
                    slot[s as usize] += part[i] * part[i] * mass;
                    lever[s as usize] += part[i] * mass;
                    direction[s as usize] = i as u8;
                }
            }
        }
        Self {
            node,
            slot,
            lever,
            direction,
            bodies: Vec::new(),
            elements: bulk.count,
        }
    }

    /// Gives rigid bodies the consistent mass of their elements.
    pub(super) fn of_bodies(
        &mut self,
        bulk: &Bulk,
        dofs: &DofMap,
        model: &Model,
        bodies: &RigidBodies,
    ) {
        let mass = |(nodes, elements): (&[u32], &[u32])| {
            let mut mass = DMatrix::zeros(nodes.len(), nodes.len());
            for &e in elements {
                let material = model.mesh.material[e as usize];
                let density = model.materials[usize::from(material)]
                    .parameters
                    .elastic()
                    .density;
                let own = |n: u32| model.mesh.reflected(n).map_or(n, |image| image.of);
                let places = bulk.elements[e as usize].map(|n| nodes.binary_search(&own(n)).ok());
                for (row, sums) in places
                    .iter()
                    .zip(consistent(&bulk.shape(e as usize).weight))
                {
                    for (column, sum) in places.iter().zip(sums) {
                        if let (Some(row), Some(column)) = (row, column) {
                            mass[(*row, *column)] += density * sum;
                        }
                    }
                }
            }
            // Lumped masses are the row sums; what joins the nodes is the rest.
            for row in 0..nodes.len() {
                mass[(row, row)] -= mass.row(row).sum();
            }
            BodyMass {
                slots: nodes.iter().map(|n| dofs.slot[*n as usize]).collect(),
                coupling: mass,
            }
        };
        self.bodies = bodies.parts().map(mass).collect();
    }

    /// Coupling of the masses of each rigid body. `[body]`
    pub(super) fn bodies(&self) -> &[BodyMass] {
        &self.bodies
    }

    /// Adds the part of M v that couples nodes of rigid bodies to `to`. `[slot]`
    pub fn add_coupling(&self, factor: f64, v: &[f64], to: &mut [f64]) {
        for body in &self.bodies {
            body.each(|row, column, mass| to[row] += factor * mass * v[column]);
        }
    }

    /// The part of uᵀ M v that couples nodes of rigid bodies. `[slot]`
    pub fn coupling(&self, u: &[f64], v: &[f64]) -> f64 {
        let mut sum = 0.0;
        for body in &self.bodies {
            body.each(|row, column, mass| sum += u[row] * mass * v[column]);
        }
        sum
    }

    /// Total mass [tonne].
    pub fn total(&self) -> f64 {
        self.node.iter().sum()
    }

    /// Component of a uniform acceleration along a slot.
    pub fn along(&self, slot: usize, acceleration: [f64; 3]) -> f64 {
        acceleration[self.direction[slot] as usize]
    }

    /// Inertia forces M a of a uniform acceleration [N]. `[slot]`
    pub fn forces(&self, acceleration: [f64; 3], forces: &mut [f64]) {
        for ((f, m), &i) in forces.iter_mut().zip(&self.lever).zip(&self.direction) {
            *f = m * acceleration[i as usize];
        }
    }

    /// Generalised velocities from nodal ones `[node]` [mm/s]. They preserve the momentum of tied nodes.
    pub fn mean_velocity(&self, dofs: &DofMap, nodal: &[[f64; 3]], velocity: &mut [f64]) {
        velocity.fill(0.0);
        let nodes = nodal.iter().zip(&self.node).zip(&dofs.slot);
        for (((v, m), slots), sign) in nodes.zip(&dofs.sign) {
            for (i, &s) in slots.iter().enumerate() {
                if s != HELD {
                    velocity[s as usize] += m * sign[i] * v[i] / self.slot[s as usize];
                }
            }
        }
    }

    /// Kinetic energy ½ vᵀ M v [N mm].
    pub fn kinetic_energy(&self, velocity: &[f64]) -> f64 {
        let twice: f64 = self.slot.iter().zip(velocity).map(|(m, v)| m * v * v).sum();
        0.5 * (twice + self.coupling(velocity, velocity))
    }

    /// Mean magnitude of M a over the elements' nodes [N], with the acceleration a of each slot [mm/s²]. It is the
    /// scale of forces where nothing is stressed.
    pub fn mean_force(&self, acceleration: impl Iterator<Item = f64>) -> f64 {
        let sum: f64 = self
            .slot
            .iter()
            .zip(acceleration)
            .map(|(m, a)| m * a.abs())
            .sum();
        sum / (8.0 * self.elements.max(f64::MIN_POSITIVE))
    }
}

/// ∫ N_a dV [mm³] from det J · w at the Gauss points, which are ordered like the nodes.
fn nodal_volumes(weight: &[f64; 8]) -> [f64; 8] {
    CORNERS.map(|a| {
        let points = CORNERS.iter().zip(weight);
        points.map(|(g, w)| w * shape(a, *g)).sum()
    })
}

/// N_a at the Gauss point nearest to corner `g`.
fn shape(a: [f64; 3], g: [f64; 3]) -> f64 {
    let at = 1.0 / 3.0_f64.sqrt();
    (0..3).map(|i| 0.5 * (1.0 + at * a[i] * g[i])).product()
}

/// ∫ N_a N_b dV [mm³] in the same way.
fn consistent(weight: &[f64; 8]) -> [[f64; 8]; 8] {
    let mut sum = [[0.0; 8]; 8];
    for (g, w) in CORNERS.iter().zip(weight) {
        let n = CORNERS.map(|a| shape(a, *g));
        for a in 0..8 {
            for b in 0..8 {
                sum[a][b] += w * n[a] * n[b];
            }
        }
    }
    sum
}
