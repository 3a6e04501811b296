//! Stiffness-proportional damping of the solids: forces b R K̄₀ Rᵀ v in the rotating frame of the element
//! (theory/inertia.md, eq. 8).
//!
//! K̄₀ is the initial elastic stiffness of the element, so cracking does not reduce the damping and a rigid
//! rotation causes no damping. Joints have no damping: b times their penalty stiffness would glue them.

use rayon::prelude::*;

use super::pattern::CELL;
use super::{System, Trial};
use crate::element::Corotated;

/// Damping of one evaluation and its working arrays.
#[derive(Clone, Debug, Default)]
pub struct StiffnessDamping {
    /// b [s].
    pub factor: f64,
    velocity: Vec<[f64; 3]>,
    element_force: Vec<[[f64; 3]; 8]>,
    node_force: Vec<[f64; 3]>,
}

impl StiffnessDamping {
    /// Damping b K₀.
    pub fn new(factor: f64) -> Self {
        Self {
            factor,
            ..Self::default()
        }
    }

    /// Writes the forces `[slot]` [N] at the trial's positions and generalised velocities `[slot]` [mm/s] to
    /// `force`. With `by_displacement` = ∂v/∂u [1/s] the stiffness b ∂v/∂u K₀ is added to that of the trial's
    /// elements; the rotation of the frame is left out.
    ///
    /// The trial must have been evaluated at these positions. An inverted element has no damping.
    pub fn evaluate(
        &mut self,
        system: &System,
        trial: &mut Trial,
        velocity: &[f64],
        by_displacement: Option<f64>,
        force: &mut [f64],
    ) {
        let bulk = &system.bulk;
        let n = bulk.elements.len();
        self.velocity.resize(bulk.reference.len(), [0.0; 3]);
        system.dofs.spread(velocity, &mut self.velocity);
        self.element_force.resize(n, [[0.0; 3]; 8]);
        if trial.cells.stiffness.len() < n * CELL {
            trial.cells.stiffness.resize(n * CELL, 0.0);
        }
        if by_displacement.is_some() {
            trial.cells.held.forget_solids();
            trial.cells.changed.clear();
        }
        let (x, v, b) = (&trial.x, &self.velocity, self.factor);
        self.element_force
            .par_iter_mut()
            .zip(trial.cells.stiffness[..n * CELL].par_chunks_exact_mut(CELL))
            .enumerate()
            .with_min_len(16)
            .for_each(|(e, (force, cell))| {
                *force = [[0.0; 3]; 8];
                if bulk.is_rigid(e) {
                    return;
                }
                let (shape, nodes) = (bulk.shape(e), bulk.elements[e]);
                let Ok(frame) = Corotated::new(shape, &nodes.map(|n| x[n as usize])) else {
                    return;
                };
                let (k, r) = (shape.elastic_stiffness(), frame.rotation);
                for (a, force) in force.iter_mut().enumerate() {
                    for (c, &node) in nodes.iter().enumerate() {
                        let local = nalgebra::Matrix3::from_fn(|i, j| k[a][i][j][c]);
                        let block = r * local * r.transpose() * b;
                        let v = v[node as usize];
                        for i in 0..3 {
                            force[i] += (0..3).map(|j| block[(i, j)] * v[j]).sum::<f64>();
                        }
                        if let Some(factor) = by_displacement {
                            let to = &mut cell[(a * 8 + c) * 9..][..9];
                            for i in 0..3 {
                                for j in 0..3 {
                                    to[3 * i + j] += factor * block[(i, j)];
                                }
                            }
                        }
                    }
                }
            });
        // Nodal sums in element order.
        self.node_force.clear();
        self.node_force.resize(bulk.reference.len(), [0.0; 3]);
        for (nodes, force) in bulk.elements.iter().zip(&self.element_force) {
            for (&n, f) in nodes.iter().zip(force) {
                for i in 0..3 {
                    self.node_force[n as usize][i] += f[i];
                }
            }
        }
        system.dofs.collect(&self.node_force, force);
    }
}
