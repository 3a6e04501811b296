//! Names of a scene, and the bodies that each denotes.

mod layers;
mod stones;

use super::imported::{Imported, Part};
use super::keys;
use super::masonry::{Half, Masonry, Unit};
use super::schema::{Deck, DeckArch, DeckBlock, Names};
use super::stones::FileStones;
use crate::element::hexahedron::Face;
use crate::error::{ErrorKind, ModelError};
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// A body, or one face of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// Index of the body.
    pub(super) body: usize,
    /// Index of its face; none: the whole body.
    pub(super) face: Option<usize>,
    /// Whether it belongs to a side of a wall, a course or a storey.
    pub(super) side: bool,
}

/// Bodies and sets of an import.
#[derive(Debug, Default)]
struct Brought {
    /// Its bodies.
    bodies: Range<usize>,
    /// Sets that the deck mentions: all places, and those with facets. `[name][faces only]`
    sets: HashMap<String, [Vec<Place>; 2]>,
    /// All names of its file, for advice.
    names: Vec<String>,
    /// Whether its file was not read, so that any name may exist.
    unread: bool,
}

/// Names of all bodies. Bodies are in this order: units of walls, blocks with their copies, imported bodies,
/// voussoirs, left springing, right springing.
#[derive(Debug, Default)]
pub(super) struct NameRegistry {
    /// Bodies that a name denotes.
    bodies: HashMap<String, Range<usize>>,
    /// Units at each side of a wall, by the name of the wall. `[face]`
    sides: HashMap<String, [Vec<usize>; 6]>,
    /// Units of the courses and storeys of walls, by name.
    layers: HashMap<String, Vec<usize>>,
    /// Faces at each side of a block of a file, by the index of the block; none for hexahedra. `[face]`
    stones: HashMap<usize, [Vec<usize>; 6]>,
    /// Names of blocks of files that were not read.
    unread: Vec<String>,
    /// Imports by name.
    imports: HashMap<String, Brought>,
    /// Names in order, for advice; without those of single units.
    names: Vec<String>,
    /// Number of bodies.
    count: usize,
}

/// Largest number of names; more are rejected elsewhere.
const MOST_NAMES: f64 = 1e6;

