//! Where the joints of dry faces end: a pivot lies at the end of a face, and contact points have to lie there, too.
//!
//! ```text
//!        ┌───────┐           facet f ends at its own face's edge on the left; two faces above it
//!   ┌────┴──┬────┴──┐        end within it: it is divided there, with Lobatto points (theory/joint.md)
//!   │       │       │        in each part
//!   ├───────┴───────┤ f
//! ```

use super::general::normal;
use super::surfaces::ContactSurfaces;
use nalgebra::Vector3;
use std::collections::BTreeMap;
use wythe_contact::{Aabb, Bvh, Part, PointsAlong};

/// Cosine of the angle up to which neighbours belong to one face of a body, and of that by which two faces may be turned
/// against each other where they meet: 26 degrees.
const ONE_FACE: f64 = 0.9;
/// Distance of parameters on [−1, 1] below which two ends are one.
const ONE_END: f64 = 0.02;
/// Largest distance of two faces that meet, over the size of the facet.
const MEET: f64 = 0.02;
/// Largest number of ends within a facet along one of its directions. More are a mesh, no faces of units.
const MOST_ENDS: usize = 8;

/// Where faces end at a facet along one of its directions.
#[derive(Clone, Debug, Default, PartialEq)]
struct Ends {
    /// Whether a face ends at an end of the facet.
    outer: bool,
    /// Parameters between the ends of the facet at which opposite faces end, ascending.
    within: Vec<f64>,
}

/// A part of a facet along one of its directions: middle, half of its length, and its points.
type Piece = (f64, f64, PointsAlong);

impl Ends {
    /// Stretches between ends, and the number of equal parts of each, of a direction that is divided into `count` parts.
    /// Where faces end, parts are halved.
    fn stretches(&self, count: u32) -> impl Iterator<Item = ([f64; 2], f64)> {
        let halves = if self.has_any() { 2.0 } else { 1.0 };
        let from = std::iter::once(-1.0).chain(self.within.iter().copied());
        let to = self.within.iter().copied().chain(std::iter::once(1.0));
        from.zip(to).map(move |(from, to)| {
            let cells = (0.5 * (to - from) * f64::from(count)).round().max(1.0);
            ([from, to], halves * cells)
        })
    }

    fn has_any(&self) -> bool {
        self.outer || !self.within.is_empty()
    }

    /// Number of [pieces](Self::pieces).
    fn number(&self, count: u32) -> f64 {
        self.stretches(count).map(|(_, parts)| parts).sum()
    }

    /// Pieces of a direction that is divided into `count` parts. Where faces end, they have Lobatto points.
    fn pieces(&self, count: u32) -> Vec<Piece> {
        let mut pieces = Vec::new();
        for ([from, to], parts) in self.stretches(count) {
            let half = 0.5 * (to - from) / parts;
            pieces.extend((0..parts as u32).map(|k| {
                let points = match (self.has_any(), k % 2) {
                    (false, _) => PointsAlong::Gauss,
                    (true, 0) => PointsAlong::FirstHalf,
                    (true, _) => PointsAlong::SecondHalf,
                };
                (f64::from(2 * k + 1) * half + from, half, points)
            }));
        }
        pieces
    }

    /// Adds the parameter of an end of a face that lies opposite.
    fn add(&mut self, at: f64) {
        if at.abs() > 1.0 - ONE_END {
            self.outer |= at.abs() < 1.0 + ONE_END;
        } else if self.within.iter().all(|known| (known - at).abs() > ONE_END) {
            self.within.push(at);
        }
    }
}

/// Parts into which slave facets are divided. `[facet]`
pub(crate) struct Division(Vec<([Ends; 2], [u32; 2])>);

impl Division {
    /// Division of facets into these numbers of parts along their two directions, and where faces end at the `dry` ones,
    /// for nodes at `x` [mm].
    pub(super) fn new(
        contact: &ContactSurfaces,
        counts: impl Iterator<Item = [u32; 2]>,
        dry: &[usize],
        x: &[[f64; 3]],
    ) -> Self {
        let mut ends = ends(contact, dry, x);
        let of = |(f, counts): (usize, [u32; 2])| (ends.remove(&f).unwrap_or_default(), counts);
        Self(counts.enumerate().map(of).collect())
    }

    /// Number of contact points.
    pub(crate) fn points(&self) -> f64 {
        let all = self.0.iter();
        all.map(|([xi, eta], [m, n])| 4.0 * xi.number(*m) * eta.number(*n))
            .sum()
    }

