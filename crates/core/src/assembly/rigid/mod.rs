//! Rigid bodies: units whose nodes move together, with six unknowns each (docs/theory/rigid-bodies.md).
//!
//! The state keeps the displacements of all nodes, so that joints, masses, loads and results see no difference. The
//! nodes are kept at a rigid pose, out-of-balance forces of a body are those of its resultant, and the linear
//! equations have the unknowns of the bodies.

mod body;
mod reduction;
#[cfg(test)]
mod tests;

use nalgebra::Vector3;
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::dofs::{DofMap, Equations, HELD, PRESCRIBED};
use super::{Springs, Ties, Trial, Turning};
use crate::model::Model;
use crate::model::mesh::Reflected;
use body::Body;
use reduction::Reduction;

/// Number that stands for no body.
const NONE: u32 = u32::MAX;

/// Rigid bodies of a model. Units of rigid material that are tied to beams, springs, ties or controlling probes, that a
/// section cuts, that lie across two planes of symmetry, or that supports hold in another way than in a plane, are not
/// among them: they stay stiff solids.
#[derive(Debug, Default)]
pub struct RigidBodies {
    bodies: Vec<Body>,
    /// Body of each node, or [`NONE`]. `[node]`
    body_of: Vec<u32>,
    /// Images of nodes of a body that face it across a joint in a plane of symmetry.
    facing: Vec<Reflected>,
    /// Linear equations in the unknowns of the bodies, once the matrix was analysed.
    reduction: Option<Reduction>,
    /// Whether the stiffness of forces whose arms turn is taken with its unsymmetric part.
    unsymmetric: bool,
}

impl RigidBodies {
    /// Finds the rigid bodies of a model.
    pub(super) fn new(model: &Model, dofs: &DofMap, springs: &Springs, ties: &Ties) -> Self {
        if !model.materials.iter().any(|m| m.rigid) {
            return Self::default();
        }
        let mesh = &model.mesh;
        let units = mesh.unit.iter().max().map_or(0, |u| *u as usize + 1);
        let mut elements = vec![Vec::new(); units];
        let mut is_rigid = vec![true; units];
        for (e, unit) in mesh.unit.iter().enumerate() {
            elements[*unit as usize].push(e as u32);
            is_rigid[*unit as usize] &= model.materials[mesh.material[e] as usize].rigid;
        }
        let fit = fit_nodes(model, dofs, springs, ties);
        let mut found = Self {
            body_of: vec![NONE; mesh.nodes.len()],
            ..Self::default()
        };
        for (elements, is_rigid) in elements.into_iter().zip(is_rigid) {
            if !is_rigid || elements.is_empty() {
                continue;
            }
            let body = Body::of(mesh, dofs, elements);
            let fits = |body: &Body| body.shown.iter().all(|at| fit[at.node as usize]);
            if let Some(body) = body.filter(fits) {
                for at in &body.shown {
                    found.body_of[at.node as usize] = found.bodies.len() as u32;
                }
                found.bodies.push(body);
            }
        }
        for image in &mesh.reflected {
            let [node, of] = [image.node, image.of].map(|n| n as usize);
            if found.body_of[node] == NONE && found.body_of[of] != NONE {
                found.body_of[node] = found.body_of[of];
                found.facing.push(*image);
            }
        }
        found
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.bodies.is_empty()
    }

    /// Number of bodies.
    pub fn len(&self) -> usize {
        self.bodies.len()
    }

    /// Sets the treatment of forces whose arms turn: exact, or the symmetric part of their stiffness.
    pub(super) fn set_turning(&mut self, turning: Turning) {
        self.unsymmetric = turning == Turning::Exact;
    }

    /// Elements of all bodies.
    pub(super) fn elements(&self) -> impl Iterator<Item = usize> {
        let all = self.bodies.iter().flat_map(|body| &body.elements);
        all.map(|e| *e as usize)
    }