impl NameRegistry {
    /// Registers all names of a deck and returns an error for each duplicate; none if there are too many names.
    /// `files`: imports and blocks of files (`[block]`); none if their files are not read.
    pub(super) fn call(
        deck: &Deck,
        walls: &[Masonry<'_>],
        files: Option<(&[Imported], &[Option<FileStones>])>,
    ) -> Option<(Self, Vec<ModelError>)> {
        let copies = deck.blocks.iter().map(|block| {
            let copies = block.copies.unwrap_or([1; 3]).map(f64::from);
            copies.iter().product::<f64>() * f64::from(block.stack.unwrap_or(1))
        });
        let voussoirs = deck
            .arch
            .as_ref()
            .map_or(0.0, |arch| f64::from(arch.voussoirs));
        if copies.sum::<f64>() + voussoirs > MOST_NAMES {
            return None;
        }
        let (mut roll, mut twice) = (Self::default(), Vec::new());
        let own_name = "give each a name of its own";
        let two_blocks = |path: &str, name: &str| {
            deck.error(
                path,
                format!("there are two blocks named `{name}`"),
                own_name,
            )
            .of_kind(ErrorKind::Conflict)
        };
        for wall in walls {
            if !roll.add_wall(wall) {
                let message = format!("there are two walls named `{}`", wall.name);
                twice.push(
                    deck.error(&format!("{}.name", wall.path), message, own_name)
                        .of_kind(ErrorKind::UnknownName),
                );
            }
        }
        for (index, block) in deck.blocks.iter().enumerate() {
            let stones = files.and_then(|(_, stones)| stones[index].as_ref());
            if !roll.add_block(block, stones) {
                twice.push(two_blocks(&format!("blocks.{index}.name"), &block.name));
            }
        }
        let beams = deck.beams.iter().map(|beam| ("beams", &beam.name));
        let layers = deck.layers.iter().map(|layer| ("layers", &layer.name));
        for (i, (table, name)) in beams.enumerate().chain(layers.enumerate()) {
            if !roll.add(name.clone()) {
                twice.push(two_blocks(&format!("{table}.{i}.name"), name));
            }
        }
        for (i, import) in deck.imports.iter().enumerate() {
            let imported = files.and_then(|(all, _)| all.get(i));
            roll.add_import(&import.name, imported);
        }
        if let Some(arch) = &deck.arch
            && !roll.add_arch(arch)
        {
            twice.push(
                deck.error(
                    "arch",
                    "a block has the name of a stone of the arch",
                    "call it neither `voussoir` nor `springing`",
                )
                .of_kind(ErrorKind::Conflict),
            );
        }
        Some((roll, twice))
    }

    /// Adds a block, or its copies and the block; returns false if a name is taken.
    /// `stones`: those of its file; none if files are not read.
    fn add_block(&mut self, block: &DeckBlock, stones: Option<&FileStones>) -> bool {
        let first = self.count;
        if block.file.is_some() {
            if let Some(stones) = stones {
                return self.add_stones(block, stones);
            }
            self.names.push(block.name.clone());
            self.unread.push(block.name.clone());
            return true;
        }
        let names = match block.stack {
            Some(count) => (0..count).map(|k| format!("{}-{k}", block.name)).collect(),
            None => names_of_copies(&block.name, block.copies),
        };
        let new = self.add_all(names);
        let is_group = block.copies.is_some() || block.stack.is_some();
        (!is_group || self.group(&block.name, first)) && new
    }

    /// Adds the blocks of a file, and the names that mean several of them; returns false if a name is taken.
    fn add_stones(&mut self, block: &DeckBlock, stones: &FileStones) -> bool {
        let first = self.count;
        let new = self.add_all(stones.all.iter().map(|stone| stone.name.clone()));
        for (i, stone) in stones.all.iter().enumerate() {
            if let Some(sides) = &stone.sides {
                self.stones.insert(first + i, sides.clone());
            }
        }
        let mut new = self.group(&block.name, first) && new;
        for (name, range) in &stones.groups {
            self.names.push(name.clone());
            let all = first + range.start..first + range.end;
            new &= self.bodies.insert(name.clone(), all).is_none();
        }
        new
    }

    /// Adds the stones of an arch; returns false if a name is taken.
    fn add_arch(&mut self, arch: &DeckArch) -> bool {
        let first = self.count;
        let mut new = self.add_all((0..arch.voussoirs).map(|i| format!("voussoir-{i}")));
        new &= self.group("voussoir", first);
        let springing = self.count;
        new &= self.add_all(["springing-left", "springing-right"].map(str::to_owned));
        self.group("springing", springing) && new
    }

    /// Adds bodies; returns false if a name is taken.
    fn add_all(&mut self, names: impl IntoIterator<Item = String>) -> bool {
        let taken = names.into_iter().filter(|name| !self.add(name.clone()));
        taken.count() == 0
    }

    /// Adds the units of a wall, and the wall; returns false if a name is taken.
    fn add_wall(&mut self, wall: &Masonry<'_>) -> bool {
        let first = self.count;
        let mut new = true;
        for unit in &wall.units {
            let here = self.count..self.count + 1;
            self.count += 1;
            new &= self.bodies.insert(unit.name(&wall.name), here).is_none();
            if unit.half == Some(Half::Right) {
                new &= self.add_halves(wall, unit);
            }
        }
        let sides = Face::ALL.map(|(_, face)| wall.on(face));
        self.sides.insert(wall.name.clone(), sides);
        for layer in wall.layers() {
            let name = format!("{}.{}", wall.name, layer.name);
            self.layers.insert(name.clone(), layer.bodies);
            self.sides.insert(name, layer.sides);
        }
        self.group(&wall.name, first) && new
    }

    /// Adds the name of a unit for its halves, the last two bodies; returns false if it is taken.
    fn add_halves(&mut self, wall: &Masonry<'_>, unit: &Unit) -> bool {
        let [left, right] = [self.count - 2, self.count - 1];
        let along = wall.wall.axes().0;
        let sides = Face::ALL.map(|(_, face)| match face.side() {
            (axis, false) if axis == along => vec![left],
            (axis, true) if axis == along => vec![right],
            _ => vec![left, right],
        });
        let name = unit.whole_name(&wall.name);
        self.sides.insert(name.clone(), sides);
        self.bodies.insert(name, left..right + 1).is_none()
    }

    /// Adds the bodies of an import.
    fn add_import(&mut self, name: &str, imported: Option<&Imported>) {
        let first = self.count;
        let mut brought = Brought {
            unread: imported.is_none(),
            ..Brought::default()
        };
        if let Some(imported) = imported {
            self.count += imported.faces.len();
            let place = |&(body, face): &Part| Place {
                body: first + body,
                face,
                side: false,
            };
            let places = |of: &Vec<_>| of.iter().map(place).collect();
            let sets = imported.sets.iter();
            brought.sets = sets
                .map(|(set, of)| (set.clone(), of.each_ref().map(places)))
                .collect();
            brought.names = imported.names();
        }
        brought.bodies = first..self.count;
        self.names.push(name.to_owned());
        self.imports.insert(name.to_owned(), brought);
    }

    /// Bodies and faces that a set of an import, or the whole import, denotes.
    fn of_import(
        &self,
        deck: &Deck,
        path: &str,
        name: &str,
        faces: bool,
    ) -> Option<Result<Vec<Place>, ModelError>> {
        let (import, set) = name.split_once('.').unwrap_or((name, ""));
        let brought = self.imports.get(import)?;
        if brought.unread {
            return Some(Ok(Vec::new()));
        }
        let known = || brought.names.iter().map(String::as_str);
        if set.is_empty() {
            let all = brought.bodies.clone().map(|body| Place {
                body,
                face: None,
                side: false,
            });
            return Some(if faces {
                let some: Vec<&str> = known().take(8).collect();
                let help = format!("say which of its sets: {}", some.join(", "));
                Err(deck
                    .error(path, format!("`{name}` is no face"), &help)
                    .of_kind(ErrorKind::UnknownName))
            } else {
                Ok(all.collect())
            });
        }
        let Some(places) = brought.sets.get(set) else {
            let help = keys::nearest(set, known()).map_or_else(
                || format!("it has {}", known().take(8).collect::<Vec<_>>().join(", ")),
                |near| format!("did you mean `{import}.{near}`?"),
            );
            let message = format!("`{name}`: the file of {import} has no set named `{set}`");
            return Some(Err(deck
                .error(path, message, &help)
                .of_kind(ErrorKind::UnknownName)));
        };
        let places = &places[usize::from(faces)];
        Some(if places.is_empty() {
            let what = if faces {
                "no side of an element outside"
            } else {
                "no node of an element"
            };
            Err(deck
                .error(
                    path,
                    format!("`{name}`: there is {what} in this set"),
                    "take a surface, or a set of all nodes of a face",
                )
                .of_kind(ErrorKind::UnknownName))
        } else {
            Ok(places.clone())
        })
    }

    /// Adds a body; returns false if its name is taken.
    fn add(&mut self, name: String) -> bool {
        let here = self.count..self.count + 1;
        self.count += 1;
        self.names.push(name.clone());
        self.bodies.insert(name, here).is_none()
    }

    /// Adds a name for all bodies from `first` on; returns false if it is taken.
    fn group(&mut self, name: &str, first: usize) -> bool {
        self.names.push(name.to_owned());
        let all = first..self.count;
        self.bodies.insert(name.to_owned(), all).is_none()
    }

    /// Bodies or faces that the names at `path` denote. `faces`: only faces are accepted.
    ///
    /// # Errors
    /// Unknown block or face.
    pub(super) fn places(
        &self,
        deck: &Deck,
        path: &str,
        names: &Names,
        faces: bool,
    ) -> Result<Vec<Place>, ModelError> {
        let mut places = Vec::new();
        // A repeated name counts once.
        let (mut said, mut known) = (HashSet::new(), HashSet::new());
        for name in names.0.iter().filter(|name| said.insert(name.as_str())) {
            let new = self.place(deck, path, name, faces)?;
            places.extend(
                new.into_iter()
                    .filter(|at| known.insert((at.body, at.face))),
            );
        }
        Ok(places)
    }

    /// Bodies or faces that one name at `path` denotes. A side of a wall denotes the faces of the units that lie in
    /// it.
    ///
    /// # Errors
    /// Unknown body or face.
    pub(super) fn place(
        &self,
        deck: &Deck,
        path: &str,
        name: &str,
        faces: bool,
    ) -> Result<Vec<Place>, ModelError> {
        if let Some(places) = self.of_import(deck, path, name, faces) {
            return places;
        }
        if self.unread.iter().any(|of| {
            let rest = name.strip_prefix(of.as_str());
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with(['-', '.']))
        }) {
            return Ok(Vec::new());
        }
        if !self.stones.is_empty()
            && let Some((body, side)) = name.rsplit_once(".side-")
        {
            return self.side_of_stones(deck, path, body, side);
        }
        let (body, face) = self.split(deck, path, name)?;
        if faces && face.is_none() {
            return Err(deck
                .error(
                    path,
                    format!("`{name}` is no face"),
                    &format!("say which: {name}.top, {name}.left, ..."),
                )
                .of_kind(ErrorKind::UnknownName));
        }
        let place = |body: usize| Place {
            body,
            face,
            side: false,
        };
        if let (Some(sides), Some(face)) = (self.sides.get(body), face) {
            if sides[face].is_empty() {
                return Err(deck
                    .error(
                        path,
                        format!(
                            "`{name}` is not there: a plane of symmetry cuts the wall at this side"
                        ),
                        "leave it out: the plane holds what is cut there, see [[symmetry]]",
                    )
                    .of_kind(ErrorKind::UnknownName));
            }
            let place = |body: &usize| Place {
                side: true,
                ..place(*body)
            };
            return Ok(sides[face].iter().map(place).collect());
        }
        if let Some(layer) = self.layers.get(body) {
            return Ok(layer.iter().copied().map(place).collect());
        }
        let range = self.bodies.get(body).cloned();
        let range = range.ok_or_else(|| self.unknown(deck, path, body))?;
        match face.filter(|_| range.clone().any(|b| self.stones.contains_key(&b))) {
            Some(side) => self.stones_towards(deck, path, name, (range, side)),
            None => Ok(range.map(place).collect()),
        }
    }

    fn unknown(&self, deck: &Deck, path: &str, name: &str) -> ModelError {
        let known = self.names.iter().map(String::as_str);
        let help = keys::nearest(name, known.clone()).map_or_else(
            || {
                let some: Vec<&str> = known.take(8).collect();
                format!("the deck has {}", some.join(", "))
            },
            |near| format!("did you mean `{near}`?"),
        );
        deck.error(path, format!("there is no block named `{name}`"), &help)
            .of_kind(ErrorKind::UnknownName)
    }
}

/// NAME, or NAME-0-0-0, NAME-1-0-0, …, along x first.
fn names_of_copies(name: &str, copies: Option<[u32; 3]>) -> Vec<String> {
    let Some([nx, ny, nz]) = copies else {
        return vec![name.to_owned()];
    };
    let planes = (0..nz).flat_map(|k| (0..ny).map(move |j| (j, k)));
    let all = planes.flat_map(|(j, k)| (0..nx).map(move |i| (i, j, k)));
    all.map(|(i, j, k)| format!("{name}-{i}-{j}-{k}")).collect()
}
