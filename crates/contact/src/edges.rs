//! An edge against an edge of another body.
//!
//! Points x_a + s (x_b − x_a) and y_a + t (y_b − y_a) where the two lines are nearest; the normal is
//! common to both, n ∥ d × e, and points out of the second body. Δδ_α = t_α·(x(s₀) − y(t₀)) is the slip of
//! the material points that met when the increment began.

use nalgebra::Vector3;

/// Two edges as seen at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// s and t where the lines are nearest; beyond 0 and 1 outside the edges [-].
    pub at: [f64; 2],
    /// Unit normal d × e/|d × e|, of no particular sign.
    pub normal: Vector3<f64>,
    /// Sine of the angle between the edges.
    pub sine: f64,
}

/// Sine of the angle below which edges run side by side: their ends meet faces instead.
pub const PARALLEL: f64 = 0.01;

fn ends(edge: &[[f64; 3]; 2]) -> [Vector3<f64>; 2] {
    edge.map(Vector3::from)
}

/// Where two edges cross seen along their common normal; none if they run side by side.
pub fn crossing(a: &[[f64; 3]; 2], b: &[[f64; 3]; 2]) -> Option<Crossing> {
    let ([a0, a1], [b0, b1]) = (ends(a), ends(b));
    let (d, e) = (a1 - a0, b1 - b0);
    let cross = d.cross(&e);
    let size = cross.norm();
    let scale = d.norm() * e.norm();
    if size.is_nan() || size <= PARALLEL * scale {
        return None;
    }
    let normal = cross / size;
    let r = b0 - a0;
    Some(Crossing {
        at: [
            r.cross(&e).dot(&normal) / size,
            r.cross(&d).dot(&normal) / size,
        ],
        normal,
        sine: size / scale,
    })
}

/// Where two edges cross seen along any direction `n`; none if they run side by side in that view.
pub fn crossing_along(a: &[[f64; 3]; 2], b: &[[f64; 3]; 2], n: &Vector3<f64>) -> Option<[f64; 2]> {
    let ([a0, a1], [b0, b1]) = (ends(a), ends(b));
    let (d, e) = (a1 - a0, b1 - b0);
    let det = d.cross(&e).dot(n);
    if det.abs() <= 0.1 * PARALLEL * d.norm() * e.norm() {
        return None;
    }
    let r = b0 - a0;
    Some([r.cross(&e).dot(n) / det, r.cross(&d).dot(n) / det])
}

/// Point of an edge [mm].
pub fn point_on(edge: &[[f64; 3]; 2], at: f64) -> Vector3<f64> {
    let [a, b] = ends(edge);
    a + (b - a) * at
}

/// Whether a direction across a convex edge lies between the outward normals `[n₁, n₂]` of its two faces,
/// to `slack` (the sine of an angle).
pub fn between(n: &Vector3<f64>, faces: &[Vector3<f64>; 2], slack: f64) -> bool {
    let [p, q] = faces;
    let axis = p.cross(q);
    let size = axis.norm();
    if size <= 1e-9 {
        return n.dot(p) > 0.0;
    }
    let axis = axis / size;
    p.cross(n).dot(&axis) >= -slack && n.cross(q).dot(&axis) >= -slack && n.dot(&(p + q)) > 0.0
}

/// Kinematics of two edges in contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgePair {
    /// s and t [-].
    pub at: [f64; 2],
    /// Gap along the normal, positive outside [mm].
    pub gap: f64,
    /// Slip since the increment began, or since the edges met in it [mm].
    pub slip: [f64; 2],
    /// n out of the second body, t₁ along its edge, n × t₁.
    pub frame: [Vector3<f64>; 3],
}

impl EdgePair {
    /// Sees two edges whose normal points to the side of `out`; `anchor` are the s and t that met.
    pub fn new(
        a: &[[f64; 3]; 2],
        b: &[[f64; 3]; 2],
        out: &Vector3<f64>,
        anchor: [f64; 2],
    ) -> Option<Self> {
        let seen = crossing(a, b)?;
        let n = if seen.normal.dot(out) < 0.0 {
            -seen.normal
        } else {
            seen.normal
        };
        let [b0, b1] = ends(b);
        let t1 = (b1 - b0).normalize();
        let t2 = n.cross(&t1);
        let gap = n.dot(&(point_on(a, seen.at[0]) - point_on(b, seen.at[1])));
        let reach = point_on(a, anchor[0]) - point_on(b, anchor[1]);
        Some(Self {
            at: seen.at,
            gap,
            slip: [t1.dot(&reach), t2.dot(&reach)],
            frame: [n, t1, t2],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn edges_cross_where_they_are_nearest() {
        let a = [[-1.0, 0.0, 0.5], [3.0, 0.0, 0.5]];
        let b = [[0.0, -1.0, 0.0], [0.0, 1.0, 0.0]];
        let seen = crossing(&a, &b).unwrap();
        assert_eq!(seen.at, [0.25, 0.5]);
        assert_eq!((seen.normal, seen.sine), (Vector3::z(), 1.0));
        let pair = EdgePair::new(&a, &b, &Vector3::new(0.1, 0.0, 1.0), [0.5, 0.25]).unwrap();
        assert_eq!((pair.gap, pair.at), (0.5, [0.25, 0.5]));
        // t₁ along y, t₂ = z × y = −x: the points are (1, 0) and (0, −0.5).
        assert_eq!(pair.slip, [0.5, -1.0]);
        let below = EdgePair::new(&a, &b, &-Vector3::z(), [0.25, 0.5]).unwrap();
        assert_eq!((below.gap, below.slip), (-0.5, [0.0, 0.0]));
        assert_eq!(crossing(&a, &[[0.0, 0.0, 0.0], [1.0, 0.005, 0.0]]), None);
        let slanted = crossing_along(&a, &b, &Vector3::new(1.0, 0.0, 1.0)).unwrap();
        // Along (1, 0, 1) the point (0.5, 0, 0.5) lies over the origin.
        assert_eq!(slanted, [0.375, 0.5]);
    }

    #[test]
    fn a_normal_of_an_edge_lies_between_those_of_its_faces() {
        let faces = [Vector3::x(), Vector3::z()];
        let at = |angle: f64| Vector3::new(angle.cos(), 0.0, angle.sin());
        for (degrees, inside) in [(45.0_f64, true), (0.0, true), (90.0, true), (-3.0, false)] {
            let n = at(degrees.to_radians());
            assert_eq!(between(&n, &faces, 0.02), inside, "{degrees}");
        }
        assert!(!between(&at(3.9), &faces, 0.02));
        assert!(between(&at(-0.01), &faces, 0.02));
    }
}
