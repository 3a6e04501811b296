//! Bodies of a scene: names, mesh, supports, springs, velocities.

use super::amount;
use super::arch::{Stones, stones};
use super::body::{Body, Grid};
use super::imported::Imported;
use super::masonry::{self, Masonry};
use super::mirrors::Mirror;
use super::name_registry::{NameRegistry, Place};
use super::quantity::Quantity;
use super::rigid;
use super::schema::{Deck, DeckBlock, Lattice, Material, Names};
use super::stones::FileStones;
use crate::element::hexahedron::{Corners, area_vector, norm};
use crate::error::{ErrorKind, Errors, ModelError, Warning};
use crate::material::MaterialParameters;
use crate::model::Mesh;
use crate::model::builder::grid;
use crate::model::scene::{HeldBy, Spring, Support};
use std::cell::Cell;
use std::collections::BTreeMap;

/// Bodies of a scene, their mesh and their names in the deck.
pub(super) struct Bodies<'a> {
    /// The deck.
    pub(super) deck: &'a Deck,
    /// Mesh of the solids.
    pub(super) mesh: Mesh,
    /// Names of the materials. `[material]`
    pub(super) materials: Vec<String>,
    /// Bodies in this order: units of walls, blocks, imported bodies, voussoirs, left springing, right springing.
    pub(super) all: Vec<Body>,
    /// Walls; their units are the first bodies.
    pub(super) walls: Vec<Masonry<'a>>,
    /// Materials that are not in the deck, by name: those of imported files and of rigid bodies.
    brought: BTreeMap<String, Material>,
    /// Warnings about files of meshes and of stones.
    pub(super) warnings: Vec<Warning>,
    /// Names of the bodies.
    roll: NameRegistry,
    /// Initial velocity [mm/s]; empty if all bodies are at rest. `[node]`
    pub(super) velocity: Vec<[f64; 3]>,
    /// Facets that represent the other half where planes of symmetry cut joints.
    pub(super) mirrors: Vec<Mirror>,
    /// Longest side of the rigid blocks of files [mm].
    longest_of_files: f64,
    /// Number of nodes that the deck has named so far; a node counts as often as it is named.
    named: Cell<usize>,
}

/// Largest value of [`Bodies::named`]: each support, probe and load stores its nodes.
const MOST_NAMED: usize = 30_000_000;

/// Largest product of the number of points that a deck searches for and the number of nodes among them.
const MOST_SEARCHED: usize = 1_000_000_000;

impl<'a> Bodies<'a> {
    /// Builds all bodies of a deck.
    ///
    /// # Errors
    /// Too many elements, two bodies of one name, walls that cannot be built, unreadable files of nodes.
    pub(super) fn new(deck: &'a Deck) -> Result<Self, ModelError> {
        let mut bodies = Self {
            deck,
            mesh: Mesh::default(),
            materials: Vec::new(),
            all: Vec::new(),
            walls: Vec::new(),
            brought: BTreeMap::new(),
            warnings: Vec::new(),
            roll: NameRegistry::default(),
            velocity: Vec::new(),
            mirrors: Vec::new(),
            longest_of_files: 0.0,
            named: Cell::new(0),
        };
        let mut errors = Errors::default();
        let refused = |(path, refusal): (String, masonry::Refusal)| refusal.at(deck, &path);
        let walls = masonry::lay_all(deck).map_err(refused)?;
        amount::require_countable(deck).map_err(refused)?;
        let imports = (0..deck.imports.len()).map(|i| Imported::read(deck, i));
        let imports: Vec<_> = imports.filter_map(|read| errors.keep(read)).collect();
        let stones = (0..deck.blocks.len()).map(|i| FileStones::read(deck, i));
        let stones: Vec<_> = stones.filter_map(|read| errors.keep(read)).collect();
        if imports.len() < deck.imports.len() || stones.len() < deck.blocks.len() {
            return errors.end(bodies); // the contents of the files are unknown
        }
        bodies.longest_of_files = FileStones::longest_side(&stones, deck);
        let files = (imports.as_slice(), stones.as_slice());
        if let Some((roll, twice)) = NameRegistry::call(deck, &walls, Some(files)) {
            bodies.roll = roll;
            for error in twice {
                errors.push(error);
            }
        }
        for wall in walls {
            bodies.lay_wall(wall)?;
        }
        bodies.velocity.resize(bodies.mesh.nodes.len(), [0.0; 3]);
        for ((i, block), stones) in deck.blocks.iter().enumerate().zip(stones) {
            match stones {
                Some(stones) => bodies.lay_stones(block, stones),
                None => {
                    errors.keep(bodies.lay(i, block));
                }
            }
        }
        for (import, said) in imports.into_iter().zip(&deck.imports) {
            bodies.lay_import(import);
            let velocity = said.velocity.map(Quantity::get);
            bodies.velocity.resize(bodies.mesh.nodes.len(), velocity);
        }
        bodies.lay_arch();
        bodies.lay_mirrors();
        errors.keep(bodies.require_few_searches());
        if bodies.velocity.iter().all(|v| *v == [0.0; 3]) {
            bodies.velocity.clear();
        }
        errors.end(bodies)
    }

