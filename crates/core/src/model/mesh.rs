//! Nodes and hex8 elements.

use crate::element::hex8::CORNERS;
use crate::element::hexahedron::{norm, range};

/// Relative difference of parts of an element that are equal but for rounding.
const EVEN: f64 = 1e-9;
/// Weight by which a point must lie beside a plane of symmetry to count as outside it. Corner points lie 5e-7 beside
/// it.
const IN_THE_PLANE: f64 = 1e-9;

/// A mesh of hex8 elements. x runs along the wall's length, y through its thickness, z upwards.
///
/// Nodes of an element have the order of [`CORNERS`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Reference coordinates [mm]. `[node][xyz]`
    pub nodes: Vec<[f64; 3]>,
    /// Connectivity. `[element][local node]`
    pub elements: Vec<[u32; 8]>,
    /// Index into [`Model::materials`](super::Model::materials). `[element]`
    pub material: Vec<u16>,
    /// Body (representative element, or unit) of each element. `[element]`
    pub unit: Vec<u32>,
    /// Course of the unit, from 0 at the bottom. `[element]`
    pub course: Vec<u16>,
    /// Names of the bodies in the deck. `[unit]`
    pub names: Vec<String>,
    /// Walls of masonry, of which the bodies are units or lintels.
    pub walls: Vec<WallOfUnits>,
    /// Image nodes beyond planes of symmetry, of elements that lie across a plane and of joints in a plane. Ascending by
    /// node.
    pub reflected: Vec<Reflected>,
}

/// A wall of masonry.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct WallOfUnits {
    /// Name in the deck.
    pub name: String,
    /// Its bodies, ascending.
    pub units: Vec<u32>,
}

/// An image node in planes of symmetry: u = sign ∘ u_of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflected {
    /// Image node.
    pub node: u32,
    /// Original node, itself no image.
    pub of: u32,
    /// −1 along the normals of the planes between both, else 1. `[xyz]`
    pub sign: [f64; 3],
}

impl Mesh {
    /// Coordinates of the eight nodes of element `e` [mm].
    pub fn corners(&self, e: usize) -> [[f64; 3]; 8] {
        self.elements[e].map(|n| self.nodes[n as usize])
    }

    /// Name of a body, or its number if the mesh has no names.
    pub fn called(&self, unit: u32) -> String {
        let name = self.names.get(unit as usize);
        name.filter(|name| !name.is_empty())
            .map_or_else(|| format!("unit {unit}"), Clone::clone)
    }

    /// Name of the body of an element.
    pub fn body_of(&self, element: usize) -> String {
        self.called(self.unit[element])
    }

    /// Smallest edge of the box around each body [mm]; infinite for a number without elements. `[unit]`
    pub fn smallest_edges(&self) -> Vec<f64> {
        let units = self.unit.iter().max().map_or(0, |unit| *unit as usize + 1);
        let mut boxes =
            vec![[[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]]; units.max(self.names.len())];
        for (nodes, unit) in self.elements.iter().zip(&self.unit) {
            let [low, high] = &mut boxes[*unit as usize];
            for x in nodes.map(|n| self.nodes[n as usize]) {
                for i in 0..3 {
                    (low[i], high[i]) = (low[i].min(x[i]), high[i].max(x[i]));
                }
            }
        }
        let edge = |[low, high]: [[f64; 3]; 2]| {
            let edges = (0..3).map(|i| {
                if low[i] <= high[i] {
                    high[i] - low[i]
                } else {
                    f64::INFINITY
                }
            });
            edges.fold(f64::INFINITY, f64::min)
        };
        boxes.into_iter().map(edge).collect()
    }

    /// Image data of a node, if it is an image.
    pub fn reflected(&self, node: u32) -> Option<&Reflected> {
        let at = self.reflected.binary_search_by_key(&node, |r| r.node);
        at.ok().map(|at| &self.reflected[at])
    }

    /// Part of an element or facet with these nodes that counts: one half for each plane of symmetry that it lies
    /// across.
    pub fn share(&self, nodes: &[u32]) -> f64 {
        if self.reflected.is_empty() {
            return 1.0;
        }
        let mut part = [1.0_f64; 3];
        for image in nodes.iter().filter_map(|n| self.reflected(*n)) {
            for (part, sign) in part.iter_mut().zip(image.sign) {
                if sign < 0.0 {
                    *part = 0.5;
                }
            }
        }
        part.iter().product()
    }

