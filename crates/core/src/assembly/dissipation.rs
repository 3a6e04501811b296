//! Work and dissipation of an increment. The dissipation is also a linear measure of the next increment
//! (`solve::path`).

use super::{System, Trial};

impl System {
    /// Work of the internal forces of an increment: Σ |f·Δu| over the elements, contact cells and ties [N mm]. `trial`
    /// ends the increment, `dq` is its displacement [mm] `[slot]`. Rigid motion does no work.
    pub fn work_turned_over(&self, trial: &Trial, dq: &[f64]) -> f64 {
        let mut way = vec![[0.0; 3]; self.bulk.reference.len()];
        self.dofs.spread(dq, &mut way);
        let cells = self.loaded_cells().zip(&trial.cells.force);
        let of_cells = cells.map(|(nodes, force)| work(nodes, force, &way).abs());
        of_cells.sum::<f64>() + self.ties.work_turned_over(&trial.ties.segments, &way)
    }

    /// Forces of the solids on their nodes [N]. In equilibrium they are opposite to those of joints, loads, springs and
    /// supports there. `[node]`
    pub fn forces_on_solids(&self, trial: &Trial) -> Vec<[f64; 3]> {
        let mut forces = vec![[0.0; 3]; self.bulk.reference.len()];
        for (nodes, force) in self.bulk.elements.iter().zip(&trial.cells.force) {
            for (&n, f) in nodes.iter().zip(force) {
                for i in 0..3 {
                    forces[n as usize][i] += f[i];
                }
            }
        }
        forces
    }

    /// Gradient c with c·Δq = dissipation of the elements and facets in the increment that `trial` ends [N].
    /// `[slot]`
    ///
    /// `dq` is the displacement of that increment [mm] `[slot]`. A cell with nodal forces f that dissipated D over
    /// the nodal displacements Δu contributes c = D/(f·Δu) f (theory/procedures.md, eq. 5).
    pub fn dissipation_gradient(&self, trial: &Trial, dq: &[f64]) -> Vec<f64> {
        let nodes = self.bulk.reference.len();
        let mut way = vec![[0.0; 3]; nodes];
        self.dofs.spread(dq, &mut way);
        let mut gradient = vec![[0.0; 3]; nodes];
        let n = self.bulk.elements.len();
        let mut add = |dissipated: f64, cells: &mut dyn Iterator<Item = (&[u32; 8], usize)>| {
            if dissipated.is_nan() || dissipated <= 0.0 {
                return;
            }
            let cells: Vec<_> = cells.collect();
            let power: f64 = cells
                .iter()
                .map(|(nodes, c)| work(nodes, &trial.cells.force[*c], &way))
                .sum();
            if power.is_nan() || power <= 0.0 {
                return;
            }
            for (nodes, c) in cells {
                for (&node, f) in nodes.iter().zip(&trial.cells.force[c]) {
                    for i in 0..3 {
                        gradient[node as usize][i] += dissipated / power * f[i];
                    }
                }
            }
        };
        for (e, (nodes, energy)) in self
            .bulk
            .elements
            .iter()
            .zip(&trial.solids.energy)
            .enumerate()
        {
            add(
                energy.plastic_damage + energy.viscous,
                &mut std::iter::once((nodes, e)),
            );
        }
        for (facet, points) in trial.joints.energy.chunks_exact(4).enumerate() {
            let dissipated = points.iter().map(|p| p[1]).sum();
            let mut cells = self.contact.cells_of(facet).map(|(c, cell)| (cell, n + c));
            add(dissipated, &mut cells);
        }
        let mut slots = vec![0.0; self.dofs.slots];
        self.dofs.collect(&gradient, &mut slots);
        slots
    }
}

/// Work f·Δu of the eight nodes of a cell.
fn work(nodes: &[u32; 8], force: &[[f64; 3]; 8], way: &[[f64; 3]]) -> f64 {
    nodes
        .iter()
        .zip(force)
        .map(|(&n, f)| {
            let u = way[n as usize];
            f[0] * u[0] + f[1] * u[1] + f[2] * u[2]
        })
        .sum()
}
