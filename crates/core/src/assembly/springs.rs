//! Springs from groups of nodes to the ground: force k (e − ū) on the mean displacement ū of the group, shared
//! equally.
//!
//! A group of n nodes couples all its nodes by blocks k/n². The coupling is divided into cells of eight nodes
//! like those of elements: four nodes with another four, or with themselves. Unused places of a cell repeat a
//! node and stay zero.

use super::pattern::CELL;
use crate::model::Model;

/// Nodes of half a cell.
const HALF: usize = 4;

/// One cell: its spring and the number of nodes used in each half.
#[derive(Clone, Copy, Debug)]
struct Part {
    spring: usize,
    rows: usize,
    /// 0 where the four nodes couple with themselves.
    columns: usize,
}

/// Springs of a model.
#[derive(Clone, Debug, Default)]
pub struct Springs {
    nodes: Vec<Vec<u32>>,
    stiffness: Vec<[f64; 3]>,
    cells: Vec<[u32; 8]>,
    parts: Vec<Part>,
}

impl Springs {
    /// Prepares the springs of a model.
    pub fn new(model: &Model) -> Self {
        let mut springs = Self::default();
        for (s, spring) in model.springs.iter().enumerate() {
            if spring.nodes.is_empty() {
                continue;
            }
            let groups: Vec<&[u32]> = spring.nodes.chunks(HALF).collect();
            for (i, first) in groups.iter().enumerate() {
                for (j, second) in groups.iter().enumerate().skip(i) {
                    let mut cell = [first[0]; 8];
                    cell[..first.len()].copy_from_slice(first);
                    let columns = if i == j { 0 } else { second.len() };
                    cell[HALF..HALF + columns].copy_from_slice(&second[..columns]);
                    springs.cells.push(cell);
                    springs.parts.push(Part {
                        spring: s,
                        rows: first.len(),
                        columns,
                    });
                }
            }
        }
        for spring in &model.springs {
            springs.nodes.push(spring.nodes.clone());
            springs.stiffness.push(spring.stiffness);
        }
        springs
    }

    /// Replaces the stiffnesses [N/mm] `[spring][xyz]`. Returns the former ones.
    pub fn stiffen(&mut self, stiffness: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
        std::mem::replace(&mut self.stiffness, stiffness)
    }

    /// Cells of eight nodes.
    pub fn cells(&self) -> &[[u32; 8]] {
        &self.cells
    }

    /// Force of each spring on its nodes at nodal displacements `u` [mm] and ends `ends` [mm] [N].
    /// `[spring][xyz]`
    pub fn forces<'a>(
        &'a self,
        u: &'a [[f64; 3]],
        ends: &'a [[f64; 3]],
    ) -> impl Iterator<Item = [f64; 3]> + 'a {
        let springs = self.nodes.iter().zip(&self.stiffness).zip(ends);
        springs.map(|((nodes, stiffness), end)| {
            let count = nodes.len().max(1) as f64;
            [0, 1, 2].map(|i| {
                let mean = nodes.iter().map(|&n| u[n as usize][i]).sum::<f64>() / count;
                stiffness[i] * (end[i] - mean)
            })
        })
    }

    /// Forces of the springs on their nodes, as of [`Self::forces`], by node [N].
    pub fn nodal_forces<'a>(
        &'a self,
        u: &'a [[f64; 3]],
        ends: &'a [[f64; 3]],
    ) -> impl Iterator<Item = (u32, [f64; 3])> + 'a {
        let springs = self.nodes.iter().zip(self.forces(u, ends));
        springs.flat_map(|(nodes, force)| {
            let share = force.map(|f| f / nodes.len().max(1) as f64);
            nodes.iter().map(move |n| (*n, share))
        })
    }

    /// Adds the internal forces of the springs to those of the nodes [N].
    pub fn add_forces(&self, u: &[[f64; 3]], ends: &[[f64; 3]], node_force: &mut [[f64; 3]]) {
        for (n, share) in self.nodal_forces(u, ends) {
            for i in 0..3 {
                node_force[n as usize][i] -= share[i];
            }
        }
    }

    /// Writes the stiffness of all cells [N/mm]. `[cell][CELL]`
    pub fn write_stiffness(&self, cells: &mut [f64]) {
        cells.fill(0.0);
        for (cell, part) in cells.chunks_exact_mut(CELL).zip(&self.parts) {
            let count = self.nodes[part.spring].len() as f64;
            let k = self.stiffness[part.spring].map(|k| k / (count * count));
            let mut block = |a: usize, b: usize| {
                for i in 0..3 {
                    cell[(a * 8 + b) * 9 + 4 * i] = k[i];
                }
            };
            for a in 0..part.rows {
                if part.columns == 0 {
                    (0..part.rows).for_each(|b| block(a, b));
                }
                for b in HALF..HALF + part.columns {
                    block(a, b);
                    block(b, a);
                }
            }
        }
    }

    /// Elastic energy ½ f²/k of each spring under its force [N mm].
    pub fn energy(&self, forces: impl Iterator<Item = [f64; 3]>) -> f64 {
        let springs = self.stiffness.iter().zip(forces);
        springs
            .map(|(k, f)| {
                let along = (0..3).filter(|&i| k[i] > 0.0);
                along.map(|i| 0.5 * f[i] * f[i] / k[i]).sum::<f64>()
            })
            .sum()
    }
}
