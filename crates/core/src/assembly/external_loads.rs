//! Named loads: their nodal forces, and the stiffness of follower pressures, whose direction turns with their
//! facets.
//!
//! The stiffness −∂F/∂x of a follower pressure is a cell of its facet's four nodes. The other four places of the
//! cell repeat the first node and stay zero.

use super::pattern::CELL;
use crate::element::facet;
use crate::model::Model;
use crate::model::loads::LoadOn;

/// Loads of a model.
#[derive(Clone, Debug, Default)]
pub struct ExternalLoads {
    /// Action of each load. `[load]`
    acts: Vec<LoadOn>,
    /// Facets under follower pressure.
    facets: Vec<Pressed>,
    cells: Vec<[u32; 8]>,
}

/// A facet under follower pressure.
#[derive(Clone, Copy, Debug)]
struct Pressed {
    nodes: [u32; 4],
    load: usize,
    /// Part of the facet that counts: less than 1 across a plane of symmetry.
    share: f64,
}

impl ExternalLoads {
    /// Prepares the loads of a model.
    pub fn new(model: &Model) -> Self {
        let mut outside = Self::default();
        for (l, load) in model.loads.iter().enumerate() {
            if let LoadOn::Follower(facets) = &load.acts {
                outside.facets.extend(facets.iter().map(|facet| Pressed {
                    nodes: *facet,
                    load: l,
                    share: model.mesh.share(facet),
                }));
            }
            outside.acts.push(load.acts.clone());
        }
        let cells = outside.facets.iter().map(
            |Pressed {
                 nodes: [a, b, c, d],
                 ..
             }| [*a, *b, *c, *d, *a, *a, *a, *a],
        );
        outside.cells = cells.collect();
        outside
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.acts.is_empty()
    }

    /// Cells of eight nodes: the facets under follower pressure.
    pub fn cells(&self) -> &[[u32; 8]] {
        &self.cells
    }

    /// Adds the forces [N] of one load with this value on nodes at `x` [mm] to `force`. `[node][xyz]`
    pub fn add(&self, load: usize, value: [f64; 3], x: &[[f64; 3]], force: &mut [[f64; 3]]) {
        match &self.acts[load] {
            LoadOn::Follower(_) => {
                for facet in self.facets.iter().filter(|facet| facet.load == load) {
                    press(facet, value[0], x, force);
                }
            }
            dead => add_dead(dead, value, force),
        }
    }

    /// Adds the forces of all loads of fixed direction with these values.
    pub fn add_dead(&self, values: &[[f64; 3]], force: &mut [[f64; 3]]) {
        for (acts, value) in self.acts.iter().zip(values) {
            add_dead(acts, *value, force);
        }
    }

    /// Adds the forces of the follower pressures among the loads with these values at `x` [mm].
    pub fn add_followers(&self, values: &[[f64; 3]], x: &[[f64; 3]], force: &mut [[f64; 3]]) {
        for facet in &self.facets {
            press(facet, values[facet.load][0], x, force);
        }
    }

    /// Writes −∂F/∂x of the follower pressures at `x` to the cells [N/mm] `[cell][CELL]`, and to `active` which
    /// cells contribute.
    pub fn write_stiffness(
        &self,
        values: &[[f64; 3]],
        x: &[[f64; 3]],
        cells: &mut [f64],
        active: &mut [bool],
    ) {
        let facets = self.facets.iter().zip(cells.chunks_exact_mut(CELL));
        for ((facet, cell), active) in facets.zip(active) {
            let p = facet.share * values[facet.load][0];
            *active = p != 0.0;
            if !*active {
                continue;
            }
            cell.fill(0.0);
            let turning = facet::turning(&facet.nodes.map(|n| x[n as usize]));
            for a in 0..4 {
                for b in 0..4 {
                    let to = &mut cell[(a * 8 + b) * 9..][..9];
                    for i in 0..3 {
                        for j in 0..3 {
                            to[3 * i + j] = p * turning[a][b][i][j];
                        }
                    }
                }
            }
        }
    }
}

/// Adds the forces −p A_a to the nodes of a facet.
fn press(facet: &Pressed, p: f64, x: &[[f64; 3]], force: &mut [[f64; 3]]) {
    let p = facet.share * p;
    if p == 0.0 {
        return;
    }
    let areas = facet::area_vectors(&facet.nodes.map(|n| x[n as usize]));
    for (&n, area) in facet.nodes.iter().zip(areas) {
        for i in 0..3 {
            force[n as usize][i] -= p * area[i];
        }
    }
}

fn add_dead(acts: &LoadOn, value: [f64; 3], force: &mut [[f64; 3]]) {
    match acts {
        LoadOn::Follower(_) => {}
        LoadOn::Pressure(areas) => {
            for (n, area) in areas {
                for i in 0..3 {
                    force[*n as usize][i] -= value[0] * area[i];
                }
            }
        }
        LoadOn::Shares(shares) => {
            for (n, share) in shares {
                for i in 0..3 {
                    force[*n as usize][i] += share * value[i];
                }
            }
        }
    }
}
