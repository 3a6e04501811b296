//! Boundary facets of all bodies: element faces that no other element of the same body shares, and the sharp edges
//! between them. They follow from the mesh alone.

use std::collections::HashMap;

use nalgebra::Vector3;
use rustc_hash::FxHashMap;
use wythe_contact::frame_at;

use super::Mesh;
use crate::element::exterior::{corners, exterior_faces};

/// A convex edge of a body: its two faces are turned away from each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SharpEdge {
    /// End nodes.
    pub nodes: [u32; 2],
    /// Facets on both sides.
    pub facets: [u32; 2],
}

/// Boundary facets and sharp edges of all bodies, body by body.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoundaryFacets {
    /// Nodes of each facet, counter-clockwise seen from outside. `[facet][corner]`
    pub facets: Vec<[u32; 4]>,
    /// Body of each facet, ascending. `[facet]`
    pub body: Vec<u32>,
    /// Element behind each facet. `[facet]`
    pub element: Vec<u32>,
    /// Convex edges, in the order of their facets.
    pub edges: Vec<SharpEdge>,
}

/// Sine of the least angle between two faces with a sharp edge. Smaller angles belong to plane or curved faces of
/// several elements, whose nodes detect contact.
const SHARP: f64 = 0.02;

impl BoundaryFacets {
    /// Finds the boundary facets and edges of a mesh, whose `unit` is the body of each element.
    pub fn of(mesh: &Mesh) -> Self {
        let mut faces = exterior_faces(&mesh.elements, |e| mesh.unit[e]);
        faces.sort_by_key(|&(e, face)| (mesh.unit[e as usize], e, face));
        let mut skin = Self::default();
        for (e, face) in faces {
            skin.facets.push(corners(&mesh.elements[e as usize], face));
            skin.body.push(mesh.unit[e as usize]);
            skin.element.push(e);
        }
        skin.find_edges(&mesh.nodes);
        skin
    }

    /// Element behind each of some facets, whose nodes may stand in any order; none for a facet that is not on the
    /// boundary of a body.
    pub fn behind(&self, facets: &[[u32; 4]]) -> Vec<Option<u32>> {
        let sorted = |facet: &[u32; 4]| {
            let mut nodes = *facet;
            nodes.sort_unstable();
            nodes
        };
        let own = self.facets.iter().map(sorted);
        let element: FxHashMap<[u32; 4], u32> = own.zip(self.element.iter().copied()).collect();
        facets
            .iter()
            .map(|facet| element.get(&sorted(facet)).copied())
            .collect()
    }

    /// Sharp convex edges at positions `x` [mm] `[node]`.
    fn find_edges(&mut self, x: &[[f64; 3]]) {
        let mut sides: HashMap<(u32, [u32; 2]), Vec<u32>> = HashMap::new();
        let mut order = Vec::new();
        for (f, facet) in self.facets.iter().enumerate() {
            for i in 0..4 {
                let (a, b) = (facet[i], facet[(i + 1) % 4]);
                let key = (self.body[f], [a.min(b), a.max(b)]);
                let of = sides.entry(key).or_default();
                if of.is_empty() {
                    order.push(key);
                }
                of.push(f as u32);
            }
        }
        for key in order {
            // Where more than two faces meet in a line, the body touches itself. This is no edge.
            let &[p, q] = &sides[&key][..] else { continue };
            let edge = SharpEdge {
                nodes: key.1,
                facets: [p, q],
            };
            if self.is_convex(&edge, x) {
                self.edges.push(edge);
            }
        }
    }