    /// Whether every facet is one part.
    pub(super) fn is_whole(&self) -> bool {
        let mut all = self.0.iter();
        all.all(|([xi, eta], [m, n])| xi.number(*m) * eta.number(*n) == 1.0)
    }

    /// Parts of a facet, row by row, and the points of each along its two directions.
    pub(super) fn parts(&self, facet: usize) -> Vec<(Part, [PointsAlong; 2])> {
        let ([xi, eta], [m, n]) = &self.0[facet];
        let [along_xi, along_eta] = [xi.pieces(*m), eta.pieces(*n)];
        let part = |xi: &Piece, eta: &Piece| {
            let part = Part {
                middle: [xi.0, eta.0],
                half: [xi.1, eta.1],
            };
            (part, [xi.2, eta.2])
        };
        let rows = along_eta.iter();
        rows.flat_map(|eta| along_xi.iter().map(move |xi| part(xi, eta)))
            .collect()
    }
}

/// Ends of faces at these dry slave facets, for nodes at `x` [mm].
fn ends(contact: &ContactSurfaces, dry: &[usize], x: &[[f64; 3]]) -> BTreeMap<usize, [Ends; 2]> {
    if dry.is_empty() {
        return BTreeMap::new();
    }
    let of = |f: &usize| (contact.slave_facets[*f], contact.slave_body[*f]);
    let own = Edges::of(dry.iter().map(of), x);
    let masters = contact.master_facets.iter().zip(&contact.master_body);
    let opposite = Edges::of(masters.map(|(nodes, body)| (*nodes, *body)), x);
    let boxes: Vec<Aabb> = opposite
        .ends
        .iter()
        .map(|edge| Aabb::of(&edge.at))
        .collect();
    let tree = Bvh::build(&boxes);
    let mut stack = Vec::new();
    let of_facet = |(k, &f): (usize, &usize)| {
        let facet = Facet::of(&contact.slave_facets[f].map(|n| x[n as usize]));
        // Sides 1 and 3 lie at the ends of the first direction.
        let mut ends = [[1, 3], [0, 2]].map(|sides| Ends {
            outer: sides.iter().any(|side| own.is_end[4 * k + side]),
            within: Vec::new(),
        });
        let near = facet.bounds.fattened(MEET * facet.size);
        tree.query(&boxes, &near, &mut stack, |edge| {
            let edge = &opposite.ends[edge as usize];
            if edge.body != contact.slave_body[f]
                && let Some((d, at)) = facet.crossed_by(edge)
            {
                ends[d].add(at);
            }
        });
        for ends in &mut ends {
            ends.within.sort_by(f64::total_cmp);
            if ends.within.len() > MOST_ENDS {
                ends.within.clear();
            }
        }
        (f, ends)
    };
    dry.iter().enumerate().map(of_facet).collect()
}

/// An edge at which a face ends.
struct Edge {
    at: [[f64; 3]; 2],
    body: u32,
    /// Normal of its face.
    normal: Vector3<f64>,
}

/// Edges of facets at which faces of bodies end.
struct Edges {
    ends: Vec<Edge>,
    /// Whether each side of each facet is one. `[4 facet + side]`
    is_end: Vec<bool>,
}

impl Edges {
    /// Edges of facets with their bodies.
    fn of(facets: impl Iterator<Item = ([u32; 4], u32)>, x: &[[f64; 3]]) -> Self {
        let facets: Vec<_> = facets.collect();
        let key = |(nodes, body): &([u32; 4], u32), k: usize| {
            let (a, b) = (nodes[k], nodes[(k + 1) % 4]);
            (*body, a.min(b), a.max(b))
        };
        let mut at: BTreeMap<(u32, u32, u32), Vec<usize>> = BTreeMap::new();
        for (f, facet) in facets.iter().enumerate() {
            for k in 0..4 {
                at.entry(key(facet, k)).or_default().push(f);
            }
        }
        let normals: Vec<_> = facets
            .iter()
            .map(|(nodes, _)| normal(&nodes.map(|n| x[n as usize])))
            .collect();
        let mut edges = Self {
            ends: Vec::new(),
            is_end: Vec::with_capacity(4 * facets.len()),
        };
        for (f, facet) in facets.iter().enumerate() {
            for k in 0..4 {
                let mut others = at
                    .get(&key(facet, k))
                    .into_iter()
                    .flatten()
                    .filter(|o| **o != f);
                let goes_on = others.any(|other| normals[*other].dot(&normals[f]) > ONE_FACE);
                edges.is_end.push(!goes_on);
                if !goes_on {
                    edges.ends.push(Edge {
                        at: [facet.0[k], facet.0[(k + 1) % 4]].map(|n| x[n as usize]),
                        body: facet.1,
                        normal: normals[f],
                    });
                }
            }
        }
        edges
    }
}

