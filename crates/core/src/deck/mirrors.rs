//! Mirrors: facets that represent the other half of a wall where a plane of symmetry cuts its joints.

use super::bodies::Bodies;
use super::masonry;
use super::quantity::Quantity;
use super::symmetry::Plane;
use crate::element::hexahedron::{Face, range};

/// A facet in a plane of symmetry that faces the units which end in the middle of a joint.
pub(super) struct Mirror {
    /// Its nodes, which belong to no element, counter-clockwise seen from the wall.
    pub(super) facet: [u32; 4],
    /// Axis normal to it.
    pub(super) axis: usize,
    /// Face of the units in contact with it.
    pub(super) face: Face,
    /// Index of the wall.
    pub(super) wall: usize,
}

impl Bodies<'_> {
    /// Adds a mirror for each plane of symmetry and each wall whose joints it cuts. Mirrors extend beyond the units
    /// by the largest size of a unit, so that units stay in front of them.
    pub(super) fn lay_mirrors(&mut self) {
        for plane in Plane::all(self.deck) {
            let d = plane.axis;
            for (w, wall) in self.walls.iter().enumerate() {
                let meets = |unit: &&masonry::Unit| unit.mirror[d];
                if !wall.units.iter().any(|unit| meets(&unit)) {
                    continue;
                }
                let (u, v) = ((d + 1) % 3, (d + 2) % 3);
                let reach = |axis: usize| {
                    let units = wall.units.iter().filter(meets);
                    let [low, high] = range(units.flat_map(|unit| unit.all[axis]));
                    let margin = wall
                        .wall
                        .unit
                        .map(Quantity::get)
                        .into_iter()
                        .fold(0.0, f64::max);
                    [low - margin, high + margin]
                };
                let (a, b) = (reach(u), reach(v));
                let first = self.mesh.nodes.len() as u32;
                for [i, j] in [[0, 0], [1, 0], [1, 1], [0, 1]] {
                    let mut x = [0.0; 3];
                    (x[d], x[u], x[v]) = (plane.at, a[i], b[j]);
                    self.mesh.nodes.push(x);
                }
                let mut facet = [first, first + 1, first + 2, first + 3];
                if !plane.above {
                    facet.swap(1, 3); // the mirror faces the units below
                }
                self.mirrors.push(Mirror {
                    facet,
                    axis: d,
                    face: Face::ALL[2 * d + usize::from(!plane.above)].1,
                    wall: w,
                });
            }
        }
        self.velocity.resize(self.mesh.nodes.len(), [0.0; 3]);
    }

    /// Returns whether a body ends in the middle of a joint that a plane normal to this axis cuts.
    pub(super) fn mirrors_at(&self, body: usize, axis: usize) -> bool {
        let wall = self.wall_of(body);
        wall.is_some_and(|wall| wall.units[body - wall.bodies.start].mirror[axis])
    }
}
