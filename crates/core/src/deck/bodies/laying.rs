//! Bodies of walls, blocks, layers, files and the arch: their elements and nodes in the mesh of the scene.

use super::Bodies;
use crate::deck::amount;
use crate::deck::arch::{Stones, stones};
use crate::deck::body::{Body, Grid};
use crate::deck::imported::Imported;
use crate::deck::masonry::{self, Masonry};
use crate::deck::quantity::Quantity;
use crate::deck::schema::{DeckBlock, Lattice};
use crate::deck::stones::FileStones;
use crate::element::hexahedron::Corners;
use crate::error::{ErrorKind, ModelError};
use crate::model::builder::grid;

impl<'a> Bodies<'a> {
    /// Adds the units of a wall.
    ///
    /// # Errors
    /// Rigid units that need too many elements, because the grid lines of their neighbours divide them.
    pub(super) fn lay_wall(&mut self, wall: Masonry<'a>) -> Result<(), ModelError> {
        let said = wall.wall;
        let rigid = said.rigid;
        let lines = rigid.then(|| masonry::lines(&wall.units));
        let cells = |lines: &[Vec<f64>; 3]| -> f64 {
            lines.iter().map(|at| at.len() as f64 - 1.0).product()
        };
        let elements: f64 = lines.iter().flatten().map(cells).sum();
        if elements > amount::MOST_ELEMENTS {
            return Err(self.deck.error(
                &format!("{}.rigid", wall.path),
                format!("rigid units with lines where their neighbours end have {elements} elements: too many"),
                "at most 5e5: build a part of the wall",
            ).of_kind(ErrorKind::TooMany));
        }
        let unit = self.solid(&said.unit_material, rigid);
        let mortar = said
            .mortar_material
            .as_ref()
            .map(|name| self.material(name));
        for (i, laid) in wall.units.iter().enumerate() {
            let own = laid
                .material
                .as_ref()
                .map_or(unit, |name| self.solid(name, rigid));
            let materials = [own, mortar.unwrap_or(own)];
            let lines = lines.as_ref().map(|lines| &lines[i]);
            let mut body = masonry::append(&mut self.mesh, &wall, laid, materials, lines);
            if !wall.placement.is_identity() {
                body.place(&mut self.mesh, |x| wall.placement.to_scene(x));
            }
            self.all.push(body);
        }
        self.walls.push(wall);
        Ok(())
    }

    /// Adds a block and its copies.
    pub(super) fn lay(&mut self, index: usize, block: &DeckBlock) -> Result<(), ModelError> {
        let material = self.solid(&block.material, block.rigid);
        if let Some(lattice) = &block.lattice {
            self.lay_lattice(&block.name, lattice, material);
            return Ok(());
        }
        let own = match self.deck.block_nodes(index)? {
            Some(nodes) => Shape::Grid(nodes),
            None => Shape::Hexahedron(corners(block)),
        };
        let shape = own.map(|x| laid(block, x));
        if let Some(count) = block.stack {
            let height = block.size.map_or(0.0, |size| size[2].get());
            for k in 0..count {
                let base = turned_with(block, [0.0, 0.0, f64::from(k) * height]);
                let moved = shape.map(|x| [0, 1, 2].map(|d| x[d] + base[d]));
                self.add(format!("{}-{k}", block.name), moved, block.mesh, material);
            }
            let velocity = block.velocity.map(Quantity::get);
            self.velocity.resize(self.mesh.nodes.len(), velocity);
            return Ok(());
        }
        let copies = block.copies.unwrap_or([1; 3]);
        let pitch = block.pitch.map_or([0.0; 3], |p| p.map(Quantity::get));
        for at @ [i, j, k] in grid(copies.map(|n| n as usize)) {
            let moved = shape.map(|x| [0, 1, 2].map(|d| x[d] + at[d] as f64 * pitch[d]));
            let name = match block.copies {
                Some(_) => format!("{}-{i}-{j}-{k}", block.name),
                None => block.name.clone(),
            };
            self.add(name, moved, block.mesh, material);
        }
        let velocity = block.velocity.map(Quantity::get);
        self.velocity.resize(self.mesh.nodes.len(), velocity);
        Ok(())
    }

    /// Adds the blocks of a file.
    pub(super) fn lay_stones(&mut self, block: &DeckBlock, stones: FileStones) {
        let material = self.solid(&block.material, block.rigid);
        for stone in &stones.all {
            let body = stone.append(&mut self.mesh, block.mesh, material, |x| laid(block, x));
            self.all.push(body);
        }
        let velocity = block.velocity.map(Quantity::get);
        self.velocity.resize(self.mesh.nodes.len(), velocity);
        self.warnings.extend(stones.warnings);
    }