/// A facet and its parameters.
struct Facet {
    /// Corner at (−1, −1).
    origin: Vector3<f64>,
    /// Gradients of ξ and η over their half ranges; none if the facet is no parallelogram.
    gradients: Option<[Vector3<f64>; 2]>,
    normal: Vector3<f64>,
    bounds: Aabb,
    /// Longer of its sides [mm].
    size: f64,
}

impl Facet {
    fn of(corners: &[[f64; 3]; 4]) -> Self {
        let [a, b, c, d] = corners.map(Vector3::from);
        let (along, across) = (b - a, d - a);
        let size = along.norm().max(across.norm());
        let up = along.cross(&across);
        let is_even = (c - b - across).norm() <= ONE_END * size && up.norm() > 0.0;
        Self {
            origin: a,
            gradients: is_even.then(|| {
                let area = up.norm_squared();
                [across.cross(&up) / area, up.cross(&along) / area]
            }),
            normal: normal(corners),
            bounds: Aabb::of(corners),
            size,
        }
    }

    /// Direction in which an edge of an opposite face divides the facet, and its parameter there; none if it lies
    /// beside the facet, or askew to its sides.
    fn crossed_by(&self, edge: &Edge) -> Option<(usize, f64)> {
        let gradients = self.gradients?;
        let from = edge.at.map(|x| Vector3::from(x) - self.origin);
        let apart = from.map(|x| x.dot(&self.normal).abs());
        let meets = apart[0].max(apart[1]) <= MEET * self.size;
        if !meets || edge.normal.dot(&self.normal) > -ONE_FACE {
            return None;
        }
        let [xi, eta] = gradients.map(|g| from.map(|x| 2.0 * x.dot(&g) - 1.0));
        [(0, xi, eta), (1, eta, xi)]
            .into_iter()
            .find_map(|(d, at, other)| {
                let is_straight = (at[0] - at[1]).abs() <= ONE_END;
                let (low, high) = (other[0].min(other[1]), other[0].max(other[1]));
                let passes = low < 1.0 - ONE_END && high > ONE_END - 1.0;
                (is_straight && passes).then(|| (d, 0.5 * (at[0] + at[1])))
            })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faces_that_end_within_a_facet_divide_it() {
        let facet = Facet::of(&[
            [0.0; 3],
            [100.0, 0.0, 0.0],
            [100.0, 50.0, 0.0],
            [0.0, 50.0, 0.0],
        ]);
        let edge = |from: [f64; 3], to: [f64; 3], up: f64| Edge {
            at: [from, to],
            body: 1,
            normal: Vector3::new(0.0, 0.0, up),
        };
        let across = edge([25.0, -10.0, 0.0], [25.0, 60.0, 0.0], -1.0);
        assert_eq!(facet.crossed_by(&across), Some((0, -0.5)));
        // A face that looks the same way, one that is away, one beside the facet, one askew.
        for beside in [
            edge([25.0, -10.0, 0.0], [25.0, 60.0, 0.0], 1.0),
            edge([25.0, -10.0, 5.0], [25.0, 60.0, 5.0], -1.0),
            edge([25.0, 50.0, 0.0], [25.0, 60.0, 0.0], -1.0),
            edge([25.0, 0.0, 0.0], [75.0, 50.0, 0.0], -1.0),
        ] {
            assert_eq!(facet.crossed_by(&beside), None);
        }
        let mut ends = Ends::default();
        assert_eq!(ends.pieces(1), [(0.0, 1.0, PointsAlong::Gauss)]);
        ends.add(-0.5);
        ends.add(-0.495);
        let pieces = ends.pieces(1);
        let (first, second) = (PointsAlong::FirstHalf, PointsAlong::SecondHalf);
        let all = [
            (-0.875, 0.125, first),
            (-0.625, 0.125, second),
            (-0.125, 0.375, first),
            (0.625, 0.375, second),
        ];
        assert_eq!(pieces, all);
        let division = Division(vec![([ends.clone(), Ends::default()], [1, 3])]);
        assert_eq!((division.points(), division.parts(0).len()), (48.0, 12));
        assert!(!division.is_whole());
        ends.add(1.01);
        assert!(ends.outer);
    }
}
