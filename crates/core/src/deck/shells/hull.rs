//! Convex hull of points in space, one point after the other.

use super::polyhedron::Plane;
use crate::element::hexahedron::{cross, difference, dot, norm};
use rustc_hash::FxHashSet;

/// Points nearer to a face than this part of the extent lie in it.
const NEAR: f64 = 1e-9;

/// Triangles of the convex hull, counter-clockwise seen from outside; none if the points lie in one plane.
pub(super) fn hull(points: &[[f64; 3]]) -> Option<Vec<Vec<u32>>> {
    let first = start(points)?;
    let extent = points
        .iter()
        .map(|x| norm(difference(*x, points[0])))
        .fold(0.0, f64::max);
    let near = NEAR * extent;
    let mut faces: Vec<([u32; 3], Plane)> = Vec::new();
    let [a, b, c, d] = first;
    for face in [[a, b, c], [a, d, b], [b, d, c], [c, d, a]] {
        faces.push((face, plane(points, face)));
    }
    for (n, x) in points.iter().enumerate() {
        if first.contains(&(n as u32)) {
            continue;
        }
        let sees = |plane: &Plane| plane.above(*x) > near;
        // Edges of faces that the point sees; those of one face only are the horizon.
        let mut edges: FxHashSet<(u32, u32)> = FxHashSet::default();
        let mut order = Vec::new();
        faces.retain(|(face, plane)| {
            let seen = sees(plane);
            if seen {
                for i in 0..3 {
                    let edge = (face[i], face[(i + 1) % 3]);
                    edges.insert(edge);
                    order.push(edge);
                }
            }
            !seen
        });
        for (a, b) in order {
            if !edges.contains(&(b, a)) {
                let face = [a, b, n as u32];
                faces.push((face, plane(points, face)));
            }
        }
    }
    Some(faces.into_iter().map(|(face, _)| face.to_vec()).collect())
}

fn plane(points: &[[f64; 3]], face: [u32; 3]) -> Plane {
    let [a, b, c] = face.map(|n| points[n as usize]);
    let area = cross(difference(b, a), difference(c, a));
    let length = norm(area).max(f64::MIN_POSITIVE);
    Plane {
        normal: area.map(|x| x / length),
        origin: a,
    }
}

/// Four points far apart, the fourth below the triangle of the others.
fn start(points: &[[f64; 3]]) -> Option<[u32; 4]> {
    let farthest = |measure: &dyn Fn([f64; 3]) -> f64| {
        let all = points.iter().enumerate();
        all.max_by(|a, b| measure(*a.1).total_cmp(&measure(*b.1)))
            .map(|(n, _)| n as u32)
    };
    let at = |n: u32| points[n as usize];
    let a = farthest(&|x| -x[0])?;
    let b = farthest(&|x| norm(difference(x, at(a))))?;
    let way = difference(at(b), at(a));
    let c = farthest(&|x| norm(cross(way, difference(x, at(a)))))?;
    let normal = cross(way, difference(at(c), at(a)));
    let d = farthest(&|x| dot(normal, difference(x, at(a))).abs())?;
    let above = dot(normal, difference(at(d), at(a)));
    if above.abs() <= NEAR * norm(normal) * norm(way) {
        return None;
    }
    Some(if above < 0.0 {
        [a, b, c, d]
    } else {
        [a, c, b, d]
    })
}

#[cfg(test)]
mod tests {
    use super::super::split::volume;
    use super::*;

    #[test]
    fn the_hull_of_a_cube_with_points_in_it_is_the_cube() {
        let mut points = Vec::new();
        for k in 0..27 {
            points.push([k % 3, k / 3 % 3, k / 9].map(f64::from));
        }
        let faces = hull(&points).unwrap();
        assert!((volume(&points, &faces) - 8.0).abs() < 1e-12);
        assert!(hull(&points[..9]).is_none(), "points in one plane");
    }

    #[test]
    fn a_hull_contains_all_points_of_a_ball() {
        // Points on a sphere by the golden angle.
        let on = |n: usize| {
            let z = 1.0 - (2 * n + 1) as f64 / 400.0;
            let (r, angle) = ((1.0 - z * z).sqrt(), 2.399963 * n as f64);
            [r * angle.cos(), r * angle.sin(), z]
        };
        let points: Vec<[f64; 3]> = (0..400).map(on).collect();
        let faces = hull(&points).unwrap();
        assert_eq!(faces.len(), 2 * 400 - 4, "each point is a corner");
        let volume = volume(&points, &faces);
        let ball = 4.0 / 3.0 * std::f64::consts::PI;
        // A polyhedron of 400 corners fills the ball but for some 2 percent.
        assert!(volume < ball && volume > 0.97 * ball, "{volume}");
    }
}
