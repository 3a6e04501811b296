//! Boundary facets of all bodies, and their nodes.

use wythe_contact::Surface;

use super::Mass;
use crate::model::Model;
use crate::model::boundary_facets::BoundaryFacets;
use crate::model::general::shortest_side;

/// Boundary facets of all bodies.
#[derive(Clone, Debug, Default)]
pub(super) struct Faces {
    pub(super) surface: Surface,
    /// Start of each node's entries in `around`, the facets at nodes. `[node]`
    pub(super) around_start: Vec<u32>,
    pub(super) around: Vec<u32>,
    /// Nodes of the boundary facets.
    pub(super) nodes: Vec<u32>,
    /// Shortest side of each facet [mm]. `[facet]`
    pub(super) size: Vec<f64>,
    /// Shortest side of the facets at a node [mm]. `[node]`
    pub(super) node_size: Vec<f64>,
    /// Whether all nodes of a facet are fully supported. `[facet]`
    pub(super) held_facet: Vec<bool>,
    /// Inverse mass of a node; 0 where it is fully supported [1/tonne]. `[node]`
    pub(super) inverse_mass: Vec<f64>,
}

impl Faces {
    /// Facets `skin` of a model whose nodes have masses.
    pub(super) fn new(model: &Model, skin: &BoundaryFacets, mass: &Mass) -> Self {
        let x = &model.mesh.nodes;
        let surface = Surface {
            facets: skin.facets.clone(),
            body: skin.body.clone(),
        };
        let (around_start, around) = facets_at_nodes(&skin.facets, x.len());
        let size: Vec<f64> = (0..skin.facets.len())
            .map(|f| shortest_side(&surface.corners(f, x)))
            .collect();
        let mut node_size = vec![f64::INFINITY; x.len()];
        for (facet, &size) in skin.facets.iter().zip(&size) {
            for &n in facet {
                node_size[n as usize] = node_size[n as usize].min(size);
            }
        }
        let held = held_nodes(model);
        let inverse = |(&m, &held): (&f64, &bool)| if held || m <= 0.0 { 0.0 } else { 1.0 / m };
        Self {
            held_facet: (skin.facets.iter())
                .map(|f| f.iter().all(|&n| held[n as usize]))
                .collect(),
            nodes: (0..x.len() as u32)
                .filter(|&n| around_start[n as usize] < around_start[n as usize + 1])
                .collect(),
            inverse_mass: mass.node.iter().zip(&held).map(inverse).collect(),
            surface,
            around_start,
            around,
            size,
            node_size,
        }
    }

    /// Facets at a node.
    pub(super) fn at(&self, node: u32) -> &[u32] {
        let range = self.around_start[node as usize]..self.around_start[node as usize + 1];
        &self.around[range.start as usize..range.end as usize]
    }
}

/// Facets at each of `nodes` nodes: start of each node's entries, and the entries.
fn facets_at_nodes(facets: &[[u32; 4]], nodes: usize) -> (Vec<u32>, Vec<u32>) {
    let mut count = vec![0_u32; nodes + 1];
    for &n in facets.iter().flatten() {
        count[n as usize + 1] += 1;
    }
    for n in 0..nodes {
        count[n + 1] += count[n];
    }
    let (start, mut next) = (count.clone(), count);
    let mut around = vec![0; 4 * facets.len()];
    for (f, facet) in facets.iter().enumerate() {
        for &n in facet {
            around[next[n as usize] as usize] = f as u32;
            next[n as usize] += 1;
        }
    }
    (start, around)
}

/// Whether each node is supported in all directions. `[node]`
fn held_nodes(model: &Model) -> Vec<bool> {
    let mut held = vec![[false; 3]; model.mesh.nodes.len()];
    for support in &model.supports {
        for &n in &support.nodes {
            for i in 0..3 {
                held[n as usize][i] |= support.fixed[i];
            }
        }
    }
    held.iter().map(|h| h.iter().all(|h| *h)).collect()
}
