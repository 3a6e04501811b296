//! Contact of two faces of blocks at rest. Faces are quadrilaterals, flat or nearly so.

use crate::element::hexahedron::{area_vector, cross, difference, dot, mean, norm, range};
use wythe_contact::Aabb;

/// Two faces oppose each other if the product of their unit normals is below this.
const OPPOSED: f64 = -0.999;

/// Smallest overlap that counts as contact, as a fraction of the size of the faces: a smaller one is a touch of
/// edges.
const OVERLAP: f64 = 1e-6;

/// Upper bound of the inclination of opposed faces, as a fraction of their diagonal, see [`OPPOSED`].
const INCLINED: f64 = 0.05;

/// Box around all faces that may touch this one: the boxes of two touching faces intersect.
pub(super) fn surroundings(face: &[[f64; 3]; 4]) -> Aabb {
    let own = Aabb::of(face);
    own.fattened(INCLINED * norm(difference(own.max, own.min)))
}

/// Distance between two opposed faces [mm], negative where they interpenetrate; none if they do not oppose each
/// other or do not overlap seen along their normal.
pub(super) fn distance(a: &[[f64; 3]; 4], b: &[[f64; 3]; 4]) -> Option<f64> {
    let unit = |q: &[[f64; 3]; 4]| {
        let normal = area_vector(q);
        let area = norm(normal);
        (normal.map(|x| x / area), area)
    };
    let ((normal, area), (other, other_area)) = (unit(a), unit(b));
    if dot(normal, other) > OPPOSED {
        return None;
    }
    // Separating axes: two convex polygons in a plane are separate if their projections along the normal of an edge
    // are.
    let least = OVERLAP * area.min(other_area).sqrt();
    let apart = [a, b].into_iter().any(|polygon| {
        (0..4).any(|i| {
            let edge = difference(polygon[(i + 1) % 4], polygon[i]);
            let axis = cross(edge, normal);
            let length = norm(axis);
            length > 0.0 && overlap(a, b, axis.map(|x| x / length)) <= least
        })
    });
    (!apart).then(|| dot(difference(mean(b), mean(a)), normal))
}

/// Returns whether a point in the plane of a face lies within its edges.
pub(super) fn covers(face: &[[f64; 3]; 4], point: [f64; 3]) -> bool {
    let normal = area_vector(face);
    let area = norm(normal);
    (0..4).all(|i| {
        let edge = difference(face[(i + 1) % 4], face[i]);
        // Twice the area of the triangle of edge and point, signed by the side of the edge.
        let inwards = dot(cross(edge, difference(point, face[i])), normal) / area;
        inwards >= -OVERLAP * area
    })
}

/// Overlap of the projections of two faces on a unit vector [mm].
fn overlap(a: &[[f64; 3]; 4], b: &[[f64; 3]; 4], axis: [f64; 3]) -> f64 {
    let along = |q: &[[f64; 3]; 4]| range(q.map(|x| dot(x, axis)));
    let (a, b) = (along(a), along(b));
    a[1].min(b[1]) - a[0].max(b[0])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f64, z: f64, up: bool) -> [[f64; 3]; 4] {
        let mut q = [
            [x, 0.0, z],
            [x + 1.0, 0.0, z],
            [x + 1.0, 1.0, z],
            [x, 1.0, z],
        ];
        if !up {
            q.swap(1, 3);
        }
        q
    }

    #[test]
    fn faces_meet_that_oppose_and_overlap() {
        let base = square(0.0, 0.0, true);
        assert_eq!(distance(&base, &square(0.5, 0.25, false)), Some(0.25));
        assert_eq!(distance(&base, &square(0.5, -0.25, false)), Some(-0.25));
        assert_eq!(distance(&base, &square(0.5, 0.25, true)), None);
        assert!(covers(&base, [0.5, 1.0, 0.25]) && !covers(&base, [1.1, 0.5, 0.0]));
        // Edges touch.
        assert_eq!(distance(&base, &square(1.0, 0.0, false)), None);
        assert_eq!(distance(&base, &square(1.5, 0.0, false)), None);
    }
}
