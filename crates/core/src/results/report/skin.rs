//! Visible parts of the model: the boundary facets of the solids and the interface facets on them.

use std::collections::HashMap;

use crate::element::exterior::exterior_faces;
use crate::element::hex8::FACES;
use crate::results::vtkhdf::read::{RestMesh, RestSurface};

/// Number of points per interface facet in the file; the corners come first.
const FACET_POINTS: usize = 9;
/// An edge is drawn if the cosine between the normals of its faces is below this value.
const SHARP: f64 = 0.8;

/// Elements with boundary facets, and the nodes on these facets.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct BoundaryFacets {
    /// Nodes of the mesh on the boundary. `[boundary node]`
    pub nodes: Vec<u32>,
    /// Elements of the mesh with a boundary facet. `[boundary element]`
    pub elements: Vec<u32>,
    /// Boundary nodes at the corners of the elements; 0 at interior corners. `[boundary element]`
    pub corners: Vec<[u32; 8]>,
    /// Bit f is set if the face [`FACES`]`[f]` is on the boundary. `[boundary element]`
    pub faces: Vec<u8>,
    /// Edges of the bodies. `[edge][boundary node]`
    pub edges: Vec<[u32; 2]>,
}

impl BoundaryFacets {
    /// Boundary of a mesh; `None` if an element refers to a missing node.
    pub fn of(mesh: &RestMesh) -> Option<Self> {
        let is_known = |n: &u32| (*n as usize) < mesh.nodes.len();
        if !mesh.elements.iter().flatten().all(is_known) {
            return None;
        }
        let mut faces = vec![0_u8; mesh.elements.len()];
        for (e, face) in exterior_faces(&mesh.elements, |_| 0) {
            faces[e as usize] |= 1 << face;
        }
        let mut skin = Self::default();
        let mut place = vec![u32::MAX; mesh.nodes.len()];
        for (e, &bits) in faces.iter().enumerate().filter(|(_, bits)| **bits != 0) {
            let mut corners = [0; 8];
            for i in outer(bits).flatten() {
                let node = mesh.elements[e][i];
                let place = &mut place[node as usize];
                if *place == u32::MAX {
                    *place = skin.nodes.len() as u32;
                    skin.nodes.push(node);
                }
                corners[i] = *place;
            }
            skin.elements.push(e as u32);
            skin.corners.push(corners);
            skin.faces.push(bits);
        }
        skin.edges = skin.sharp_edges(mesh);
        Some(skin)
    }

    fn sharp_edges(&self, mesh: &RestMesh) -> Vec<[u32; 2]> {
        let position = |n: u32| mesh.nodes[self.nodes[n as usize] as usize];
        let mut met: HashMap<[u32; 2], ([f64; 3], bool)> = HashMap::new();
        let mut order = Vec::new();
        for (corners, &bits) in self.corners.iter().zip(&self.faces) {
            for face in outer(bits) {
                let nodes = face.map(|i| corners[i]);
                let normal = normal(nodes.map(position));
                for i in 0..4 {
                    let mut edge = [nodes[i], nodes[(i + 1) % 4]];
                    edge.sort_unstable();
                    met.entry(edge)
                        .and_modify(|(first, sharp)| *sharp = dot(*first, normal) < SHARP)
                        .or_insert_with(|| {
                            order.push(edge);
                            (normal, true)
                        });
                }
            }
        }
        order.retain(|edge| met.get(edge).is_some_and(|(_, sharp)| *sharp));
        order
    }

    /// Boundary nodes of the interface facets; `None` if the two grids do not belong together. Bodies in contact have
    /// nodes at the same positions. Of the bodies with a node at every corner, the one is chosen whose nodes moved
    /// with the facet.
    ///
    /// `moved`: displacements of the nodes of the mesh and of the points of the surface in some frame.
    pub fn facets(
        &self,
        mesh: &RestMesh,
        surface: &RestSurface,
        moved: (&[[f64; 3]], &[[f64; 3]]),
    ) -> Option<Vec<[u32; 4]>> {
        let (solid, interface) = moved;
        let points = &surface.points;
        if solid.len() != mesh.nodes.len() || interface.len() != points.len() {
            return None;
        }
        // Turns −0 into 0.
        let key = |x: [f64; 3]| x.map(|x| (x + 0.0).to_bits());
        let mut there: HashMap<[u64; 3], Vec<(u32, u32)>> = HashMap::new();
        let mut seen = vec![false; self.nodes.len()];
        for ((&e, corners), &bits) in self.elements.iter().zip(&self.corners).zip(&self.faces) {
            let unit = *mesh.unit.get(e as usize)?;
            for n in outer(bits).flatten().map(|i| corners[i]) {
                if !std::mem::replace(&mut seen[n as usize], true) {
                    let node = mesh.nodes[self.nodes[n as usize] as usize];
                    there.entry(key(node)).or_default().push((unit, n));
                }
            }
        }
        let (facets, rest) = points.as_chunks::<FACET_POINTS>();
        if !rest.is_empty() {
            return None;
        }
        let facet = |(f, points): (usize, &[[f64; 3]; FACET_POINTS])| {
            let corner = |k: usize| there.get(&key(points[k]));
            let of_unit = |unit: u32| {
                let mut nodes = [0; 4];
                let mut off = 0.0;
                for (k, node) in nodes.iter_mut().enumerate() {
                    *node = corner(k)?.iter().find(|(u, _)| *u == unit)?.1;
                    let u = solid[self.nodes[*node as usize] as usize];
                    let v = interface[FACET_POINTS * f + k];
                    off += (0..3).map(|i| (u[i] - v[i]).abs()).sum::<f64>();
                }
                Some((off, nodes))
            };
            let candidates = corner(0)?.iter().filter_map(|(unit, _)| of_unit(*unit));
            candidates
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .map(|(_, nodes)| nodes)
        };
        facets.iter().enumerate().map(facet).collect()
    }
}

