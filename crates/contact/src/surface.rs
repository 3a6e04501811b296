//! Surfaces of quadrilateral facets.

use nalgebra::Vector3;

/// Facets of one side of contact. Nodes run counter-clockwise seen from outside the body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Nodes of each facet. `[facet][corner]`
    pub facets: Vec<[u32; 4]>,
    /// Body of each facet; facets of one body do not touch each other. `[facet]`
    pub body: Vec<u32>,
}

impl Surface {
    /// Corner positions of a facet [mm].
    #[inline(always)]
    pub fn corners(&self, facet: usize, x: &[[f64; 3]]) -> [[f64; 3]; 4] {
        let [a, b, c, d] = self.facets[facet];
        [x[a as usize], x[b as usize], x[c as usize], x[d as usize]]
    }
}

/// Bilinear shape functions at (ξ, η): N and their derivatives by ξ and η.
pub(crate) fn shape(xi: [f64; 2]) -> ([f64; 4], [f64; 4], [f64; 4]) {
    let [s, t] = xi;
    (
        [
            0.25 * (1.0 - s) * (1.0 - t),
            0.25 * (1.0 + s) * (1.0 - t),
            0.25 * (1.0 + s) * (1.0 + t),
            0.25 * (1.0 - s) * (1.0 + t),
        ],
        [
            -0.25 * (1.0 - t),
            0.25 * (1.0 - t),
            0.25 * (1.0 + t),
            -0.25 * (1.0 + t),
        ],
        [
            -0.25 * (1.0 - s),
            -0.25 * (1.0 + s),
            0.25 * (1.0 + s),
            0.25 * (1.0 - s),
        ],
    )
}

/// Second derivative ∂²N/∂ξ∂η, constant.
pub(crate) const MIXED: [f64; 4] = [0.25, -0.25, 0.25, -0.25];

/// Σ w_a x_a.
pub fn blend(weights: &[f64; 4], x: &[[f64; 3]; 4]) -> Vector3<f64> {
    let mut sum = Vector3::zeros();
    for a in 0..4 {
        for i in 0..3 {
            sum[i] += weights[a] * x[a][i];
        }
    }
    sum
}

/// Facets with a smaller ratio of area |a₁ × a₂| to squared size have no normal at the point: an edge is collapsed up
/// to rounding of its nodes.
const FLAT: f64 = 1e-10;

/// Frame [n, t₁, t₂] of a facet at (ξ, η): outward normal, the direction of ξ, and n × t₁.
///
/// At a collapsed edge the frame is that of the middle of the facet. A facet without area has no frame; the global
/// axes are returned to avoid a division by zero, since the facet has no weight.
pub fn frame_at(corners: &[[f64; 3]; 4], xi: [f64; 2]) -> [Vector3<f64>; 3] {
    regular_frame(corners, xi)
        .or_else(|| regular_frame(corners, [0.0; 2]))
        .unwrap_or([Vector3::z(), Vector3::x(), Vector3::y()])
}

/// The frame, if it is defined.
fn regular_frame(corners: &[[f64; 3]; 4], xi: [f64; 2]) -> Option<[Vector3<f64>; 3]> {
    let (_, by_s, by_t) = shape(xi);
    let (a1, a2) = (blend(&by_s, corners), blend(&by_t, corners));
    let cross = a1.cross(&a2);
    let (area, length) = (cross.norm(), a1.norm());
    let size = length + a2.norm();
    if area <= FLAT * size * size || area == 0.0 {
        return None;
    }
    let (n, t1) = (cross / area, a1 / length);
    Some([n, t1, n.cross(&t1)])
}

/// Weights of a facet's corners at (ξ, η).
pub fn weights_at(xi: [f64; 2]) -> [f64; 4] {
    shape(xi).0
}

/// Point of a facet at (ξ, η) [mm].
pub fn point_at(corners: &[[f64; 3]; 4], xi: [f64; 2]) -> Vector3<f64> {
    blend(&shape(xi).0, corners)
}
