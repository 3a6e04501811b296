//! A hexahedron by its eight corners or by a grid of nodes, cut into hex8; and its six faces.

use super::Mesh;

/// Corners in VTK's order [mm]: (−,−,−) (+,−,−) (+,+,−) (−,+,−), then the same four above.
/// `[corner][xyz]`
pub type Corners = [[f64; 3]; 8];

/// A face of a block, by its outward normal where the block is not turned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Face {
    /// −x.
    Left,
    /// +x.
    Right,
    /// −y.
    Front,
    /// +y.
    Back,
    /// −z.
    Bottom,
    /// +z.
    Top,
}

impl Face {
    /// All, with their names in a deck.
    pub const ALL: [(&'static str, Self); 6] = [
        ("left", Self::Left),
        ("right", Self::Right),
        ("front", Self::Front),
        ("back", Self::Back),
        ("bottom", Self::Bottom),
        ("top", Self::Top),
    ];

    /// Axis of the normal, and whether it points along it.
    fn side(self) -> (usize, bool) {
        let index = self as usize;
        (index / 2, index % 2 == 1)
    }
}

/// Local places of the corners in VTK's order: which side along ξ, η, ζ. `[corner][ξηζ]`
pub(super) const PLACES: [[usize; 3]; 8] = [
    [0, 0, 0],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 0, 1],
    [1, 1, 1],
    [0, 1, 1],
];

/// Whether the trilinear map of these corners has a positive volume at each of them: at a corner the
/// determinant is the triple product of its three edges.
pub(super) fn is_upright(corners: &Corners) -> bool {
    let at = |place: [usize; 3]| {
        let corner = PLACES.iter().position(|p| *p == place).unwrap_or_default();
        corners[corner]
    };
    PLACES.iter().all(|&place| {
        let edge = |d: usize| {
            let (mut from, mut to) = (place, place);
            (from[d], to[d]) = (0, 1);
            difference(at(to), at(from))
        };
        dot(cross(edge(0), edge(1)), edge(2)) > 0.0
    })
}

/// What a block looks like.
#[derive(Clone, Debug)]
pub enum Shape {
    /// Its corners [mm]; all else lies between them.
    Hexahedron(Corners),
    /// The nodes of its grid [mm], along ξ first, then η, ζ. `[node][xyz]`
    Grid(Vec<[f64; 3]>),
}

impl Shape {
    /// The same shape elsewhere.
    #[must_use]
    pub fn map(&self, to: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        match self {
            Self::Hexahedron(corners) => Self::Hexahedron(corners.map(to)),
            Self::Grid(nodes) => Self::Grid(nodes.iter().copied().map(to).collect()),
        }
    }
}

/// A block of the mesh: a regular grid of nodes and elements.
#[derive(Clone, Debug)]
pub struct Placed {
    /// Name in the deck, with the numbers of its copy.
    pub name: String,
    /// Shape at rest.
    pub shape: Shape,
    /// Elements along ξ, η, ζ.
    pub cells: [usize; 3],
    /// Number of the body.
    pub body: u32,
    first_node: usize,
    first_element: usize,
}

impl Placed {
    /// Cuts a hexahedron into cells by trilinear interpolation of its corners and appends them, or
    /// the cells of a grid, to the mesh. Neighbours with common corners have common nodes in the same
    /// places, to the bit.
    pub fn append(
        mesh: &mut Mesh,
        name: String,
        shape: Shape,
        cells: [usize; 3],
        material: u16,
    ) -> Self {
        let body = mesh.unit.last().map_or(0, |u| u + 1);
        let placed = Self {
            name,
            shape,
            cells,
            body,
            first_node: mesh.nodes.len(),
            first_element: mesh.elements.len(),
        };
        let [nx, ny, nz] = cells;
        let part = |i: usize, n: usize| i as f64 / n as f64;
        match &placed.shape {
            Shape::Grid(nodes) => mesh.nodes.extend(nodes),
            Shape::Hexahedron(corners) => {
                for k in 0..=nz {
                    for j in 0..=ny {
                        for i in 0..=nx {
                            let x = point(corners, [part(i, nx), part(j, ny), part(k, nz)]);
                            mesh.nodes.push(x);
                        }
                    }
                }
            }
        }
        for k in 0..nz {
            for j in 0..ny {
                for i in 0..nx {
                    let node = |p: [usize; 3]| placed.node([i + p[0], j + p[1], k + p[2]]);
                    mesh.elements.push(PLACES.map(node));
                    mesh.material.push(material);
                    mesh.unit.push(body);
                    mesh.course.push(0);
                }
            }
        }
        placed
    }

