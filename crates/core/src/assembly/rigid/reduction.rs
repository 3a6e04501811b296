//! Linear equations in the unknowns of rigid bodies: K' = Jᵀ K J, r' = Jᵀ r, d = J d' (theory/rigid-bodies.md, eqs 3
//! to 6).
//!
//! In the matrix a body is two nodes, which stand for its translation and for its rotation. Cells of joints are
//! carried over to these nodes, so that pattern, order and factorisation are those of any other matrix.

use nalgebra::{Matrix3, SMatrix, Vector3};
use rayon::prelude::*;

use super::body::Body;
use super::{NONE, RigidBodies, equation};
use crate::assembly::dofs::{DofMap, Equations, HELD};
use crate::assembly::mass::Mass;
use crate::assembly::pattern::{CELL, Gather};
use crate::assembly::trial::Trial;

/// Linear equations of a step in the unknowns of the bodies.
#[derive(Debug)]
pub(in crate::assembly) struct Reduction {
    /// Slots of the matrix: those of all other nodes, of the two nodes of each body, and of beams.
    pub(in crate::assembly) dofs: DofMap,
    /// Equations of the matrix.
    pub(in crate::assembly) equations: Equations,
    /// Cells on the nodes of the matrix.
    pub(in crate::assembly) cells: Vec<[u32; 8]>,
    /// The cells before.
    own_cells: Vec<[u32; 8]>,
    /// Slots before that belong to no body, and those of the matrix.
    slots: Vec<(u32, u32)>,
    /// Places in the reduced cell of the nodes of each cell. `[cell][node]`
    places: Vec<[Place; 8]>,
    /// Equations of nodes that belong to no body: (own, of the matrix).
    kept: Vec<(u32, u32)>,
    /// Equations of translation and rotation of each body. `[body][6]`
    of_body: Vec<[Option<usize>; 6]>,
    /// Arms of the nodes of the bodies at the last filling, over the radius of the body [-]. `[node]`
    arms: Vec<Vector3<f64>>,
    /// Signs of the motion of images that face their body, 1 elsewhere. Empty without such images. `[node]`
    signs: Vec<Vector3<f64>>,
    /// Stiffness of the reduced cells [N/mm]. `[cell][CELL]`
    stiffness: Vec<f64>,
    /// Whether a reduced cell contributes. `[cell]`
    active: Vec<bool>,
}

/// Place of a node in a reduced cell.
#[derive(Clone, Copy, Debug)]
enum Place {
    /// It stays a node.
    Node(u8),
    /// It belongs to a body, whose rotation follows its translation.
    Body(u8),
}

impl RigidBodies {
    /// Numbers the unknowns of the bodies and carries `cells` over to them.
    pub(in crate::assembly) fn reduce(
        &mut self,
        dofs: &DofMap,
        equations: &Equations,
        cells: &[[u32; 8]],
    ) -> &Reduction {
        let hosts: Vec<[u32; 2]> = (self.bodies.iter())
            .map(|body| [body.nodes[0], body.nodes[1]])
            .collect();
        let free = |body: &Body| match body.plane {
            None => [[true; 3]; 2],
            Some(axis) => [[0, 1, 2].map(|i| i != axis), [0, 1, 2].map(|i| i == axis)],
        };
        let free: Vec<_> = self.bodies.iter().map(free).collect();
        let own = dofs.with_bodies(&self.body_of, &hosts, &free);
        let of_matrix = equations.with_bodies(dofs, &own.dofs);
        let mut kept = Vec::new();
        for (slot, new) in &own.slots {
            let before = equation(equations, *slot);
            let after = equation(&of_matrix, *new);
            if let (Some(before), Some(after)) = (before, after) {
                kept.push((before as u32, after as u32));
            }
        }
        let of_body = hosts.iter().map(|hosts| {
            let slots = hosts.map(|n| own.dofs.slot[n as usize]);
            let mut of = [None; 6];
            for (of, slot) in of.iter_mut().zip(slots.as_flattened()) {
                *of = equation(&of_matrix, *slot);
            }
            of
        });
        let mut reduction = Reduction {
            of_body: of_body.collect(),
            kept,
            arms: vec![Vector3::zeros(); self.body_of.len()],
            signs: self.signs(),
            cells: Vec::with_capacity(cells.len()),
            places: Vec::with_capacity(cells.len()),
            stiffness: vec![0.0; cells.len() * CELL],
            active: vec![false; cells.len()],
            own_cells: cells.to_vec(),
            slots: own.slots,
            dofs: own.dofs,
            equations: of_matrix,
        };
        let nowhere = self.body_of.len() as u32;
        for cell in cells {
            let (reduced, places) = self.carried(cell, &hosts, nowhere);
            reduction.cells.push(reduced);
            reduction.places.push(places);
        }
        // The first cell of a body carries the stiffness of its turning forces; its other elements have none.
        for (body, [first, second]) in self.bodies.iter().zip(&hosts) {
            for e in &body.elements {
                reduction.cells[*e as usize] = [nowhere; 8];
            }
            let cell = &mut reduction.cells[body.elements[0] as usize];
            (cell[0], cell[1]) = (*first, *second);
        }
        self.reduction.insert(reduction)
    }

