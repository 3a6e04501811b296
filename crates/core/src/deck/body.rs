//! Bodies of a scene and their faces, independent of the kind of input that describes them.

use crate::element::hexahedron::{Corners, Face, PLACES, area_vector, norm, point};
use crate::model::Mesh;
use std::borrow::Cow;
use std::ops::Range;

/// A body: hex8 elements with nodes of their own. Other bodies touch it at its faces.
#[derive(Clone, Debug)]
pub struct Body {
    /// Name in the deck, with the indices of a copy, or with course and position in a wall.
    pub name: String,
    /// Number of the body in [`Mesh::unit`].
    pub number: u32,
    /// Range of its nodes in the mesh.
    pub nodes: Range<u32>,
    /// Faces. A block or a unit has the six of [`Face::ALL`], in that order. An imported body has first the faces
    /// of its boundary, then sets of its file, which may overlap these and each other.
    pub faces: Vec<BodyFace>,
    /// Number of faces that make up its boundary.
    pub skin: usize,
    /// Whether its faces may be curved; their outlines are then their facets.
    pub curved: bool,
}

/// A face of a body: facets under one name.
#[derive(Clone, Debug)]
pub struct BodyFace {
    /// Name in the deck, after that of the body and a dot.
    pub name: Cow<'static, str>,
    /// Elements and their facets, whose nodes run counter-clockwise seen from outside.
    pub facets: Vec<(usize, [u32; 4])>,
    /// Flat parts of the face, counter-clockwise seen from outside [mm]. `[part][corner][xyz]`
    pub outlines: Vec<[[f64; 3]; 4]>,
    /// Nodes of a set of nodes; none if the nodes are those of the facets.
    pub nodes: Option<Vec<u32>>,
}

impl BodyFace {
    /// Mean area of the facets [mm²].
    pub fn mean_facet(&self) -> f64 {
        let area: f64 = self.outlines.iter().map(|o| norm(area_vector(o))).sum();
        area / self.facets.len() as f64
    }
}

/// A structured grid of nodes of which some cells are solid.
pub struct Grid<'a> {
    /// Number of cells along ξ, η, ζ.
    pub cells: [usize; 3],
    /// Material of the cell i, j, k; none if the cell is empty.
    pub material: &'a dyn Fn([usize; 3]) -> Option<u16>,
    /// Position of the node i, j, k [mm].
    pub node: &'a dyn Fn([usize; 3]) -> [f64; 3],
}

impl Body {
    /// Divides a hexahedron into cells by trilinear interpolation of its corners and appends it to the mesh.
    /// Neighbours with common corners have bitwise equal node coordinates there.
    pub fn hexahedron(
        mesh: &mut Mesh,
        name: String,
        corners: &Corners,
        cells: [usize; 3],
        material: u16,
    ) -> Self {
        let part = |i: usize, n: usize| i as f64 / n as f64;
        let node = |at: [usize; 3]| point(corners, [0, 1, 2].map(|d| part(at[d], cells[d])));
        let mut body = Self::uniform(mesh, name, cells, material, &node);
        for (_, face) in Face::ALL {
            body.faces[face as usize].outlines = vec![face.outline(corners)];
        }
        body
    }

    /// Appends a grid of nodes `[node][xyz]` [mm] to the mesh, along ξ first, then η, ζ.
    pub fn grid(
        mesh: &mut Mesh,
        name: String,
        nodes: &[[f64; 3]],
        cells: [usize; 3],
        material: u16,
    ) -> Self {
        let [nx, ny, _] = cells;
        let node = |[i, j, k]: [usize; 3]| nodes[(k * (ny + 1) + j) * (nx + 1) + i];
        let mut body = Self::uniform(mesh, name, cells, material, &node);
        body.curved = true;
        body
    }

    /// Appends a grid of one material.
    fn uniform(
        mesh: &mut Mesh,
        name: String,
        cells: [usize; 3],
        material: u16,
        node: &dyn Fn([usize; 3]) -> [f64; 3],
    ) -> Self {
        let material = |_: [usize; 3]| Some(material);
        let grid = Grid {
            cells,
            material: &material,
            node,
        };
        Self::new(mesh, name, &grid)
    }

    /// Appends the solid cells of a grid and their nodes to the mesh. The outlines of its faces are its facets.
    /// Nodes, elements and facets are numbered along ξ first, then η, ζ.
    pub fn new(mesh: &mut Mesh, name: String, grid: &Grid<'_>) -> Self {
        let number = mesh.unit.last().map_or(0, |u| u + 1);
        let [nx, ny, nz] = grid.cells;
        let cells = || {
            let planes = (0..nz).flat_map(move |k| (0..ny).map(move |j| (j, k)));
            planes.flat_map(move |(j, k)| (0..nx).map(move |i| [i, j, k]))
        };
        let place = |[i, j, k]: [usize; 3]| (k * (ny + 1) + j) * (nx + 1) + i;
        let corner = |[i, j, k]: [usize; 3], p: [usize; 3]| [i + p[0], j + p[1], k + p[2]];
        let mut used = vec![false; (nx + 1) * (ny + 1) * (nz + 1)];
        for at in cells().filter(|at| (grid.material)(*at).is_some()) {
            for p in PLACES {
                used[place(corner(at, p))] = true;
            }
        }
        let first_node = mesh.nodes.len() as u32;
        let mut numbers = vec![u32::MAX; used.len()];
        for k in 0..=nz {
            for j in 0..=ny {
                for i in 0..=nx {
                    let at = place([i, j, k]);
                    if used[at] {
                        numbers[at] = mesh.nodes.len() as u32;
                        mesh.nodes.push((grid.node)([i, j, k]));
                    }
                }
            }
        }
        let mut elements = vec![usize::MAX; nx * ny * nz];
        let element = |[i, j, k]: [usize; 3]| (k * ny + j) * nx + i;
        for at in cells() {
            let Some(material) = (grid.material)(at) else {
                continue;
            };
            elements[element(at)] = mesh.elements.len();
            mesh.elements
                .push(PLACES.map(|p| numbers[place(corner(at, p))]));
            mesh.material.push(material);
            mesh.unit.push(number);
            mesh.course.push(0);
        }
        let is_solid = |at: [usize; 3]| elements[element(at)] != usize::MAX;
        let is_covered = |at: [usize; 3], face: Face| {
            let (axis, high) = face.side();
            let mut next = at;
            match (high, at[axis].checked_sub(1)) {
                (true, _) => next[axis] += 1,
                (false, Some(below)) => next[axis] = below,
                (false, None) => return false,
            }
            next[axis] < grid.cells[axis] && is_solid(next)
        };
        let faces = Face::ALL.map(|(name, face)| {
            let (axis, _) = face.side();
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut facets = Vec::new();
            for b in 0..grid.cells[v] {
                for a in 0..grid.cells[u] {
                    for layer in 0..grid.cells[axis] {
                        let mut at = [0; 3];
                        (at[axis], at[u], at[v]) = (layer, a, b);
                        if is_solid(at) && !is_covered(at, face) {
                            let e = elements[element(at)];
                            facets.push((e, face.corners().map(|c| mesh.elements[e][c])));
                        }
                    }
                }
            }
            let outline = |f: &(usize, [u32; 4])| f.1.map(|n| mesh.nodes[n as usize]);
            BodyFace {
                name: Cow::Borrowed(name),
                outlines: facets.iter().map(outline).collect(),
                facets,
                nodes: None,
            }
        });
        Self {
            name,
            number,
            nodes: first_node..mesh.nodes.len() as u32,
            skin: faces.len(),
            faces: faces.into(),
            curved: false,
        }
    }
}