    /// Adds the body of a layer.
    fn lay_lattice(&mut self, name: &str, lattice: &Lattice, material: u16) {
        let Lattice {
            lines,
            solid,
            bonded,
            touching,
        } = lattice;
        let cells = lines.each_ref().map(|at| at.len() - 1);
        let of_cell = |[i, j, k]: [usize; 3]| {
            let cell = (k * cells[1] + j) * cells[0] + i;
            solid[cell].then_some(material)
        };
        let node = |at: [usize; 3]| [0, 1, 2].map(|d| lines[d][at[d]]);
        let grid = Grid {
            cells,
            material: &of_cell,
            node: &node,
        };
        let first = self.mesh.elements.len();
        let mut body = Body::new(&mut self.mesh, name.to_owned(), &grid);
        let bonds =
            (solid.iter().zip(bonded)).filter_map(|(solid, bonded)| solid.then_some(*bonded));
        let bonds: Vec<bool> = bonds.collect();
        let face = &mut body.faces[*touching];
        let touches = face.facets.iter().map(|(e, _)| bonds[e - first]);
        let touches: Vec<bool> = touches.collect();
        let mut of_outlines = touches.iter();
        face.outlines.retain(|_| of_outlines.next() == Some(&true));
        let mut of_facets = touches.iter();
        face.facets.retain(|_| of_facets.next() == Some(&true));
        self.all.push(body);
        self.velocity.resize(self.mesh.nodes.len(), [0.0; 3]);
    }

    /// Adds the bodies of an import. Materials keep the names of their file. If another import has a different
    /// material of the same name, the name of this import is put before it.
    pub(super) fn lay_import(&mut self, import: Imported) {
        let mut index = Vec::with_capacity(import.materials.len());
        for (name, own) in &import.materials {
            let name = match (own, self.brought.get(name)) {
                (Some(own), Some(other)) if own != other => format!("{}.{name}", import.name),
                _ => name.clone(),
            };
            if let Some(own) = own {
                self.brought.insert(name.clone(), own.clone());
            }
            index.push(self.material(&name));
        }
        self.all.extend(import.append(&mut self.mesh, &index));
        self.warnings.extend(import.warnings);
    }

    /// Adds the voussoirs and springings of the arch.
    pub(super) fn lay_arch(&mut self) {
        let Some(arch) = &self.deck.arch else {
            return;
        };
        let material = self.solid(&arch.material, arch.rigid);
        let Stones {
            voussoirs,
            springings,
        } = stones(arch);
        for (i, corners) in voussoirs.into_iter().enumerate() {
            let shape = Shape::Hexahedron(corners);
            self.add(format!("voussoir-{i}"), shape, arch.mesh, material);
        }
        for (name, corners) in ["springing-left", "springing-right"]
            .into_iter()
            .zip(springings)
        {
            let shape = Shape::Hexahedron(corners);
            self.add(name.to_owned(), shape, [1; 3], material);
        }
        self.velocity.resize(self.mesh.nodes.len(), [0.0; 3]);
    }

    fn add(&mut self, name: String, shape: Shape, mesh: [u32; 3], material: u16) {
        let cells = mesh.map(|n| n as usize);
        let mesh = &mut self.mesh;
        self.all.push(match shape {
            Shape::Hexahedron(corners) => Body::hexahedron(mesh, name, &corners, cells, material),
            Shape::Grid(nodes) => Body::grid(mesh, name, &nodes, cells, material),
        });
    }
}

/// Geometry of a block.
enum Shape {
    /// Its corners [mm]; all other points are interpolated.
    Hexahedron(Corners),
    /// Nodes of its grid [mm], along ξ first, then η, ζ. `[node][xyz]`
    Grid(Vec<[f64; 3]>),
}

impl Shape {
    /// Applies a map to all points.
    fn map(&self, to: impl Fn([f64; 3]) -> [f64; 3]) -> Self {
        match self {
            Self::Hexahedron(corners) => Self::Hexahedron(corners.map(to)),
            Self::Grid(nodes) => Self::Grid(nodes.iter().copied().map(to).collect()),
        }
    }
}

/// Corners of a block before it is placed [mm]: those of its box, or those given in the deck.
fn corners(block: &DeckBlock) -> Corners {
    let size = block.size.map_or([0.0; 3], |s| s.map(Quantity::get));
    let [l, t, h] = size;
    block.corners.map_or(
        [
            [0.0, 0.0, 0.0],
            [l, 0.0, 0.0],
            [l, t, 0.0],
            [0.0, t, 0.0],
            [0.0, 0.0, h],
            [l, 0.0, h],
            [l, t, h],
            [0.0, t, h],
        ],
        |c| c.map(|x| x.map(Quantity::get)),
    )
}

/// Position of a point of a block [mm]: rotated about the origin, then moved to `at`.
fn laid(block: &DeckBlock, x: [f64; 3]) -> [f64; 3] {
    let at = block.at.map(Quantity::get);
    let x = turned_with(block, x);
    [0, 1, 2].map(|d| at[d] + x[d])
}

/// Rotates a point about the origin by the rotation of its block [mm].
fn turned_with(block: &DeckBlock, x: [f64; 3]) -> [f64; 3] {
    block.rotate.map_or(x, |rotation| rotation.turn(x))
}
