//! A scene of blocks: names, mesh, supports, springs, velocities.

use super::arch::{Stones, stones};
use super::deck::{Deck, DeckBlock, Names};
use super::hexahedron::{Corners, Face, Placed, Shape, area_vector, norm};
use super::keys;
use super::quantity::Quantity;
use super::scene::{Spring, Support, turned};
use super::{Mesh, deck::Rotation};
use crate::error::ModelError;

/// A block, or one face of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// Index of the block.
    pub(super) block: usize,
    /// None: all of it.
    pub(super) face: Option<Face>,
}

/// The blocks of a scene in the mesh, and how a deck calls them.
pub(super) struct Blocks<'a> {
    deck: &'a Deck,
    /// The solids.
    pub(super) mesh: Mesh,
    /// Names of the materials by index.
    pub(super) materials: Vec<String>,
    /// In the order of the deck, then the arch: voussoirs, left springing, right springing.
    pub(super) placed: Vec<Placed>,
    /// Names that stand for several blocks. `(name, first, one past the last)`
    groups: Vec<(String, usize, usize)>,
    /// Velocity at the beginning [mm/s]. `[node]`
    pub(super) velocity: Vec<[f64; 3]>,
}

/// More elements than this cannot be factorised on any machine at hand, nor numbered safely.
const MOST_ELEMENTS: f64 = 1e7;

impl<'a> Blocks<'a> {
    /// Lays all blocks of a deck.
    ///
    /// # Errors
    /// Too many elements, or a name that two blocks have.
    pub(super) fn new(deck: &'a Deck) -> Result<Self, ModelError> {
        let mut blocks = Self {
            deck,
            mesh: Mesh::default(),
            materials: Vec::new(),
            placed: Vec::new(),
            groups: Vec::new(),
            velocity: Vec::new(),
        };
        blocks.require_countable()?;
        for (i, block) in deck.blocks.iter().enumerate() {
            blocks.lay(i, block)?;
        }
        blocks.lay_arch()?;
        if blocks.velocity.iter().all(|v| *v == [0.0; 3]) {
            blocks.velocity.clear();
        }
        Ok(blocks)
    }

    /// Refuses a mesh that is too large before it is made.
    fn require_countable(&self) -> Result<(), ModelError> {
        let product = |n: [u32; 3]| n.iter().map(|n| f64::from(*n)).product::<f64>();
        let of_block = |b: &DeckBlock| product(b.mesh) * product(b.copies.unwrap_or([1; 3]));
        let arch = |a: &super::deck::DeckArch| product(a.mesh) * (f64::from(a.voussoirs) + 2.0);
        let total = self.deck.blocks.iter().map(of_block).sum::<f64>()
            + self.deck.arch.as_ref().map_or(0.0, arch);
        if total <= MOST_ELEMENTS {
            return Ok(());
        }
        let largest = (0..self.deck.blocks.len()).max_by(|a, b| {
            of_block(&self.deck.blocks[*a]).total_cmp(&of_block(&self.deck.blocks[*b]))
        });
        let path = largest.map_or("arch.mesh".to_owned(), |i| format!("blocks.{i}.mesh"));
        Err(self.deck.error(
            &path,
            format!("{total} elements are too many"),
            "at most 1e7 elements: coarsen `mesh`, or lay fewer blocks",
        ))
    }

    /// Lays a block and its copies.
    fn lay(&mut self, index: usize, block: &DeckBlock) -> Result<(), ModelError> {
        let first = self.placed.len();
        let material = self.material(&block.material);
        let own = match self.deck.block_nodes(index)? {
            Some(nodes) => Shape::Grid(nodes),
            None => Shape::Hexahedron(corners(block)),
        };
        let shape = own.map(|x| laid(block, x));
        let copies = block.copies.unwrap_or([1; 3]);
        let pitch = block.pitch.map_or([0.0; 3], |p| p.map(Quantity::get));
        for k in 0..copies[2] {
            for j in 0..copies[1] {
                for i in 0..copies[0] {
                    let at = [i, j, k];
                    let moved =
                        shape.map(|x| [0, 1, 2].map(|d| x[d] + f64::from(at[d]) * pitch[d]));
                    let name = match block.copies {
                        Some(_) => format!("{}-{i}-{j}-{k}", block.name),
                        None => block.name.clone(),
                    };
                    self.add(
                        &format!("blocks.{index}.name"),
                        name,
                        moved,
                        block.mesh,
                        material,
                    )?;
                }
            }
        }
        if block.copies.is_some() {
            self.group(&format!("blocks.{index}.name"), block.name.clone(), first)?;
        }
        let velocity = block.velocity.map(Quantity::get);
        self.velocity.resize(self.mesh.nodes.len(), velocity);
        Ok(())
    }

