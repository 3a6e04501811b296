//! Stiffness along the displacement that controls a load. It supports motion in the matrix that only this
//! displacement prevents (theory/procedures.md, eq. 6).
//!
//! With c·Δq = s prescribed, the iterates d of K d = −r − δλ ∂r/∂λ that satisfy this constraint are those of
//!
//! ```text
//! (K + α c cᵀ) d = −r − δλ ∂r/∂λ + α c (s − c·Δq)
//! ```
//!
//! for any α, because α c (c·d) stands on both sides. Secant tangents have no geometric stiffness. Two halves of a
//! wall that rock about their hinges then have no stiffness, and K alone would be singular.

use std::collections::BTreeMap;

use super::pattern::CELL;
use crate::model::Model;
use crate::model::scene::Control;

/// Nodes of half a cell.
const HALF: usize = 4;
/// Largest number of nodes of a probe. With more, the stiffness would couple too many nodes and is left out.
const MOST: usize = 64;

/// Stiffness of one step.
#[derive(Clone, Debug)]
pub struct Steered {
    /// α [N/mm].
    pub stiffness: f64,
    /// Direction of the displacement, of length 1. `[xyz]`
    direction: [f64; 3],
    /// Weights c of the nodes.
    weights: Vec<(u32, f64)>,
    cells: Vec<[u32; 8]>,
    /// Halves of each cell, as indices of groups in `weights`.
    halves: Vec<[usize; 2]>,
}

impl Steered {
    /// Stiffness for a step with control by a displacement. None for a probe with very many nodes.
    pub fn new(model: &Model, control: Control) -> Option<Self> {
        let probe = &model.probes[control.probe];
        let mut weights: BTreeMap<u32, f64> = BTreeMap::new();
        for (n, weight) in probe.weights() {
            *weights.entry(n).or_default() += weight;
        }
        let weights: Vec<(u32, f64)> = weights.into_iter().collect();
        if weights.is_empty() || weights.len() > MOST {
            return None;
        }
        let groups: Vec<&[(u32, f64)]> = weights.chunks(HALF).collect();
        let (mut cells, mut halves) = (Vec::new(), Vec::new());
        for i in 0..groups.len() {
            for j in i..groups.len() {
                let mut cell = [groups[i][0].0; 8];
                for (half, group) in [i, j].into_iter().enumerate() {
                    for (a, (n, _)) in groups[group].iter().enumerate() {
                        cell[HALF * half + a] = *n;
                    }
                }
                cells.push(cell);
                halves.push([i, j]);
            }
        }
        // α = E h of an element at the probe, comparable to the stiffness of its surroundings.
        let (mesh, node) = (&model.mesh, weights[0].0);
        let element = mesh.elements.iter().position(|e| e.contains(&node))?;
        let material = &model.materials[mesh.material[element] as usize].parameters;
        Some(Self {
            stiffness: material.elastic().E * mesh.volume(element).cbrt(),
            direction: probe.direction,
            weights,
            cells,
            halves,
        })
    }

    /// Cells of eight nodes.
    pub fn cells(&self) -> &[[u32; 8]] {
        &self.cells
    }

    /// Writes α c cᵀ into the cells [N/mm]. `[cell][CELL]`
    pub fn write(&self, cells: &mut [f64]) {
        cells.fill(0.0);
        let group = |g: usize| self.weights.chunks(HALF).nth(g).unwrap_or_default();
        for (cell, &[i, j]) in cells.chunks_exact_mut(CELL).zip(&self.halves) {
            // A group with itself fills the first quarter of the cell, two groups the second and third.
            let column = if i == j { 0 } else { HALF };
            for (a, (_, first)) in group(i).iter().enumerate() {
                for (b, (_, second)) in group(j).iter().enumerate() {
                    let value = self.stiffness * first * second;
                    let n = self.direction;
                    let mut add = |a: usize, b: usize| {
                        for (ij, entry) in cell[(a * 8 + b) * 9..][..9].iter_mut().enumerate() {
                            *entry = value * n[ij / 3] * n[ij % 3];
                        }
                    };
                    add(a, column + b);
                    if i != j {
                        add(column + b, a);
                    }
                }
            }
        }
    }
}
