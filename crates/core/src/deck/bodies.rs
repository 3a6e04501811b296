//! Bodies of a scene: names, mesh, supports, springs, velocities.

mod laying;
mod sides;

use super::amount;
use super::body::Body;
use super::imported::Imported;
use super::masonry::{self, Masonry};
use super::mirrors::Mirror;
use super::name_registry::{NameRegistry, Place};
use super::quantity::Quantity;
use super::rigid;
use super::schema::{Deck, Material, Names};
use super::stones::FileStones;
use crate::element::hexahedron::{area_vector, norm};
use crate::error::{ErrorKind, Errors, ModelError, Warning};
use crate::material::MaterialParameters;
use crate::model::Mesh;
use crate::model::mesh::WallOfUnits;
use crate::model::scene::{HeldBy, Spring, Support};
use std::cell::{Cell, OnceCell};
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
    /// Units of walls, in which facets are searched.
    units: OnceCell<sides::Units>,
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
            units: OnceCell::new(),
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

    /// Walls of masonry with the numbers of their bodies in the mesh.
    pub(super) fn walls_of_units(&self) -> Vec<WallOfUnits> {
        let of_wall = |wall: &Masonry<'_>| {
            let bodies = &self.all[wall.bodies.clone()];
            let mut units: Vec<u32> = bodies.iter().map(|body| body.number).collect();
            units.sort_unstable();
            WallOfUnits {
                name: wall.name.clone(),
                units,
            }
        };
        self.walls.iter().map(of_wall).collect()
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
                    let facets = || self.facets(*place).into_iter();
                    let nodes = body.faces[face].nodes.clone();
                    nodes.unwrap_or_else(|| facets().flat_map(|(_, facet)| facet).collect())
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
            for (_, facet) in self.facets(*place) {
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