/// Local nodes of the faces whose bits are set.
fn outer(bits: u8) -> impl Iterator<Item = [usize; 4]> {
    FACES
        .into_iter()
        .enumerate()
        .filter(move |(f, _)| bits >> f & 1 == 1)
        .map(|(_, face)| face)
}

/// Unit normal of a quad from its diagonals.
fn normal(x: [[f64; 3]; 4]) -> [f64; 3] {
    let d = |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|i| x[b][i] - x[a][i]) };
    let (a, b) = (d(0, 2), d(1, 3));
    let n = [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ];
    let length = dot(n, n).sqrt();
    n.map(|n| n / length)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// n × 1 × 1 cubes in a row, as one body.
    fn row(n: u32) -> RestMesh {
        let mut mesh = RestMesh::default();
        for x in 0..=n {
            for (y, z) in [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
                mesh.nodes.push([f64::from(x), y, z]);
            }
        }
        for e in 0..n {
            let (a, b) = (4 * e, 4 * e + 4);
            mesh.elements
                .push([a, b, b + 1, a + 1, a + 3, b + 3, b + 2, a + 2]);
            mesh.unit.push(0);
        }
        mesh
    }

    #[test]
    fn inner_faces_and_flat_edges_are_left_out() {
        let one = BoundaryFacets::of(&row(1)).unwrap();
        assert_eq!((one.faces[0], one.edges.len()), (0b11_1111, 12));
        let three = BoundaryFacets::of(&row(3)).unwrap();
        // +x is bit 3, −x bit 5.
        assert_eq!(three.faces, [0b11_0111, 0b01_0111, 0b01_1111]);
        // Four long edges of 3 each and four edges at each end.
        assert_eq!(three.edges.len(), 12 + 8);
        assert_eq!(three.nodes.len(), 16);
        for (face, (axis, sign)) in FACES.iter().zip([
            (2, -1.0),
            (2, 1.0),
            (1, -1.0),
            (0, 1.0),
            (1, 1.0),
            (0, -1.0),
        ]) {
            let mesh = row(1);
            let x = face.map(|i| mesh.nodes[mesh.elements[0][i] as usize]);
            let mut outward = [0.0; 3];
            outward[axis] = sign;
            assert_eq!(normal(x).map(|n| n + 0.0), outward);
        }
        let mut wrong = row(1);
        wrong.elements[0][3] = 99;
        assert_eq!(BoundaryFacets::of(&wrong), None);
    }

    #[test]
    fn a_facet_is_of_the_body_that_moves_with_it() {
        // Two bodies in contact at x = 1.
        let mut mesh = row(1);
        for x in row(1).nodes {
            mesh.nodes.push([x[0] + 1.0, x[1], x[2]]);
        }
        mesh.elements.push(mesh.elements[0].map(|n| n + 8));
        mesh.unit.push(1);
        let skin = BoundaryFacets::of(&mesh).unwrap();
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let mut points = corners.map(|[y, z]| [1.0, y, z]).to_vec();
        points.extend([[1.0, 0.5, 0.5]; 5]);
        let mut surface = RestSurface {
            points,
            quads: Vec::new(),
        };
        let mut solid = vec![[0.0; 3]; 16];
        solid[8..].fill([0.3, 0.0, 0.0]);
        for (u, first) in [([0.0; 3], 4), ([0.3, 0.0, 0.0], 8)] {
            let facets = skin
                .facets(&mesh, &surface, (&solid, &[u; FACET_POINTS]))
                .unwrap();
            let nodes = facets[0].map(|n| skin.nodes[n as usize]);
            assert_eq!(nodes, [first, first + 1, first + 2, first + 3]);
        }
        surface.points[0][0] = 7.0;
        assert_eq!(
            skin.facets(&mesh, &surface, (&solid, &[[0.0; 3]; FACET_POINTS])),
            None
        );
        assert_eq!(skin.facets(&mesh, &surface, (&solid, &[])), None);
    }
}
