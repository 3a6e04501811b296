//! Facets of the sides of walls.
//!
//! A side of a wall, `wall.front`, is made of the faces of the units that lie in it. Such a face may have facets that do
//! not: the unit within a head joint that is filled in part, the underside of the bed joint above it. And where walls
//! meet, one covers facets of the other, on which nothing can press.

use super::Bodies;
use crate::deck::name_registry::Place;
use crate::element::hexahedron::{area_vector, difference, norm};
use crate::element::inside::natural;
use wythe_contact::Aabb;

/// Part of the longest edge of a facet by which others may lie deeper in one side: coordinates are sums of sizes.
const IN_SIDE: f64 = 1e-3;
/// Distance before a facet at which another unit covers it, as a part of its longest edge.
const BEFORE: f64 = 1e-3;
/// Natural coordinate up to which a point counts as inside.
const INSIDE: f64 = 1.0 + 1e-6;

/// Points along each side of a facet at which it is tested.
const SAMPLES: usize = 10;

/// Element and nodes of a facet.
type Facet = (usize, [u32; 4]);

/// Units of walls, in which facets are searched.
pub(super) struct Units {
    /// Box around the unit, index of the body, elements. `[unit]`
    all: Vec<(Aabb, usize, Vec<usize>)>,
}

impl Bodies<'_> {
    /// Facets of a place; of a side of a wall those that lie in it. None of a whole body.
    pub(in crate::deck) fn facets(&self, place: Place) -> Vec<Facet> {
        let Some(face) = place.face else {
            return Vec::new();
        };
        let facets = &self.all[place.body].faces[face].facets;
        if !place.side {
            return facets.clone();
        }
        let corners = |facet: &Facet| facet.1.map(|n| self.mesh.nodes[n as usize]);
        let mut normal = [0.0; 3];
        for facet in facets {
            let area = area_vector(&corners(facet));
            (0..3).for_each(|d| normal[d] += area[d]);
        }
        let size = norm(normal);
        let depth = |facet: &Facet| centre(&corners(facet), normal) / size;
        let outermost = facets.iter().map(depth).fold(f64::NEG_INFINITY, f64::max);
        let within = |facet: &&Facet| outermost - depth(facet) <= IN_SIDE * edge(&corners(facet));
        facets.iter().filter(within).copied().collect()
    }

    /// Facets of a place of which no more than half is covered by a unit of another wall, and by how much their area
    /// exceeds that which is not covered [mm²].
    pub(in crate::deck) fn open_facets(&self, place: Place) -> (Vec<Facet>, f64) {
        let mut facets = self.facets(place);
        let own = place.side.then(|| self.wall_number(place.body)).flatten();
        let mut excess = 0.0;
        if let Some(own) = own.filter(|_| self.walls.len() > 1) {
            facets.retain(|facet| {
                let (covered, area) = self.covered(facet, own);
                let open = covered <= 0.5;
                excess += if open { covered } else { covered - 1.0 } * area;
                open
            });
        }
        (facets, excess)
    }

    /// Index of the wall of which a body is a unit.
    fn wall_number(&self, body: usize) -> Option<usize> {
        let mut walls = self.walls.iter();
        walls.position(|wall| wall.bodies.contains(&body))
    }

    /// Part of a facet before which a unit of a wall other than number `own` lies [-], and the area of the facet [mm²].
    fn covered(&self, facet: &Facet, own: usize) -> (f64, f64) {
        let corners = facet.1.map(|n| self.mesh.nodes[n as usize]);
        let area = area_vector(&corners);
        let (size, ahead) = (norm(area), BEFORE * edge(&corners));
        let mut reach = Aabb::of(&corners);
        for d in 0..3 {
            reach.min[d] -= ahead;
            reach.max[d] += ahead;
        }
        let near = |(around, body, _): &&(Aabb, usize, Vec<usize>)| {
            let meet =
                (0..3).all(|d| around.min[d] <= reach.max[d] && reach.min[d] <= around.max[d]);
            meet && !self.walls[own].bodies.contains(body)
        };
        let near: Vec<_> = self.units().all.iter().filter(near).collect();
        if near.is_empty() {
            return (0.0, size);
        }
        let inside = |point: [f64; 3]| {
            let mut elements = near.iter().flat_map(|(.., elements)| elements);
            elements.any(|e| {
                let at = natural(&self.mesh.corners(*e), point);
                at.is_some_and(|xi| xi.iter().all(|x| x.abs() <= INSIDE))
            })
        };
        let all = (0..SAMPLES).flat_map(|i| (0..SAMPLES).map(move |j| [i, j]));
        let covered = all.filter(|ij| {
            let [s, t] = ij.map(|i| (i as f64 + 0.5) / SAMPLES as f64);
            let weights = [(1.0 - s) * (1.0 - t), s * (1.0 - t), s * t, (1.0 - s) * t];
            inside([0, 1, 2].map(|d| {
                let at: f64 = corners.iter().zip(weights).map(|(x, w)| w * x[d]).sum();
                at + ahead * area[d] / size
            }))
        });
        (covered.count() as f64 / (SAMPLES * SAMPLES) as f64, size)
    }

    /// Units of all walls with their elements.
    fn units(&self) -> &Units {
        self.units.get_or_init(|| {
            let mut elements: Vec<Vec<usize>> = vec![Vec::new(); self.all.len()];
            for (e, unit) in self.mesh.unit.iter().enumerate() {
                if let Some(of) = elements.get_mut(*unit as usize) {
                    of.push(e);
                }
            }
            let bodies = self.walls.iter().flat_map(|wall| wall.bodies.clone());
            let all = bodies.map(|body| {
                let unit = &self.all[body];
                let nodes = unit.nodes.clone().map(|n| &self.mesh.nodes[n as usize]);
                let elements = std::mem::take(&mut elements[unit.number as usize]);
                (Aabb::of(nodes), body, elements)
            });
            Units { all: all.collect() }
        })
    }
}

/// Component of the middle of a facet along a vector, times the length of the vector.
fn centre(corners: &[[f64; 3]; 4], along: [f64; 3]) -> f64 {
    let dot = |x: &[f64; 3]| x[0] * along[0] + x[1] * along[1] + x[2] * along[2];
    corners.iter().map(dot).sum::<f64>() / 4.0
}

/// Longest edge of a facet [mm].
fn edge(corners: &[[f64; 3]; 4]) -> f64 {
    let edges = (0..4).map(|i| norm(difference(corners[(i + 1) % 4], corners[i])));
    edges.fold(0.0, f64::max)
}