    fn lay_arch(&mut self) -> Result<(), ModelError> {
        let Some(arch) = &self.deck.arch else {
            return Ok(());
        };
        let first = self.placed.len();
        let material = self.material(&arch.material);
        let Stones {
            voussoirs,
            springings,
        } = stones(arch);
        for (i, corners) in voussoirs.into_iter().enumerate() {
            self.add(
                "arch",
                format!("voussoir-{i}"),
                Shape::Hexahedron(corners),
                arch.mesh,
                material,
            )?;
        }
        self.group("arch", "voussoir".to_owned(), first)?;
        let springing = self.placed.len();
        for (name, corners) in ["springing-left", "springing-right"]
            .into_iter()
            .zip(springings)
        {
            let shape = Shape::Hexahedron(corners);
            self.add("arch", name.to_owned(), shape, [1; 3], material)?;
        }
        self.group("arch", "springing".to_owned(), springing)?;
        self.velocity.resize(self.mesh.nodes.len(), [0.0; 3]);
        Ok(())
    }

    fn add(
        &mut self,
        path: &str,
        name: String,
        shape: Shape,
        mesh: [u32; 3],
        material: u16,
    ) -> Result<(), ModelError> {
        self.require_new(path, &name)?;
        let cells = mesh.map(|n| n as usize);
        let placed = Placed::append(&mut self.mesh, name, shape, cells, material);
        self.placed.push(placed);
        Ok(())
    }

    fn group(&mut self, path: &str, name: String, first: usize) -> Result<(), ModelError> {
        self.require_new(path, &name)?;
        self.groups.push((name, first, self.placed.len()));
        Ok(())
    }

    fn require_new(&self, path: &str, name: &str) -> Result<(), ModelError> {
        if self.find(name).is_none() {
            return Ok(());
        }
        Err(self.deck.error(
            path,
            format!("there are two blocks named `{name}`"),
            "give each a name of its own",
        ))
    }

    fn material(&mut self, name: &str) -> u16 {
        let found = self.materials.iter().position(|m| m == name);
        found.unwrap_or_else(|| {
            self.materials.push(name.to_owned());
            self.materials.len() - 1
        }) as u16
    }

    /// Blocks that a name stands for.
    fn find(&self, name: &str) -> Option<std::ops::Range<usize>> {
        let group = self.groups.iter().find(|(n, _, _)| n == name);
        let single = || self.placed.iter().position(|p| p.name == name);
        group
            .map(|(_, from, to)| *from..*to)
            .or_else(|| single().map(|i| i..i + 1))
    }

    /// What the names at `path` stand for: blocks, or faces of blocks. `faces`: nothing but faces.
    ///
    /// # Errors
    /// No such block or face.
    pub(super) fn places(
        &self,
        path: &str,
        names: &Names,
        faces: bool,
    ) -> Result<Vec<Place>, ModelError> {
        let mut places = Vec::new();
        for name in &names.0 {
            let (block, face) = match name.rsplit_once('.') {
                None if faces => {
                    return Err(self.deck.error(
                        path,
                        format!("`{name}` is no face"),
                        &format!("say which: {name}.top, {name}.left, ..."),
                    ));
                }
                None => (name.as_str(), None),
                Some((block, face)) => {
                    let known = Face::ALL.iter().find(|(known, _)| *known == face);
                    let Some((_, known)) = known else {
                        return Err(self.deck.error(
                            path,
                            format!("`{name}`: a block has no face `{face}`"),
                            "left (-x), right (+x), front (-y), back (+y), bottom (-z), top (+z)",
                        ));
                    };
                    (block, Some(*known))
                }
            };
            let Some(range) = self.find(block) else {
                return Err(self.unknown(path, block));
            };
            places.extend(range.map(|block| Place { block, face }));
        }
        Ok(places)
    }

