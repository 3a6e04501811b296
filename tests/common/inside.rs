//! An independent measure of penetration: points of one body that lie within another, found by inverting the map of
//! each hexahedron, without the data structures of contact.

use nalgebra::{Matrix3, Vector3};
use wythe::element::hex8::CORNERS;
use wythe::model::{Mesh, Model};

use super::scene::Recording;

/// Positions of all nodes in a frame [mm].
pub fn positions(model: &Model, recording: &Recording, at: usize) -> Vec<[f64; 3]> {
    let u = &recording.frames[at].displacement;
    let nodes = model.mesh.nodes.iter().zip(u);
    nodes.map(|(x, u)| [0, 1, 2].map(|i| x[i] + u[i])).collect()
}

/// Deepest penetration in some 200 of the frames, including the last one [mm].
pub fn penetration(model: &Model, recording: &Recording) -> f64 {
    let frames = recording.frames.len();
    let every = frames / 200 + 1;
    (0..frames)
        .filter(|k| (frames - 1 - k).is_multiple_of(every))
        .map(|k| deepest(&model.mesh, &positions(model, recording, k), 9))
        .fold(0.0, f64::max)
}

/// Deepest penetration between any two bodies [mm]. Each element has a lattice of `n`³ points, including its faces,
/// edges and corners. The depth is the distance to the nearest face of the element that contains the point.
pub fn deepest(mesh: &Mesh, x: &[[f64; 3]], n: usize) -> f64 {
    deepest_point(mesh, x, n).0
}

/// The same, with the element and parameters of the point, and the element that contains it.
pub fn deepest_point(mesh: &Mesh, x: &[[f64; 3]], n: usize) -> (f64, usize, [f64; 3], usize) {
    let boxes: Vec<[Vector3<f64>; 2]> = (0..mesh.elements.len())
        .map(|e| {
            let corners = corners(mesh, x, e);
            let low = corners.iter().fold(corners[0], |a, c| a.inf(c));
            let high = corners.iter().fold(corners[0], |a, c| a.sup(c));
            [low, high]
        })
        .collect();
    let mut worst = (0.0_f64, 0, [0.0; 3], 0);
    for e in 0..mesh.elements.len() {
        let others: Vec<usize> = (0..mesh.elements.len())
            .filter(|&o| mesh.unit[o] != mesh.unit[e])
            .filter(|&o| {
                (0..3).all(|i| boxes[e][0][i] <= boxes[o][1][i] && boxes[o][0][i] <= boxes[e][1][i])
            })
            .collect();
        if others.is_empty() {
            continue;
        }
        let own = corners(mesh, x, e);
        for p in 0..n * n * n {
            let at = [p % n, p / n % n, p / n / n].map(|i| 2.0 * i as f64 / (n - 1) as f64 - 1.0);
            let point = map(&own, at);
            for &o in &others {
                let depth = depth(&corners(mesh, x, o), &point);
                if depth > worst.0 {
                    worst = (depth, e, at, o);
                }
            }
        }
    }
    worst
}

fn corners(mesh: &Mesh, x: &[[f64; 3]], e: usize) -> [Vector3<f64>; 8] {
    mesh.elements[e].map(|n| Vector3::from(x[n as usize]))
}

fn weight(a: usize, at: [f64; 3]) -> f64 {
    (0..3)
        .map(|i| 0.5 * (1.0 + CORNERS[a][i] * at[i]))
        .product()
}

fn map(corners: &[Vector3<f64>; 8], at: [f64; 3]) -> Vector3<f64> {
    (0..8).map(|a| corners[a] * weight(a, at)).sum()
}

/// Depth of a point in a hexahedron [mm]; 0 outside.
fn depth(corners: &[Vector3<f64>; 8], point: &Vector3<f64>) -> f64 {
    let mut at = [0.0; 3];
    let mut jacobian = Matrix3::zeros();
    for _ in 0..20 {
        let mut slopes = [Vector3::zeros(); 3];
        for (a, corner) in corners.iter().enumerate() {
            for (i, slope) in slopes.iter_mut().enumerate() {
                let others: f64 = (0..3)
                    .filter(|j| *j != i)
                    .map(|j| 0.5 * (1.0 + CORNERS[a][j] * at[j]))
                    .product();
                *slope += corner * (0.5 * CORNERS[a][i] * others);
            }
        }
        jacobian = Matrix3::from_columns(&slopes);
        let Some(inverse) = jacobian.try_inverse() else {
            return 0.0;
        };
        let step = inverse * (point - map(corners, at));
        (0..3).for_each(|i| at[i] += step[i].clamp(-1.0, 1.0));
        if step.norm() < 1e-13 {
            break;
        }
    }
    if at.iter().any(|s| s.abs() >= 1.0) {
        return 0.0;
    }
    let Some(inverse) = jacobian.try_inverse() else {
        return 0.0;
    };
    // The distance to ξ_i = ±1 is (1 − |ξ_i|) over the length of the gradient of ξ_i.
    (0..3)
        .map(|i| (1.0 - at[i].abs()) / inverse.row(i).norm())
        .fold(f64::INFINITY, f64::min)
}