    /// Moves the nodes of each body to the rigid pose nearest to their displacements `q` [mm]. `[slot]`
    pub(crate) fn straighten(&self, dofs: &DofMap, q: &mut [f64]) {
        let of_node = |n: u32, q: &[f64]| {
            dofs.slot[n as usize].map(|s| if s == HELD { 0.0 } else { q[s as usize] })
        };
        let before: &[f64] = q;
        let poses: Vec<_> = (self.bodies.par_iter().with_min_len(64))
            .map(|body| body.straightened(|n| of_node(n, before)))
            .collect();
        for (body, pose) in self.bodies.iter().zip(poses) {
            for (n, u) in body.nodes.iter().zip(pose.into_iter().flatten()) {
                for (slot, u) in dofs.slot[*n as usize].into_iter().zip(u) {
                    if slot != HELD {
                        q[slot as usize] = u;
                    }
                }
            }
        }
    }

    /// Replaces the out-of-balance forces [N] `[equation]` on the nodes of each body by those of its resultant, at
    /// positions `x` [mm] `[node]`. The other part is carried by the body.
    pub(crate) fn project(
        &self,
        dofs: &DofMap,
        equations: &Equations,
        x: &[[f64; 3]],
        residual: &mut [f64],
    ) {
        let of = |n: u32| dofs.slot[n as usize].map(|s| equation(equations, s));
        let before: &[f64] = residual;
        let projected = |body: &Body| {
            let centre = body.centre_at(x);
            let nodes = body.nodes.iter();
            let arms: Vec<_> = nodes
                .map(|n| Vector3::from(x[*n as usize]) - centre)
                .collect();
            let value = |n: &u32| Vector3::from(of(*n).map(|e| e.map_or(0.0, |e| before[e])));
            let mut values: Vec<_> = body.nodes.iter().map(value).collect();
            body.project(&arms, &mut values);
            values
        };
        let bodies = self.bodies.par_iter().with_min_len(64);
        let values: Vec<_> = bodies.map(projected).collect();
        for (body, values) in self.bodies.iter().zip(values) {
            for (n, value) in body.nodes.iter().zip(&values) {
                for (e, value) in of(*n).into_iter().zip(value.iter()) {
                    if let Some(e) = e {
                        residual[e] = *value;
                    }
                }
            }
        }
    }

    /// Writes to the elements of each body the nodal forces that balance those of joints, which are in
    /// `trial.node_force` [N]: the forces that the body carries.
    pub(super) fn show_forces(&self, trial: &mut Trial) {
        for body in &self.bodies {
            for at in &body.shown {
                let force = trial.node_force[at.node as usize].map(|f| -f);
                *at.to(&mut trial.cells.force) = force;
            }
        }
    }
}

/// Equation of a slot, if it is an unknown.
fn equation(equations: &Equations, slot: u32) -> Option<usize> {
    let of = equations.of_slot.get(slot as usize).copied();
    of.filter(|e| *e != PRESCRIBED).map(|e| e as usize)
}

/// Nodes that a rigid body may have: they belong to one unit, move by slots of their own, lie in no section, and carry
/// no spring, tie or controlling probe.
fn fit_nodes(model: &Model, dofs: &DofMap, springs: &Springs, ties: &Ties) -> Vec<bool> {
    let mesh = &model.mesh;
    let mut fit = vec![true; mesh.nodes.len()];
    let mut unit_of = vec![NONE; mesh.nodes.len()];
    for (nodes, unit) in mesh.elements.iter().zip(&mesh.unit) {
        for n in nodes {
            let known = &mut unit_of[*n as usize];
            fit[*n as usize] &= *known == NONE || known == unit;
            *known = *unit;
        }
    }
    for (fit, slots) in fit.iter_mut().zip(&dofs.slot) {
        *fit &= slots
            .iter()
            .all(|s| *s == HELD || (*s as usize) < dofs.beam_start);
    }
    for section in &model.sections {
        let nodes = |e: &u32| mesh.elements[*e as usize];
        let below: FxHashSet<u32> = section.below.iter().flat_map(nodes).collect();
        for n in section.above.iter().flat_map(nodes) {
            fit[n as usize] &= !below.contains(&n);
        }
    }
    let cells = springs
        .cells()
        .iter()
        .chain(ties.cells())
        .flatten()
        .copied();
    let controls = model.steps.iter().filter_map(|step| step.control);
    let probes = controls.map(|control| &model.probes[control.probe]);
    let probes = probes.flat_map(|probe| probe.nodes.iter().chain(&probe.minus).copied());
    for n in cells.chain(probes) {
        fit[n as usize] = false;
    }
    fit
}