    /// Signs of the motion of images that face their body. Empty without such images. `[node]`
    fn signs(&self) -> Vec<Vector3<f64>> {
        if self.facing.is_empty() {
            return Vec::new();
        }
        let mut signs = vec![Vector3::repeat(1.0); self.body_of.len()];
        for image in &self.facing {
            signs[image.node as usize] = image.sign.into();
        }
        signs
    }

    /// A cell on the nodes of the matrix, and the places of its nodes there.
    fn carried(&self, cell: &[u32; 8], hosts: &[[u32; 2]], nowhere: u32) -> ([u32; 8], [Place; 8]) {
        let (mut reduced, mut count) = ([nowhere; 8], 0);
        let places = cell.map(|n| {
            let body = self.body_of[n as usize];
            let nodes: &[u32] = match hosts.get(body as usize) {
                Some(hosts) => hosts,
                None => &[n],
            };
            let known = reduced[..count].iter().position(|of| *of == nodes[0]);
            let at = known.unwrap_or_else(|| {
                for n in nodes {
                    reduced[count] = *n;
                    count += 1;
                }
                count - nodes.len()
            });
            if body == NONE {
                Place::Node(at as u8)
            } else {
                Place::Body(at as u8)
            }
        });
        (reduced, places)
    }

    /// Linear equations, once the matrix was analysed.
    pub(in crate::assembly) fn reduction(&self) -> Option<&Reduction> {
        self.reduction.as_ref()
    }

    /// Fills the matrix from the cells of a trial. `changed`: cells that changed since the last filling, all if none.
    pub(in crate::assembly) fn fill(
        &mut self,
        gather: &Gather,
        trial: &Trial,
        changed: Option<&[bool]>,
        values: &mut [f64],
    ) {
        let Some(reduction) = &mut self.reduction else {
            return;
        };
        for body in &self.bodies {
            let centre = body.centre_at(&trial.x);
            for at in &body.shown {
                let arm = Vector3::from(trial.x[at.node as usize]) - centre;
                reduction.arms[at.node as usize] = arm / body.radius;
            }
        }
        for image in &self.facing {
            reduction.arms[image.node as usize] = reduction.arms[image.of as usize];
        }
        let cells = &trial.cells;
        reduction.active.clone_from(&cells.active);
        let (arms, signs) = (&reduction.arms, &reduction.signs);
        (reduction.stiffness.par_chunks_exact_mut(CELL))
            .zip(&reduction.places)
            .zip(&reduction.own_cells)
            .enumerate()
            .with_min_len(32)
            .filter(|(c, _)| cells.active[*c] && changed.is_none_or(|changed| changed[*c]))
            .for_each(|(c, ((to, places), nodes))| {
                let of_nodes = Carried {
                    places,
                    arms: nodes.map(|n| arms[n as usize]),
                    signs: (!signs.is_empty())
                        .then(|| nodes.map(|n| signs[n as usize]))
                        .filter(|own| own.iter().any(|sign| sign.min() < 0.0)),
                };
                of_nodes.carry(&cells.stiffness[c * CELL..(c + 1) * CELL], to);
            });
        let mut changed = changed.map(<[bool]>::to_vec);
        for body in &self.bodies {
            let e = body.elements[0] as usize;
            let cell = &mut reduction.stiffness[e * CELL..(e + 1) * CELL];
            cell.fill(0.0);
            let mut turning = body.turning(&reduction.arms, &cells.force);
            if !self.unsymmetric {
                turning = 0.5 * (turning + turning.transpose());
            }
            add(cell, 1, 1, &turning);
            reduction.active[e] = true;
            if let Some(changed) = &mut changed {
                changed[e] = true;
            }
        }
        gather.fill(
            &reduction.stiffness,
            &reduction.active,
            changed.as_deref(),
            values,
        );
    }

