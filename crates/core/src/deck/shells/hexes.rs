//! Divides convex polyhedra into hexahedra with common nodes.
//!
//! * A polyhedron with eight corners and six quadrilaterals is one hexahedron, unless its faces are warped so much that
//!   it is folded at a corner.
//! * If three faces meet at each corner, each corner has one hexahedron: corner, middles of its three edges and of its
//!   three faces, middle of the body.
//! * Otherwise tetrahedra reach from the middle of the body to the triangles of the faces (those of a polygon reach
//!   from its middle to its edges), and each has four hexahedra, one at each corner.

use super::polyhedron::Polyhedron;
use crate::deck::import::has_volume;
use crate::element::hexahedron::{Corners, Face, PLACES, is_upright, norm};
use rustc_hash::FxHashMap;

/// Hexahedra of a polyhedron.
#[derive(Clone, Debug, Default, PartialEq)]
pub(in crate::deck) struct Hexes {
    /// Nodes [mm].
    pub(in crate::deck) nodes: Vec<[f64; 3]>,
    /// Connectivity in VTK's order.
    pub(in crate::deck) elements: Vec<[u32; 8]>,
    /// Elements and their sides in each face of the polyhedron. `[face]`
    pub(in crate::deck) faces: Vec<Vec<(u32, Face)>>,
}

/// Division of a polyhedron.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::deck) enum Division {
    /// It is a hexahedron: its corners, in the order in which its sides face the axes best.
    One(Corners),
    /// It has several hexahedra.
    Several(Hexes),
}

impl Polyhedron {
    /// Divides it into as few hexahedra as its kind allows.
    pub(in crate::deck) fn divided(&self) -> Division {
        let mut met = vec![0; self.corners.len()];
        for n in self.faces.iter().flatten() {
            met[*n as usize] += 1;
        }
        let is_simple = met.iter().all(|count| *count == 3);
        let quads = self.faces.iter().all(|face| face.len() == 4);
        if let (true, true, 8) = (is_simple, quads, self.corners.len())
            && let Some(corners) = self.hexahedron()
            && is_upright(&corners)
        {
            return Division::One(corners);
        }
        let mut divider = Divider::of(self);
        if is_simple {
            divider.at_corners();
            // Slivers may fold the hexahedra of corners, and not those of tetrahedra.
            if divider.hexes.first_folded().is_none() {
                return Division::Several(divider.hexes);
            }
            divider = Divider::of(self);
        }
        divider.by_tetrahedra();
        Division::Several(divider.hexes)
    }

    /// Number of hexahedra of [`Polyhedron::divided`] at most.
    pub(in crate::deck) fn most_hexes(&self) -> usize {
        4 * self.faces.iter().map(Vec::len).sum::<usize>()
    }

    /// The corners in VTK's order, so that ξ, η, ζ run along x, y, z as well as they can.
    fn hexahedron(&self) -> Option<Corners> {
        let mut best: Option<(f64, Corners)> = None;
        for face in &self.faces {
            for turn in 0..4 {
                // Seen from within, the bottom runs counter-clockwise.
                let bottom = [0, 1, 2, 3].map(|i| face[(turn + 4 - i) % 4]);
                let above = |n: u32| self.neighbours(n).find(|m| !face.contains(m));
                let top = [
                    above(bottom[0])?,
                    above(bottom[1])?,
                    above(bottom[2])?,
                    above(bottom[3])?,
                ];
                let [a, b, c, d] = bottom;
                let [e, f, g, h] = top;
                let corners = [a, b, c, d, e, f, g, h].map(|n| self.corners[n as usize]);
                let score = alignment(&corners);
                if best.is_none_or(|(other, _)| score > other + 1e-9) {
                    best = Some((score, corners));
                }
            }
        }
        best.map(|(_, corners)| corners)
    }

    /// Corners at the other ends of the edges of a corner.
    fn neighbours(&self, n: u32) -> impl Iterator<Item = u32> + '_ {
        self.faces.iter().filter_map(move |face| {
            let i = face.iter().position(|m| *m == n)?;
            Some(face[(i + 1) % face.len()])
        })
    }
}

/// Sum of the cosines between ξ, η, ζ and x, y, z.
fn alignment(corners: &Corners) -> f64 {
    let of = |d: usize| {
        let mut way = [0.0; 3];
        for (x, place) in corners.iter().zip(PLACES) {
            let sign = if place[d] == 1 { 1.0 } else { -1.0 };
            (0..3).for_each(|k| way[k] += sign * x[k]);
        }
        way[d] / norm(way)
    };
    (0..3).map(of).sum()
}

