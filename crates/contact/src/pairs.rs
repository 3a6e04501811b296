//! Which point faces which facet.

use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

use crate::aabb::Aabb;
use crate::bvh::Bvh;
use crate::projection::extend;
use crate::surface::{Surface, frame_at};

/// The facet that a contact point faces, and the foot of its perpendicular at the last commit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PointPair {
    /// Master facet, none without contact.
    pub facet: Option<u32>,
    /// Parameters of the foot at the last commit: the anchor of slip.
    pub xi: [f64; 2],
}

/// Facets face each other if their normals are at least this much opposed (cosine).
const FACING: f64 = -0.2;
/// A point stays on its facet until it is this far beyond the edge (of the half facet), so that
/// two facets that share an edge do not pass it to and fro.
const STAY: f64 = 1e-3;
/// A point changes to a facet that it is on, or beyond by no more than rounding.
const ENTER: f64 = 1e-9;

/// For each slave facet the master facets that its points may come to face while surfaces move
/// less than the skin.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Candidates {
    start: Vec<u32>,
    facets: Vec<u32>,
}

impl Candidates {
    /// Finds all pairs of facets of different bodies that face each other, where the box of a slave
    /// facet's points `[facet]` comes within `radius` of the master facet [mm].
    pub fn find(
        slave: &Surface,
        points: &[Aabb],
        master: &Surface,
        x: &[[f64; 3]],
        radius: f64,
    ) -> Self {
        let boxes: Vec<Aabb> = (0..master.facets.len())
            .map(|f| Aabb::of(&master.corners(f, x)))
            .collect();
        let bvh = Bvh::build(&boxes);
        let normals: Vec<Vector3<f64>> = (0..master.facets.len())
            .map(|f| frame_at(&master.corners(f, x), [0.0; 2])[0])
            .collect();
        let mut result = Self {
            start: vec![0],
            facets: Vec::new(),
        };
        let (mut stack, mut found) = (Vec::new(), Vec::new());
        for f in 0..slave.facets.len() {
            let corners = slave.corners(f, x);
            let normal = frame_at(&corners, [0.0; 2])[0];
            found.clear();
            bvh.query(&boxes, &points[f].fattened(radius), &mut stack, |m| {
                let other = slave.body[f] != master.body[m as usize];
                if other && normal.dot(&normals[m as usize]) < FACING {
                    found.push(m);
                }
            });
            found.sort_unstable();
            result.facets.extend_from_slice(&found);
            result.start.push(result.facets.len() as u32);
        }
        result
    }

    /// Candidates of a slave facet, ascending.
    pub fn of(&self, slave: usize) -> &[u32] {
        &self.facets[self.range(slave)]
    }

    /// Where the candidates of a slave facet lie in the list of all.
    pub fn range(&self, slave: usize) -> std::ops::Range<usize> {
        self.start[slave] as usize..self.start[slave + 1] as usize
    }

    /// Number of pairs.
    pub fn len(&self) -> usize {
        self.facets.len()
    }

    /// True without any pair.
    pub fn is_empty(&self) -> bool {
        self.facets.is_empty()
    }
}

/// The facet that a point faces now: its present one while it stays on it, else the nearest
/// candidate that it is over, ties to the lowest number; none if it is over no facet or farther
/// than `radius` [mm] from all.
pub fn pair_point(
    point: &Vector3<f64>,
    present: Option<(u32, [f64; 2])>,
    candidates: &[u32],
    master: &Surface,
    x: &[[f64; 3]],
    radius: f64,
) -> Option<(u32, [f64; 2])> {
    if let Some((facet, xi)) = present {
        let foot = extend(point, &master.corners(facet as usize, x), xi);
        if let Some(foot) = foot.filter(|f| within(f.xi, STAY) && f.distance <= radius) {
            return Some((facet, foot.xi));
        }
    }
    let mut best: Option<(f64, u32, [f64; 2])> = None;
    for &facet in candidates {
        let Some(foot) = extend(point, &master.corners(facet as usize, x), [0.0; 2]) else {
            continue;
        };
        let nearer = best.is_none_or(|(d, _, _)| foot.distance < d);
        if within(foot.xi, ENTER) && foot.distance <= radius && nearer {
            best = Some((foot.distance, facet, foot.xi));
        }
    }
    best.map(|(_, facet, xi)| (facet, xi))
}

fn within(xi: [f64; 2], beyond: f64) -> bool {
    xi[0].abs() <= 1.0 + beyond && xi[1].abs() <= 1.0 + beyond
}

/// Components of a tangential vector in another frame (theory D: histories travel with the frame).
pub fn to_frame(v: [f64; 2], from: &[Vector3<f64>; 3], to: &[Vector3<f64>; 3]) -> [f64; 2] {
    let vector = from[1] * v[0] + from[2] * v[1];
    let result = Vector2::new(to[1].dot(&vector), to[2].dot(&vector));
    // The projection onto a turned plane would shorten it.
    let (before, after) = (v[0].hypot(v[1]), result.norm());
    if after > 0.0 {
        (result * (before / after)).into()
    } else {
        [0.0; 2]
    }
}