    /// Finds something on the bodies of a deck for each of `items`, with all errors. The bodies are built for this, and
    /// again with the parts that follow from it; files named by the deck are therefore read again.
    ///
    /// # Errors
    /// Those of [`Self::new`] and of the items.
    pub(super) fn measured<T, U>(
        deck: &'a Deck,
        items: &[T],
        of: impl Fn(&Self, usize, &T) -> Result<U, ModelError>,
    ) -> Result<Vec<U>, ModelError> {
        let bodies = Self::new(deck)?;
        let mut errors = Errors::default();
        let items = items.iter().enumerate();
        let found = items.filter_map(|(i, item)| errors.keep(of(&bodies, i, item)));
        let found = found.collect();
        errors.end(found)
    }

    /// Rejects more searches for points than [`MOST_SEARCHED`].
    fn require_few_searches(&self) -> Result<(), ModelError> {
        let (deck, nodes) = (self.deck, self.mesh.nodes.len());
        let searched = deck.probes.len() + deck.loads().len();
        if searched.saturating_mul(nodes) <= MOST_SEARCHED {
            return Ok(());
        }
        let path = if deck.probes.is_empty() {
            "steps"
        } else {
            "probes"
        };
        Err(deck
            .error(
                path,
                format!("{searched} probes and loads are too many for {nodes} nodes"),
                "at most 1e9 of both, multiplied",
            )
            .of_kind(ErrorKind::TooMany))
    }