/// Points of a polyhedron are its corners, the middles of its faces, and its middle, in this order.
struct Divider<'a> {
    of: &'a Polyhedron,
    points: Vec<[f64; 3]>,
    /// Node in the middle of up to four points, by their sorted numbers.
    nodes: FxHashMap<[u32; 4], u32>,
    hexes: Hexes,
}

/// Number of no point.
const NONE: u32 = u32::MAX;

impl<'a> Divider<'a> {
    fn of(of: &'a Polyhedron) -> Self {
        let mut points = of.corners.clone();
        points.extend((0..of.faces.len()).map(|f| of.middle_of(f)));
        points.push(of.middle());
        let hexes = Hexes {
            faces: vec![Vec::new(); of.faces.len()],
            ..Hexes::default()
        };
        Self {
            of,
            points,
            nodes: FxHashMap::default(),
            hexes,
        }
    }

    fn middle_of_face(&self, f: usize) -> u32 {
        (self.of.corners.len() + f) as u32
    }

    fn middle(&self) -> u32 {
        self.points.len() as u32 - 1
    }

    /// The node in the middle of these points.
    fn node<const N: usize>(&mut self, of: [u32; N]) -> u32 {
        let mut key = [NONE; 4];
        key[..N].copy_from_slice(&of);
        key.sort_unstable();
        let next = self.hexes.nodes.len() as u32;
        let node = *self.nodes.entry(key).or_insert(next);
        if node == next {
            let of = || key[..N].iter().map(|n| self.points[*n as usize]);
            let x = [0, 1, 2].map(|d| of().map(|x| x[d]).sum::<f64>() / N as f64);
            self.hexes.nodes.push(x);
        }
        node
    }

    fn add(&mut self, element: [u32; 8], sides: &[(Face, usize)]) {
        let number = self.hexes.elements.len() as u32;
        self.hexes.elements.push(element);
        for (side, face) in sides {
            self.hexes.faces[*face].push((number, *side));
        }
    }

    /// One hexahedron at each corner.
    fn at_corners(&mut self) {
        let body = self.middle();
        for n in 0..self.of.corners.len() as u32 {
            // Faces at the corner, with the corners before and after it.
            let mut around = Vec::with_capacity(3);
            for (f, face) in self.of.faces.iter().enumerate() {
                if let Some(i) = face.iter().position(|m| *m == n) {
                    let count = face.len();
                    around.push((f, face[(i + count - 1) % count], face[(i + 1) % count]));
                }
            }
            let (bottom, a, b) = around[0];
            let other = |corner: u32| {
                around[1..]
                    .iter()
                    .find(|(_, p, q)| [*p, *q].contains(&corner))
            };
            let (Some(front), Some(left)) = (other(a), other(b)) else {
                continue;
            };
            let c = if front.1 == a { front.2 } else { front.1 };
            let (front, left) = (front.0, left.0);
            let [f_bottom, f_front, f_left] = [bottom, front, left].map(|f| self.middle_of_face(f));
            let element = [
                self.node([n]),
                self.node([n, a]),
                self.node([f_bottom]),
                self.node([n, b]),
                self.node([n, c]),
                self.node([f_front]),
                self.node([body]),
                self.node([f_left]),
            ];
            self.add(
                element,
                &[
                    (Face::Bottom, bottom),
                    (Face::Front, front),
                    (Face::Left, left),
                ],
            );
        }
    }

    /// Four hexahedra in each tetrahedron between the middle and a triangle of a face.
    fn by_tetrahedra(&mut self) {
        let of = self.of;
        for (f, face) in of.faces.iter().enumerate() {
            if let [p, q, r] = face[..] {
                self.tetrahedron([p, q, r], f);
                continue;
            }
            let middle = self.middle_of_face(f);
            for (i, p) in face.iter().enumerate() {
                self.tetrahedron([*p, face[(i + 1) % face.len()], middle], f);
            }
        }
    }

    /// Hexahedra between a triangle of face `f`, counter-clockwise seen from outside, and the middle.
    fn tetrahedron(&mut self, [p, q, r]: [u32; 3], f: usize) {
        let o = self.middle();
        // At each corner of the triangle the edges to the corner before it, the one after it, and the middle are
        // right-handed.
        for [n, a, b] in [[p, r, q], [q, p, r], [r, q, p]] {
            let element = self.at_corner(n, [a, b, o]);
            self.add(element, &[(Face::Bottom, f)]);
        }
        let element = self.at_corner(o, [p, q, r]);
        self.add(element, &[]);
    }

