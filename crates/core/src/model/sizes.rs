//! Sizes of a model.

use super::Model;
use super::scene::BeamMotion;

/// Sizes of a model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Sizes {
    /// Units (bodies).
    pub units: usize,
    /// Hex8 elements.
    pub elements: usize,
    /// Nodes.
    pub nodes: usize,
    /// Unknowns. For a run, those that were solved.
    pub dofs: usize,
    /// Contact points.
    pub contact_points: usize,
}

/// Counts units, elements, nodes, unknowns and contact points of a model.
pub fn sizes(model: &Model) -> Sizes {
    let units = model.mesh.unit.iter().max().map_or(0, |&u| u as usize + 1);
    let nodes = model.mesh.nodes.len();
    let mut free = vec![[true; 3]; nodes];
    for support in &model.supports {
        for &n in &support.nodes {
            for (free, fixed) in free[n as usize].iter_mut().zip(support.fixed) {
                *free &= !fixed;
            }
        }
    }
    for &n in model.beams.iter().flat_map(|b| &b.nodes) {
        free[n as usize] = [false; 3];
    }
    for image in &model.mesh.reflected {
        free[image.node as usize] = [false; 3];
    }
    // A direction of a beam is unknown if any step leaves it free under a force.
    let beam_dofs: usize = (0..model.beams.len())
        .flat_map(|b| (0..3).map(move |d| (b, d)))
        .filter(|&(b, d)| {
            model
                .steps
                .iter()
                .any(|s| matches!(s.motion[b][d], BeamMotion::Force(_)))
        })
        .count();
    Sizes {
        units,
        elements: model.mesh.elements.len(),
        nodes,
        dofs: free.iter().flatten().filter(|f| **f).count() + beam_dofs,
        contact_points: 4 * model.contact.slave_facets.len(),
    }
}