    /// Returns the wall to which body `body` belongs as a unit, if any.
    pub(super) fn wall_of(&self, body: usize) -> Option<&Masonry<'a>> {
        self.walls.iter().find(|wall| wall.bodies.contains(&body))
    }

    /// Returns whether two bodies are units of one wall, or of walls that pass through each other.
    pub(super) fn in_one_wall(&self, a: usize, b: usize) -> bool {
        let of = |body: usize| {
            self.walls
                .iter()
                .position(|wall| wall.bodies.contains(&body))
        };
        let (Some(a), Some(b)) = (of(a), of(b)) else {
            return false;
        };
        a == b || self.walls[a].meets(b)
    }

    /// Names of all bodies. `[number in the mesh]`
    pub(super) fn names(&self) -> Vec<String> {
        let count = self.all.iter().map(|body| body.number as usize + 1).max();
        let mut names = vec![String::new(); count.unwrap_or(0)];
        for body in &self.all {
            names[body.number as usize].clone_from(&body.name);
        }
        names
    }

    /// Name of a body in messages.
    pub(super) fn called(&self, body: usize) -> String {
        let name = &self.all[body].name;
        match self.wall_of(body) {
            Some(wall) => {
                let unit = &wall.units[body - wall.bodies.start];
                format!("unit {body} in course {} ({name})", unit.course)
            }
            None => name.clone(),
        }
    }

    /// Adds the units of a wall.
    ///
    /// # Errors
    /// Rigid units that need too many elements, because the grid lines of their neighbours divide them.
    fn lay_wall(&mut self, wall: Masonry<'a>) -> Result<(), ModelError> {
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
    fn lay(&mut self, index: usize, block: &DeckBlock) -> Result<(), ModelError> {
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
    fn lay_stones(&mut self, block: &DeckBlock, stones: FileStones) {
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
    fn lay_import(&mut self, import: Imported) {
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

    /// Parameters of the material `name`, of the deck or of an imported file.
    ///
    /// # Errors
    /// Unknown material.
    pub(super) fn parameters(&self, name: &str) -> Result<MaterialParameters, ModelError> {
        match self.brought.get(name) {
            Some(material) => Ok(material.parameters()),
            None => self.deck.material(name),
        }
    }

    fn lay_arch(&mut self) {
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

    /// Index of the material `name`, or of its rigid substitute.
    fn solid(&mut self, name: &str, rigid: bool) -> u16 {
        let (Some(own), Some(stiffness)) = (
            self.deck.materials.get(name).filter(|_| rigid),
            rigid::stiffness(self.deck, self.longest_of_files),
        ) else {
            return self.material(name);
        };
        let called = rigid::name_of(name);
        self.brought
            .insert(called.clone(), rigid::material(own, stiffness));
        self.material(&called)
    }

    /// Index of a material; adds it if it is new.
    fn material(&mut self, name: &str) -> u16 {
        let found = self.materials.iter().position(|m| m == name);
        found.unwrap_or_else(|| {
            self.materials.push(name.to_owned());
            self.materials.len() - 1
        }) as u16
    }

    /// Bodies and faces that the names at `path` denote, see [`NameRegistry::places`].
    ///
    /// # Errors
    /// Unknown block or face.
    pub(super) fn places(
        &self,
        path: &str,
        names: &Names,
        faces: bool,
    ) -> Result<Vec<Place>, ModelError> {
        let places = self.roll.places(self.deck, path, names, faces)?;
        let nodes = |place: &Place| {
            let body = &self.all[place.body];
            place
                .face
                .map_or(body.nodes.len(), |face| 4 * body.faces[face].facets.len())
        };
        let named = self.named.get() + places.iter().map(nodes).sum::<usize>();
        self.named.set(named);
        if named > MOST_NAMED {
            return Err(self.deck.error(
                path,
                "supports, springs, contacts, steps, loads and probes name too many nodes together",
                "name faces rather than bodies, and one list rather than many entries",
            ).of_kind(ErrorKind::TooMany));
        }
        Ok(places)
    }

    /// Nodes of these places, in ascending order, each once.
    pub(super) fn nodes(&self, places: &[Place]) -> Vec<u32> {
        let of = |place: &Place| -> Vec<u32> {
            let body = &self.all[place.body];
            match place.face {
                None => body.nodes.clone().collect(),
                Some(face) => {
                    let face = &body.faces[face];
                    let facets = face.facets.iter().flat_map(|(_, facet)| *facet);
                    face.nodes.clone().unwrap_or_else(|| facets.collect())
                }
            }
        };
        let mut nodes: Vec<u32> = places.iter().flat_map(of).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Sum of the outward area vectors of faces [mm²], and sum of their magnitudes [mm²].
    pub(super) fn area(&self, places: &[Place]) -> ([f64; 3], f64) {
        let (mut sum, mut total) = ([0.0; 3], 0.0);
        for place in places {
            let faces = place.face.map(|face| &self.all[place.body].faces[face]);
            for (_, facet) in faces.into_iter().flat_map(|face| &face.facets) {
                let area = area_vector(&facet.map(|n| self.mesh.nodes[n as usize]));
                total += norm(area);
                (0..3).for_each(|d| sum[d] += area[d]);
            }
        }
        (sum, total)
    }

    /// Nodes of these places that lie in the box of support `i`, if it has one.
    ///
    /// # Errors
    /// A box that contains no node.
    fn nodes_within(&self, i: usize, places: &[Place]) -> Result<Vec<u32>, ModelError> {
        let mut nodes = self.nodes(places);
        let Some([low, high]) = self.deck.supports[i].within else {
            return Ok(nodes);
        };
        let (low, high) = (low.map(Quantity::get), high.map(Quantity::get));
        // Coordinates in decks are rounded to 0.01 mm.
        nodes.retain(|n| {
            let x = self.mesh.nodes[*n as usize];
            (0..3).all(|d| low[d] - BESIDE <= x[d] && x[d] <= high[d] + BESIDE)
        });
        if nodes.is_empty() {
            return Err(self
                .deck
                .error(
                    &format!("supports.{i}.box"),
                    "there is no node in this box",
                    "lower and upper corner at rest; nodes lie on the lines of the mesh",
                )
                .of_kind(ErrorKind::Geometry));
        }
        Ok(nodes)
    }

    /// Supports of the deck and of the springings.
    ///
    /// # Errors
    /// Unknown names.
    pub(super) fn supports(&self) -> Result<Vec<Support>, ModelError> {
        let mut supports = masonry::supports(self);
        for (i, support) in self.deck.supports.iter().enumerate() {
            let places = self.places(&format!("supports.{i}.on"), &support.on, false)?;
            supports.push(Support {
                name: support.on.0.join(", "),
                nodes: self.nodes_within(i, &places)?,
                fixed: support.holds(),
                by: HeldBy::Ground,
            });
        }
        if self.deck.arch.is_some() {
            let springing = Names(vec!["springing".to_owned()]);
            supports.push(Support {
                name: "springings".to_owned(),
                nodes: self.nodes(&self.places("arch", &springing, false)?),
                fixed: [true; 3],
                by: HeldBy::Ground,
            });
        }
        Ok(supports)
    }

    /// Springs of the deck.
    ///
    /// # Errors
    /// Unknown names.
    pub(super) fn springs(&self) -> Result<Vec<Spring>, ModelError> {
        let mut springs: Vec<Spring> = Vec::new();
        for (i, spring) in self.deck.springs.iter().enumerate() {
            let places = self.places(&format!("springs.{i}.on"), &spring.on, false)?;
            springs.push(Spring {
                name: spring.name.clone(),
                nodes: self.nodes(&places),
                stiffness: spring.stiffness.map(Quantity::get),
            });
        }
        Ok(springs)
    }
}

/// Nodes within this distance of a box count as in it [mm].
const BESIDE: f64 = 0.01;

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