    /// Forces on the unknowns of the matrix, Jᵀ r [N], from forces on the equations of the nodes.
    pub(crate) fn gathered(
        &self,
        dofs: &DofMap,
        equations: &Equations,
        forces: &[f64],
    ) -> Vec<f64> {
        let Some(reduction) = &self.reduction else {
            return forces.to_vec();
        };
        let mut gathered = vec![0.0; reduction.equations.len()];
        for (from, to) in &reduction.kept {
            gathered[*to as usize] = forces[*from as usize];
        }
        for (body, of) in self.bodies.iter().zip(&reduction.of_body) {
            let (mut sum, mut moment) = (Vector3::zeros(), Vector3::zeros());
            for n in &body.nodes {
                let of_node = dofs.slot[*n as usize].map(|s| equation(equations, s));
                let force = Vector3::from(of_node.map(|e| e.map_or(0.0, |e| forces[e])));
                sum += force;
                moment += reduction.arms[*n as usize].cross(&force);
            }
            for (e, force) in of.iter().zip(sum.iter().chain(moment.iter())) {
                if let Some(e) = e {
                    gathered[*e] = *force;
                }
            }
        }
        gathered
    }

    /// Displacements of the nodes, J d' [mm], from those of the unknowns of the matrix. `[equation]`
    pub(crate) fn scattered(
        &self,
        dofs: &DofMap,
        equations: &Equations,
        moved: &[f64],
    ) -> Vec<f64> {
        let Some(reduction) = &self.reduction else {
            return moved.to_vec();
        };
        let mut scattered = vec![0.0; equations.len()];
        for (to, from) in &reduction.kept {
            scattered[*to as usize] = moved[*from as usize];
        }
        for (body, of) in self.bodies.iter().zip(&reduction.of_body) {
            let of = of.map(|e| e.map_or(0.0, |e| moved[e]));
            let way = Vector3::new(of[0], of[1], of[2]);
            let turn = Vector3::new(of[3], of[4], of[5]);
            for n in &body.nodes {
                let u = way + turn.cross(&reduction.arms[*n as usize]);
                for (slot, u) in dofs.slot[*n as usize].into_iter().zip(u.iter()) {
                    if let Some(e) = equation(equations, slot) {
                        scattered[e] = *u;
                    }
                }
            }
        }
        scattered
    }

    /// Adds `factor` times coefficients of the nodes' slots to the matrix, Jᵀ diag(c) J. `coefficients`: `[slot]`
    pub(in crate::assembly) fn add_diagonal(
        &self,
        gather: &Gather,
        dofs: &DofMap,
        factor: f64,
        coefficients: &[f64],
        values: &mut [f64],
    ) {
        let Some(reduction) = &self.reduction else {
            return;
        };
        for (own, new) in &reduction.slots {
            if let Some(e) = equation(&reduction.equations, *new) {
                let value = factor * coefficients[*own as usize];
                gather.add(e, e, value, values);
            }
        }
        for (body, of) in self.bodies.iter().zip(&reduction.of_body) {
            let mut sum = SMatrix::<f64, 6, 6>::zeros();
            for n in &body.nodes {
                let motion = reduction.motion(*n);
                for (i, slot) in dofs.slot[*n as usize].into_iter().enumerate() {
                    if slot != HELD {
                        let row = motion.row(i);
                        sum += coefficients[slot as usize] * row.transpose() * row;
                    }
                }
            }
            add_body(gather, of, &(factor * sum), values);
        }
    }