    /// Whether the facets of an edge are turned away from each other.
    fn is_convex(&self, edge: &SharpEdge, x: &[[f64; 3]]) -> bool {
        let corners = |f: u32| self.facets[f as usize].map(|n| x[n as usize]);
        let [p, q] = edge.facets.map(corners);
        let normal = |c: &[[f64; 3]; 4]| frame_at(c, [0.0; 2])[0];
        let centre = |c: &[[f64; 3]; 4]| c.iter().map(|v| Vector3::from(*v)).sum::<Vector3<f64>>();
        let (n, m) = (normal(&p), normal(&q));
        let sharp = n.cross(&m).norm() > SHARP || n.dot(&m) < 0.0;
        // Each facet lies behind the other.
        sharp && n.dot(&(centre(&q) - centre(&p))) < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Bodies of unit cells with nodes of their own, each given by its lowest corner and its numbers of cells.
    fn blocks(of: &[([f64; 3], [usize; 3])]) -> Mesh {
        let mut mesh = Mesh::default();
        for (body, (low, cells)) in of.iter().enumerate() {
            let first = mesh.nodes.len();
            let [a, b, c] = *cells;
            let node =
                |i: usize, j: usize, k: usize| (first + i + (a + 1) * (j + (b + 1) * k)) as u32;
            for k in 0..=c {
                for j in 0..=b {
                    for i in 0..=a {
                        let at = [i, j, k];
                        mesh.nodes.push([0, 1, 2].map(|d| low[d] + at[d] as f64));
                    }
                }
            }
            for k in 0..c {
                for j in 0..b {
                    for i in 0..a {
                        let ring = |k: usize| {
                            [
                                node(i, j, k),
                                node(i + 1, j, k),
                                node(i + 1, j + 1, k),
                                node(i, j + 1, k),
                            ]
                        };
                        let [l, h] = [ring(k), ring(k + 1)];
                        mesh.elements
                            .push([l[0], l[1], l[2], l[3], h[0], h[1], h[2], h[3]]);
                        mesh.material.push(0);
                        mesh.unit.push(body as u32);
                        mesh.course.push(0);
                    }
                }
            }
        }
        mesh
    }

    #[test]
    fn a_block_has_six_faces_and_twelve_edges_however_it_is_meshed() {
        for cells in [[1, 1, 1], [3, 2, 4]] {
            let mesh = blocks(&[([0.0; 3], cells)]);
            let skin = BoundaryFacets::of(&mesh);
            let [a, b, c] = cells;
            assert_eq!(skin.facets.len(), 2 * (a * b + b * c + c * a));
            assert_eq!(skin.edges.len(), 4 * (a + b + c));
            // Normals point outwards: the divergence theorem gives the volume.
            let volume: f64 = skin
                .facets
                .iter()
                .map(|f| {
                    let x = f.map(|n| Vector3::from(mesh.nodes[n as usize]));
                    let area = (x[2] - x[0]).cross(&(x[3] - x[1])) * 0.5;
                    area.dot(&(x[0] + x[1] + x[2] + x[3])) / 12.0
                })
                .sum();
            assert!((volume - (a * b * c) as f64).abs() < 1e-9, "{volume}");
        }
    }

    #[test]
    fn touching_bodies_keep_their_boundary_and_a_joined_body_has_no_inner_face() {
        let mut mesh = blocks(&[([0.0; 3], [2, 1, 1]), ([2.0, 0.0, 0.0], [1, 1, 1])]);
        let skin = BoundaryFacets::of(&mesh);
        assert_eq!((skin.facets.len(), skin.edges.len()), (10 + 6, 16 + 12));
        assert!(skin.body.is_sorted());
        // L of three cells: the edge at the inner corner is not sharp.
        mesh = blocks(&[([0.0; 3], [2, 1, 2])]);
        mesh.material.pop();
        mesh.elements.pop();
        mesh.unit.pop();
        mesh.course.pop();
        let skin = BoundaryFacets::of(&mesh);
        assert_eq!(skin.facets.len(), 14);
        // 5 sharp edges are parallel to y.
        let along_y = skin.edges.iter().filter(|e| {
            let [a, b] = e.nodes.map(|n| mesh.nodes[n as usize]);
            a[1] != b[1]
        });
        assert_eq!(along_y.count(), 5);
    }
}
