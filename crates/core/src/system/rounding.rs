//! What rounding leaves of a force.

use nalgebra::Vector3;

use crate::model::Model;

/// ε E h L with the largest E h of the elements (h their mean edge) and the scene's diagonal L: what a
/// position X + u, known to ε L, leaves of a force [N].
pub fn force(model: &Model) -> f64 {
    let mesh = &model.mesh;
    let stiffness = |e: usize| {
        let parameters = &model.materials[mesh.material[e] as usize].parameters;
        let corners = mesh.corners(e).map(Vector3::from);
        let edges = [1, 3, 4].map(|a| (corners[a] - corners[0]).norm());
        parameters.elastic().E * edges.iter().sum::<f64>() / 3.0
    };
    let stiffest = (0..mesh.elements.len()).map(stiffness).fold(0.0, f64::max);
    let nodes = || mesh.nodes.iter().copied().map(Vector3::from);
    let low = nodes().fold(Vector3::repeat(f64::INFINITY), |a, x| a.inf(&x));
    let high = nodes().fold(Vector3::repeat(f64::NEG_INFINITY), |a, x| a.sup(&x));
    f64::EPSILON * stiffest * (high - low).norm()
}