    /// Part of a contact point that counts, from the weights of the facet's nodes at it. On a facet across a plane of
    /// symmetry it is 0 beyond the plane, because the image of the point is there, ½ in the plane, and 1 before it.
    /// `planes`: planes in which the facet itself lies, by their normals.
    pub fn point_share(&self, facet: &[u32; 4], weights: &[f64; 4], planes: [bool; 3]) -> f64 {
        if self.reflected.is_empty() {
            return 1.0;
        }
        let place = |n: u32| match self.reflected(n) {
            Some(image) => (image.of, image.sign),
            None => (n, [1.0; 3]),
        };
        let places = facet.map(place);
        let part = |d: usize| {
            if planes[d] {
                return 0.5;
            }
            // Each node beyond the plane has its original in the facet, at the same distance. The difference of their
            // weights gives the side of the point.
            let beyond = |(of, sign): (u32, [f64; 3])| {
                let mut image = sign;
                image[d] = -sign[d];
                match sign[d] < 0.0 {
                    true => 1.0,
                    false if places.contains(&(of, image)) => -1.0,
                    false => 0.0,
                }
            };
            let sides = places.map(beyond);
            if !sides.contains(&1.0) {
                return 1.0;
            }
            let side: f64 = sides.iter().zip(weights).map(|(side, w)| side * w).sum();
            match side {
                side if side > IN_THE_PLANE => 0.0,
                side if side < -IN_THE_PLANE => 1.0,
                _ => 0.5,
            }
        };
        (0..3).map(part).product()
    }

    /// Lowest and highest coordinate of the solids along an axis [mm]. Infinite without solids.
    pub fn extent(&self, axis: usize) -> [f64; 2] {
        let nodes = self.elements.as_flattened().iter();
        range(nodes.map(|n| self.nodes[*n as usize][axis]))
    }

    /// Diagonal of the box around the solids [mm].
    pub(crate) fn diagonal(&self) -> f64 {
        norm([0, 1, 2].map(|d| {
            let [low, high] = self.extent(d);
            high - low
        }))
    }

    /// Nodes of the solids, ascending: all nodes but those of mirrors, which belong to no element.
    pub(crate) fn nodes_of_solids(&self) -> Vec<u32> {
        let mut is_solid = vec![false; self.nodes.len()];
        for n in self.elements.as_flattened() {
            is_solid[*n as usize] = true;
        }
        (0..self.nodes.len() as u32)
            .filter(|n| is_solid[*n as usize])
            .collect()
    }

    /// Volume ∫ det J of element `e` [mm³], which 2×2×2 Gauss points integrate exactly.
    pub fn volume(&self, e: usize) -> f64 {
        self.volume_and_moment(e).0
    }

    /// Centroid ∫ x det J/volume of element `e` [mm], exact as its volume.
    pub fn centroid(&self, e: usize) -> [f64; 3] {
        let (volume, moment) = self.volume_and_moment(e);
        moment.map(|moment| moment / volume)
    }

    /// Volumes ∫ N det J for which the nodes of element `e` stand [mm³], exact as its volume. Equal parts of a
    /// parallelepiped are so to the last digit.
    pub fn nodal_volumes(&self, e: usize) -> [f64; 8] {
        let share = self.volume(e) / 8.0;
        let mut sums = [0.0; 8];
        for (weights, determinant) in self.gauss_points(e) {
            for (sum, weight) in sums.iter_mut().zip(weights) {
                *sum += determinant * weight;
            }
        }
        if sums.iter().all(|sum| (sum - share).abs() <= EVEN * share) {
            [share; 8]
        } else {
            sums
        }
    }

    fn volume_and_moment(&self, e: usize) -> (f64, [f64; 3]) {
        let x = self.corners(e);
        let (mut volume, mut moment) = (0.0, [0.0; 3]);
        for (weights, determinant) in self.gauss_points(e) {
            let mut at = [0.0; 3];
            for (weight, x) in weights.iter().zip(x) {
                for (at, x) in at.iter_mut().zip(x) {
                    *at += weight * x;
                }
            }
            volume += determinant;
            for (moment, at) in moment.iter_mut().zip(at) {
                *moment += determinant * at;
            }
        }
        (volume, moment)
    }

    /// Weights of the nodes and det J of element `e` at its 2×2×2 Gauss points.
    fn gauss_points(&self, e: usize) -> impl Iterator<Item = ([f64; 8], f64)> {
        let x = self.corners(e);
        let g = 1.0 / 3.0_f64.sqrt();
        (0..8_usize).map(move |p| {
            let [r, s, t] =
                [p & 1, (p >> 1) & 1, p >> 2].map(|high| if high == 1 { g } else { -g });
            // ∂x/∂ξ along each local axis, [axis][xyz].
            let mut jacobian = [[0.0; 3]; 3];
            let mut weights = [0.0; 8];
            for (n, [a, b, c]) in CORNERS.iter().enumerate() {
                weights[n] = 0.125 * (1.0 + a * r) * (1.0 + b * s) * (1.0 + c * t);
                let slopes = [
                    a * (1.0 + b * s) * (1.0 + c * t),
                    b * (1.0 + a * r) * (1.0 + c * t),
                    c * (1.0 + a * r) * (1.0 + b * s),
                ];
                for (row, slope) in jacobian.iter_mut().zip(slopes) {
                    for d in 0..3 {
                        row[d] += 0.125 * slope * x[n][d];
                    }
                }
            }
            let [[a, b, c], [d, e, f], [g, h, i]] = jacobian;
            let determinant = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g);
            (weights, determinant)
        })
    }
}
