//! Contact of an edge with an edge of another body.
//!
//! The contact points are x_a + s (x_b − x_a) and y_a + t (y_b − y_a), where the two lines are nearest. The normal is
//! common to both edges, n ∥ d × e, and points out of the second body. Δδ_α = t_α·(x(s₀) − y(t₀)) is the slip between
//! the material points that met at the start of the increment.

use nalgebra::Vector3;

/// Relative position of two edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Parameters s and t at which the lines are nearest; values outside [0, 1] lie beyond the ends of the edges [-].
    pub at: [f64; 2],
    /// Unit normal d × e/|d × e|; its sign is arbitrary.
    pub normal: Vector3<f64>,
    /// Sine of the angle between the edges.
    pub sine: f64,
}

/// Sine of the angle below which two edges count as parallel. The ends of parallel edges meet faces instead.
pub const PARALLEL: f64 = 0.01;

fn ends(edge: &[[f64; 3]; 2]) -> [Vector3<f64>; 2] {
    edge.map(Vector3::from)
}

/// Crossing of two edges seen along their common normal; `None` if they are parallel.
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

/// Parameters at which two edges cross when seen along the direction `n`; `None` if they appear parallel.
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

/// Whether a direction normal to a convex edge lies between the outward normals `[n₁, n₂]` of the adjacent faces.
/// `slack` is the tolerance, the sine of an angle.
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
    /// Contact parameters s and t [-].
    pub at: [f64; 2],
    /// Gap along the normal, positive when open [mm].
    pub gap: f64,
    /// Slip since the start of the increment, or since the edges met within it [mm].
    pub slip: [f64; 2],
    /// n out of the second body, t₁ along its edge, t₂ = n × t₁.
    pub frame: [Vector3<f64>; 3],
}

impl EdgePair {
    /// Kinematics of two edges. The normal points to the side of `out`; `anchor` holds s and t of the material points
    /// that met.
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
