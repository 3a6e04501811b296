//! Do two faces of blocks meet at rest? Faces are quadrilaterals, flat or nearly so.

use crate::element::hexahedron::{area_vector, cross, difference, dot, mean, norm, range};
use wythe_contact::Aabb;

/// Two faces oppose each other if their unit normals have a product below this.
const OPPOSED: f64 = -0.999;

/// Part of the faces' size that counts as contact: less is a touch of edges.
const OVERLAP: f64 = 1e-6;

/// Faces that oppose each other may be inclined by so much of their diagonal, see [`OPPOSED`].
const INCLINED: f64 = 0.05;

/// The box around all that may touch a face: those of two faces that do touch each other.
pub(super) fn surroundings(face: &[[f64; 3]; 4]) -> Aabb {
    let own = Aabb::of(face);
    own.fattened(INCLINED * norm(difference(own.max, own.min)))
}

/// Distance between two faces that oppose each other and overlap seen along their normal [mm],
/// negative where they interpenetrate; none if they do not.
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
    // Separating axes: two convex polygons in a plane are apart if they are so along the normal of
    // one of their edges.
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

/// Whether a face has a point of another one's plane within its edges.
pub(super) fn covers(face: &[[f64; 3]; 4], point: [f64; 3]) -> bool {
    let normal = area_vector(face);
    let area = norm(normal);
    (0..4).all(|i| {
        let edge = difference(face[(i + 1) % 4], face[i]);
        // twice the area of the triangle of edge and point, by its side of the edge
        let inwards = dot(cross(edge, difference(point, face[i])), normal) / area;
        inwards >= -OVERLAP * area
    })
}

/// Common length of the projections of two faces on a unit vector [mm].
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
        // edge to edge
        assert_eq!(distance(&base, &square(1.0, 0.0, false)), None);
        assert_eq!(distance(&base, &square(1.5, 0.0, false)), None);
    }
}