    /// The hexahedron of a tetrahedron at its corner `n`, whose edges lead to `a`, `b`, `c`.
    fn at_corner(&mut self, n: u32, [a, b, c]: [u32; 3]) -> [u32; 8] {
        [
            self.node([n]),
            self.node([n, a]),
            self.node([n, a, b]),
            self.node([n, b]),
            self.node([n, c]),
            self.node([n, a, c]),
            self.node([n, a, b, c]),
            self.node([n, b, c]),
        ]
    }
}

impl Hexes {
    /// Corners of an element [mm].
    pub(in crate::deck) fn corners(&self, e: usize) -> Corners {
        self.elements[e].map(|n| self.nodes[n as usize])
    }

    /// First element without a positive determinant of the Jacobian at each of its 2 × 2 × 2 integration points.
    pub(in crate::deck) fn first_folded(&self) -> Option<usize> {
        (0..self.elements.len()).find(|e| !has_volume(&self.corners(*e)))
    }

    /// Divides each element into n × n × n.
    pub(in crate::deck) fn refined(&self, n: u32) -> Self {
        let mut finer = Self {
            faces: vec![Vec::new(); self.faces.len()],
            ..Self::default()
        };
        let mut known: FxHashMap<Vec<(u32, u32)>, u32> = FxHashMap::default();
        let count = n as usize;
        for element in &self.elements {
            let mut grid = Vec::with_capacity((count + 1).pow(3));
            for k in 0..=n {
                for j in 0..=n {
                    for i in 0..=n {
                        grid.push(self.node(element, [i, j, k], n, &mut known, &mut finer.nodes));
                    }
                }
            }
            let at = |[i, j, k]: [usize; 3]| grid[(k * (count + 1) + j) * (count + 1) + i];
            for k in 0..count {
                for j in 0..count {
                    for i in 0..count {
                        finer
                            .elements
                            .push(PLACES.map(|p| at([i + p[0], j + p[1], k + p[2]])));
                    }
                }
            }
        }
        for (f, sides) in self.faces.iter().enumerate() {
            for (e, side) in sides {
                let (axis, high) = side.side();
                let layer = if high { count - 1 } else { 0 };
                for cell in 0..count.pow(3) {
                    let at = [cell % count, cell / count % count, cell / count / count];
                    if at[axis] == layer {
                        finer.faces[f].push((e * n.pow(3) + cell as u32, *side));
                    }
                }
            }
        }
        finer
    }

    /// The node at the fractions `at` / n of an element: a mean of its corners with whole weights, so that neighbouring
    /// elements have the same node.
    fn node(
        &self,
        element: &[u32; 8],
        at: [u32; 3],
        n: u32,
        known: &mut FxHashMap<Vec<(u32, u32)>, u32>,
        nodes: &mut Vec<[f64; 3]>,
    ) -> u32 {
        let weight = |place: [usize; 3]| -> u32 {
            (0..3)
                .map(|d| if place[d] == 1 { at[d] } else { n - at[d] })
                .product()
        };
        let mut key: Vec<(u32, u32)> = element
            .iter()
            .zip(PLACES)
            .map(|(m, p)| (*m, weight(p)))
            .collect();
        key.retain(|(_, weight)| *weight > 0);
        key.sort_unstable();
        let next = nodes.len() as u32;
        if let Some(node) = known.get(&key) {
            return *node;
        }
        let all = f64::from(n.pow(3));
        let x = [0, 1, 2].map(|d| {
            let sum: f64 = key
                .iter()
                .map(|(m, weight)| f64::from(*weight) * self.nodes[*m as usize][d])
                .sum();
            sum / all
        });
        nodes.push(x);
        known.insert(key, next);
        next
    }
}