    /// Equations of the matrix of the slots that belong to no body. `[slot]`
    pub(in crate::assembly) fn equations_of(&self, slots: usize) -> Vec<Option<usize>> {
        let mut of = vec![None; slots];
        if let Some(reduction) = &self.reduction {
            for (own, new) in &reduction.slots {
                of[*own as usize] = equation(&reduction.equations, *new);
            }
        }
        of
    }

    /// Adds `factor` times the masses that couple the nodes of each body, Jᵀ M J.
    pub(in crate::assembly) fn add_coupling(
        &self,
        gather: &Gather,
        factor: f64,
        mass: &Mass,
        values: &mut [f64],
    ) {
        let Some(reduction) = &self.reduction else {
            return;
        };
        for (body, of) in self.bodies.iter().zip(&reduction.of_body) {
            let mut sum = SMatrix::<f64, 6, 6>::zeros();
            for e in &body.elements {
                mass.each_coupling_of(*e as usize, |nodes, coupling| {
                    let [a, b] = nodes.map(|n| reduction.motion(n as u32));
                    sum += coupling * (a.transpose() * b);
                });
            }
            add_body(gather, of, &(factor * sum), values);
        }
    }
}

impl Reduction {
    /// Motion of a body's node for motions of the body: δ + θ × a, the rows of J. `[xyz][6]`
    fn motion(&self, node: u32) -> SMatrix<f64, 3, 6> {
        let skew = -self.arms[node as usize].cross_matrix();
        SMatrix::from_fn(|i, j| match j {
            0..3 => f64::from(u8::from(i == j)),
            _ => skew[(i, j - 3)],
        })
    }
}

/// Adds a matrix of the unknowns of a body, whose equations are `of`.
fn add_body(
    gather: &Gather,
    of: &[Option<usize>; 6],
    block: &SMatrix<f64, 6, 6>,
    values: &mut [f64],
) {
    for (i, row) in of.iter().enumerate() {
        for (j, column) in of.iter().enumerate() {
            if let (Some(row), Some(column)) = (row, column) {
                gather.add(*row, *column, block[(i, j)], values);
            }
        }
    }
}

/// How the nodes of a cell move with the unknowns of its reduced cell.
struct Carried<'a> {
    places: &'a [Place; 8],
    /// Arms of the nodes that belong to bodies, over the radius of the body [-].
    arms: [Vector3<f64>; 8],
    /// Signs of their motion, if some are images.
    signs: Option<[Vector3<f64>; 8]>,
}

impl Carried<'_> {
    /// Carries the stiffness of the cell over to its reduced cell. A node at arm a moves by δ + θ × a, so that its
    /// block k contributes k, −k A, A k, −A k A with A = [a]×. The block of images is S k S.
    fn carry(&self, from: &[f64], to: &mut [f64]) {
        to.fill(0.0);
        let skew = self.arms.map(|arm| arm.cross_matrix());
        for a in 0..8 {
            // Columns first: the row of blocks on the unknowns of the matrix.
            let mut row = [Matrix3::zeros(); 8];
            for b in 0..8 {
                let mut k = Matrix3::from_row_slice(&from[(a * 8 + b) * 9..][..9]);
                if let Some(signs) = &self.signs {
                    k.component_mul_assign(&(signs[a] * signs[b].transpose()));
                }
                match self.places[b] {
                    Place::Node(at) => row[at as usize] += k,
                    Place::Body(at) => {
                        row[at as usize] += k;
                        row[at as usize + 1] -= k * skew[b];
                    }
                }
            }
            for (column, k) in row.iter().enumerate() {
                match self.places[a] {
                    Place::Node(at) => add(to, at as usize, column, k),
                    Place::Body(at) => {
                        add(to, at as usize, column, k);
                        add(to, at as usize + 1, column, &(skew[a] * k));
                    }
                }
            }
        }
    }
}

/// Adds a block to a cell.
fn add(cell: &mut [f64], row: usize, column: usize, block: &Matrix3<f64>) {
    let to = &mut cell[(row * 8 + column) * 9..][..9];
    for i in 0..3 {
        for j in 0..3 {
            to[3 * i + j] += block[(i, j)];
        }
    }
}