    fn node(&self, [i, j, k]: [usize; 3]) -> u32 {
        let [nx, ny, _] = self.cells;
        (self.first_node + (k * (ny + 1) + j) * (nx + 1) + i) as u32
    }

    /// All nodes.
    pub fn nodes(&self) -> Vec<u32> {
        let count: usize = self.cells.iter().map(|n| n + 1).product();
        (self.first_node..self.first_node + count)
            .map(|n| n as u32)
            .collect()
    }

    /// Facets of a face, counter-clockwise seen from outside, with their elements.
    pub fn facets(&self, face: Face) -> Vec<(usize, [u32; 4])> {
        let (axis, high) = face.side();
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut facets = Vec::with_capacity(self.cells[u] * self.cells[v]);
        for b in 0..self.cells[v] {
            for a in 0..self.cells[u] {
                let at = |a: usize, b: usize, layer: usize| {
                    let mut at = [0; 3];
                    (at[axis], at[u], at[v]) = (layer, a, b);
                    at
                };
                let layer = if high { self.cells[axis] } else { 0 };
                let round = [(a, b), (a + 1, b), (a + 1, b + 1), (a, b + 1)];
                let mut facet = round.map(|(a, b)| self.node(at(a, b, layer)));
                if !high {
                    facet.swap(1, 3);
                }
                let [i, j, k] = at(a, b, layer.saturating_sub(1));
                let [nx, ny, _] = self.cells;
                facets.push((self.first_element + (k * ny + j) * nx + i, facet));
            }
        }
        facets
    }

    /// Flat parts of a face, counter-clockwise seen from outside [mm]: all of it, or the facets of a
    /// grid, which may be curved. `[part][corner][xyz]`
    pub fn outlines(&self, face: Face, mesh: &Mesh) -> Vec<[[f64; 3]; 4]> {
        let corners = match &self.shape {
            Shape::Hexahedron(corners) => corners,
            Shape::Grid(_) => {
                let facets = self.facets(face).into_iter();
                let at = |(_, facet): (usize, [u32; 4])| facet.map(|n| mesh.nodes[n as usize]);
                return facets.map(at).collect();
            }
        };
        let (axis, high) = face.side();
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut round = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
        if !high {
            round.swap(1, 3);
        }
        vec![round.map(|(a, b)| {
            let mut at = [0.0; 3];
            (at[axis], at[u], at[v]) = (f64::from(u8::from(high)), a, b);
            point(corners, at)
        })]
    }

    /// Mean area of the facets of a face [mm²].
    pub fn mean_facet(&self, face: Face, mesh: &Mesh) -> f64 {
        let outlines = self.outlines(face, mesh);
        let area: f64 = outlines.iter().map(|o| norm(area_vector(o))).sum();
        area / self.facets(face).len() as f64
    }
}

/// The point at parts 0 to 1 of the edges [mm]: a + t (b − a), exact at both ends.
fn point(corners: &Corners, [r, s, t]: [f64; 3]) -> [f64; 3] {
    let between = |a: f64, b: f64, t: f64| if t == 1.0 { b } else { a + t * (b - a) };
    [0, 1, 2].map(|d| {
        let c = |n: usize| corners[n][d];
        let low = between(between(c(0), c(1), r), between(c(3), c(2), r), s);
        let high = between(between(c(4), c(5), r), between(c(7), c(6), r), s);
        between(low, high, t)
    })
}

/// Area vector of a quadrilateral, half the cross product of its diagonals [mm²].
pub(crate) fn area_vector(q: &[[f64; 3]; 4]) -> [f64; 3] {
    cross(difference(q[2], q[0]), difference(q[3], q[1])).map(|x| 0.5 * x)
}

pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn difference(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

pub(super) fn mean(points: &[[f64; 3]; 4]) -> [f64; 3] {
    [0, 1, 2].map(|d| points.iter().map(|x| x[d]).sum::<f64>() / 4.0)
}