/// Six lists of faces: those whose normals are nearest to −x, +x, −y, +y, −z, +z, in the order of [`Face::ALL`].
pub(in crate::deck) fn sides(of: &Polyhedron) -> [Vec<usize>; 6] {
    let mut sides: [Vec<usize>; 6] = Default::default();
    for f in 0..of.faces.len() {
        let normal = of.area_vector(f);
        // Nearly equal components count as equal, so that rounding does not decide.
        let largest = normal.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
        let axis = (0..3)
            .rev()
            .find(|d| normal[*d].abs() >= (1.0 - 1e-9) * largest)
            .unwrap_or(2);
        sides[2 * axis + usize::from(normal[axis] > 0.0)].push(f);
    }
    sides
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::hexahedron::{difference, dot};
    use crate::model::Mesh;

    fn regular(n: usize, apex: Option<f64>) -> Polyhedron {
        let on = |i: usize, z: f64| {
            let angle = std::f64::consts::TAU * i as f64 / n as f64;
            [2.0 * angle.cos(), 2.0 * angle.sin(), z]
        };
        let mut corners: Vec<[f64; 3]> = (0..n).map(|i| on(i, 0.0)).collect();
        let count = n as u32;
        let mut faces = vec![(0..count).rev().collect::<Vec<u32>>()];
        if let Some(z) = apex {
            corners.push([0.1, 0.2, z]);
            faces.extend((0..count).map(|i| vec![i, (i + 1) % count, count]));
        } else {
            corners.extend((0..n).map(|i| on(i, 1.5)));
            faces.push((count..2 * count).collect());
            faces.extend((0..count).map(|i| {
                let j = (i + 1) % count;
                vec![i, j, count + j, count + i]
            }));
        }
        Polyhedron { corners, faces }
    }

    fn check(of: &Polyhedron, hexes: &Hexes) {
        assert_eq!(hexes.first_folded(), None);
        let mesh = Mesh {
            nodes: hexes.nodes.clone(),
            elements: hexes.elements.clone(),
            ..Mesh::default()
        };
        let volume: f64 = (0..mesh.elements.len()).map(|e| mesh.volume(e)).sum();
        // The faces are plane, so that only rounding differs.
        assert!(
            (volume - of.volume()).abs() < 1e-12 * of.volume().max(1.0),
            "{volume} {}",
            of.volume()
        );
        // Facets of the faces are the exterior sides of the elements, and all interior sides are common.
        let mut sides: FxHashMap<[u32; 4], i32> = FxHashMap::default();
        for element in &hexes.elements {
            for (_, side) in Face::ALL {
                let mut nodes = side.corners().map(|c| element[c]);
                nodes.sort_unstable();
                *sides.entry(nodes).or_default() += 1;
            }
        }
        for (f, facets) in hexes.faces.iter().enumerate() {
            let mut area = 0.0;
            for (e, side) in facets {
                let nodes = side.corners().map(|c| hexes.elements[*e as usize][c]);
                let x = nodes.map(|n| hexes.nodes[n as usize]);
                let own = crate::element::hexahedron::area_vector(&x);
                assert!(dot(own, of.area_vector(f)) > 0.0, "facets look outwards");
                area += norm(own);
                let mut nodes = nodes;
                nodes.sort_unstable();
                assert_eq!(sides.remove(&nodes), Some(1));
            }
            assert!(
                (area - norm(of.area_vector(f))).abs() < 1e-12 * area,
                "{area}"
            );
        }
        assert!(sides.values().all(|count| *count == 2), "nodes are common");
    }

    #[test]
    fn a_box_is_one_hexahedron_in_the_order_of_the_axes() {
        let mut of = regular(4, None);
        let turn = std::f64::consts::FRAC_PI_4;
        for x in &mut of.corners {
            *x = crate::model::scene::turned(*x, [0.0, 0.0, 1.0], turn);
        }
        let Division::One(corners) = of.divided() else {
            panic!("no hexahedron");
        };
        assert!(crate::element::hexahedron::is_upright(&corners));
        let half = 2.0_f64.sqrt();
        for (x, place) in corners.iter().zip(PLACES) {
            let wanted = [
                place[0] as f64 * 2.0 * half - half,
                place[1] as f64 * 2.0 * half - half,
                place[2] as f64 * 1.5,
            ];
            assert!(norm(difference(*x, wanted)) < 1e-12, "{x:?} {wanted:?}");
        }
    }

    #[test]
    fn prisms_and_pyramids_have_conforming_hexahedra() {
        for (of, count) in [
            (regular(3, None), 6),
            (regular(5, None), 10),
            (regular(3, Some(1.0)), 4),
            // A square base makes four tetrahedra, and four sides.
            (regular(4, Some(2.0)), 32),
            (regular(6, Some(1.5)), 48),
        ] {
            let Division::Several(hexes) = of.divided() else {
                panic!("no hexahedron");
            };
            assert_eq!(hexes.elements.len(), count);
            assert!(count <= of.most_hexes());
            check(&of, &hexes);
            for n in [2, 3] {
                let finer = hexes.refined(n);
                assert_eq!(finer.elements.len(), count * (n as usize).pow(3));
                check(&of, &finer);
            }
        }
    }

    #[test]
    fn each_face_belongs_to_the_side_it_faces() {
        let sides = sides(&regular(4, Some(9.0)));
        assert_eq!(sides[Face::Bottom as usize], [0]);
        assert!(sides[Face::Top as usize].is_empty());
        assert_eq!(sides.iter().map(Vec::len).sum::<usize>(), 5);
    }
}
