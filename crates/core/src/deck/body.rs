//! Bodies of a scene and their faces, independent of the kind of input that describes them.

use crate::element::hexahedron::{Corners, Face, PLACES, area_vector, norm, point};
use crate::model::Mesh;
use crate::model::builder::grid;
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
    /// Faces. A block or a unit has the six of [`Face::ALL`], in that order; a stone of a file that is no hexahedron has
    /// those of its polygons. An imported body has first the faces of its boundary, then sets of its file, which may
    /// overlap these and each other.
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

/// Number of a cell that has no element.
const EMPTY: usize = usize::MAX;

impl Grid<'_> {
    /// Index of the node at corner `p` of a cell.
    fn corner(&self, at: [usize; 3], p: [usize; 3]) -> usize {
        let [nx, ny, _] = self.cells;
        let [i, j, k] = [0, 1, 2].map(|d| at[d] + p[d]);
        (k * (ny + 1) + j) * (nx + 1) + i
    }

    /// Index of a cell.
    fn cell(&self, [i, j, k]: [usize; 3]) -> usize {
        let [nx, ny, _] = self.cells;
        (k * ny + j) * nx + i
    }

    /// Appends the nodes of solid cells to the mesh; returns their numbers. `[node of the grid]`
    fn append_nodes(&self, mesh: &mut Mesh) -> Vec<u32> {
        let places = self.cells.map(|n| n + 1);
        let mut used = vec![false; places.iter().product()];
        for at in grid(self.cells).filter(|at| (self.material)(*at).is_some()) {
            for p in PLACES {
                used[self.corner(at, p)] = true;
            }
        }
        let mut numbers = vec![u32::MAX; used.len()];
        for (n, at) in grid(places).enumerate().filter(|(n, _)| used[*n]) {
            numbers[n] = mesh.nodes.len() as u32;
            mesh.nodes.push((self.node)(at));
        }
        numbers
    }

    /// Appends the solid cells to the mesh as elements of body `number`; returns their numbers. `[cell]`
    fn append_elements(&self, mesh: &mut Mesh, nodes: &[u32], number: u32) -> Vec<usize> {
        let element = |at: [usize; 3]| {
            let Some(material) = (self.material)(at) else {
                return EMPTY;
            };
            let corners = PLACES.map(|p| nodes[self.corner(at, p)]);
            mesh.elements.push(corners);
            mesh.material.push(material);
            mesh.unit.push(number);
            mesh.course.push(0);
            mesh.elements.len() - 1
        };
        grid(self.cells).map(element).collect()
    }

    /// Facets of solid cells on one side that no other solid cell covers, with their `elements`. `[cell]`
    fn facets(&self, mesh: &Mesh, elements: &[usize], face: Face) -> Vec<(usize, [u32; 4])> {
        let (axis, high) = face.side();
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let is_solid = |at: [usize; 3]| elements[self.cell(at)] != EMPTY;
        let is_covered = |at: [usize; 3]| {
            let mut next = at;
            match (high, at[axis].checked_sub(1)) {
                (true, _) => next[axis] += 1,
                (false, Some(below)) => next[axis] = below,
                (false, None) => return false,
            }
            next[axis] < self.cells[axis] && is_solid(next)
        };
        let cells = grid([axis, u, v].map(|d| self.cells[d])).map(|[layer, a, b]| {
            let mut at = [0; 3];
            (at[axis], at[u], at[v]) = (layer, a, b);
            at
        });
        let open = cells.filter(|at| is_solid(*at) && !is_covered(*at));
        open.map(|at| {
            let e = elements[self.cell(at)];
            (e, face.corners().map(|c| mesh.elements[e][c]))
        })
        .collect()
    }
}

impl Body {
    /// Maps its nodes and the outlines of its faces [mm].
    pub fn place(&mut self, mesh: &mut Mesh, to: impl Fn([f64; 3]) -> [f64; 3]) {
        for n in self.nodes.clone() {
            mesh.nodes[n as usize] = to(mesh.nodes[n as usize]);
        }
        for outline in self.faces.iter_mut().flat_map(|face| &mut face.outlines) {
            *outline = outline.map(&to);
        }
    }

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
        let first_node = mesh.nodes.len() as u32;
        let nodes = grid.append_nodes(mesh);
        let elements = grid.append_elements(mesh, &nodes, number);
        let faces = Face::ALL.map(|(name, face)| {
            let facets = grid.facets(mesh, &elements, face);
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