    fn unknown(&self, path: &str, name: &str) -> ModelError {
        let groups = self.groups.iter().map(|g| g.0.as_str());
        let known = || {
            groups
                .clone()
                .chain(self.placed.iter().map(|p| p.name.as_str()))
        };
        let help = keys::nearest(name, known()).map_or_else(
            || {
                let some: Vec<&str> = known().take(8).collect();
                format!("the deck has {}", some.join(", "))
            },
            |near| format!("did you mean `{near}`?"),
        );
        self.deck
            .error(path, format!("there is no block named `{name}`"), &help)
    }

    /// Nodes of these places, ascending and each once.
    pub(super) fn nodes(&self, places: &[Place]) -> Vec<u32> {
        let of = |place: &Place| -> Vec<u32> {
            let block = &self.placed[place.block];
            match place.face {
                None => block.nodes(),
                Some(face) => block.facets(face).into_iter().flat_map(|f| f.1).collect(),
            }
        };
        let mut nodes: Vec<u32> = places.iter().flat_map(of).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }

    /// Sum of the area vectors of faces, pointing outwards [mm²], and of their magnitudes.
    pub(super) fn area(&self, places: &[Place]) -> ([f64; 3], f64) {
        let (mut sum, mut total) = ([0.0; 3], 0.0);
        for place in places {
            let block = &self.placed[place.block];
            for (_, facet) in place.face.map_or_else(Vec::new, |face| block.facets(face)) {
                let area = area_vector(&facet.map(|n| self.mesh.nodes[n as usize]));
                total += norm(area);
                (0..3).for_each(|d| sum[d] += area[d]);
            }
        }
        (sum, total)
    }

    /// Supports of the deck and of the springings.
    ///
    /// # Errors
    /// Names of nothing.
    pub(super) fn supports(&self) -> Result<Vec<Support>, ModelError> {
        let mut supports = Vec::new();
        for (i, support) in self.deck.supports.iter().enumerate() {
            let places = self.places(&format!("supports.{i}.on"), &support.on, false)?;
            let mut fixed = [false; 3];
            for axis in &support.fixed {
                fixed[axis.index()] = true;
            }
            supports.push(Support {
                name: support.on.0.join(", "),
                nodes: self.nodes(&places),
                fixed,
            });
        }
        if self.deck.arch.is_some() {
            let springing = Names(vec!["springing".to_owned()]);
            supports.push(Support {
                name: "springings".to_owned(),
                nodes: self.nodes(&self.places("arch", &springing, false)?),
                fixed: [true; 3],
            });
        }
        Ok(supports)
    }

    /// Springs of the deck.
    ///
    /// # Errors
    /// Names of nothing, or two springs of one name.
    pub(super) fn springs(&self) -> Result<Vec<Spring>, ModelError> {
        let mut springs: Vec<Spring> = Vec::new();
        for (i, spring) in self.deck.springs.iter().enumerate() {
            if springs.iter().any(|s| s.name == spring.name) {
                return Err(self.deck.error(
                    &format!("springs.{i}.name"),
                    format!("there are two springs named `{}`", spring.name),
                    "give each a name of its own",
                ));
            }
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

/// Corners of a block [mm]: its box or its own, before it is laid.
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

/// Where a point of a block lies [mm]: turned about the origin, then moved to `at`.
fn laid(block: &DeckBlock, x: [f64; 3]) -> [f64; 3] {
    let at = block.at.map(Quantity::get);
    let x = block.rotate.map_or(x, |Rotation { axis, angle }| {
        let (d, sign) = axis.axis();
        let mut unit = [0.0; 3];
        unit[d] = sign;
        turned(x, unit, angle.get().to_radians())
    });
    [0, 1, 2].map(|d| at[d] + x[d])
}
