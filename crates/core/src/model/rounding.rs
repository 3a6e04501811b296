//! Nodal forces caused by rounding.

use nalgebra::Vector3;

use super::Model;

/// Nodal force caused by rounding of positions [N]: ε E h L with the largest E h of the elements (h their mean edge)
/// and the diagonal L of the scene. A position X + u is known to ε L.
pub(crate) fn force(model: &Model) -> f64 {
    largest(model).0
}

/// That force [N], and the element with the largest E h.
pub(crate) fn largest(model: &Model) -> (f64, usize) {
    let mesh = &model.mesh;
    let stiffness = |e: usize| {
        let parameters = &model.materials[mesh.material[e] as usize].parameters;
        let corners = mesh.corners(e).map(Vector3::from);
        let edges = [1, 3, 4].map(|a| (corners[a] - corners[0]).norm());
        parameters.elastic().E * edges.iter().sum::<f64>() / 3.0
    };
    let all = (0..mesh.elements.len()).map(|e| (stiffness(e), e));
    let stiffest = all.fold(
        (0.0, 0),
        |most, next| if next.0 > most.0 { next } else { most },
    );
    let nodes = || mesh.nodes.iter().copied().map(Vector3::from);
    let low = nodes().fold(Vector3::repeat(f64::INFINITY), |a, x| a.inf(&x));
    let high = nodes().fold(Vector3::repeat(f64::NEG_INFINITY), |a, x| a.sup(&x));
    (f64::EPSILON * stiffest.0 * (high - low).norm(), stiffest.1)
}
