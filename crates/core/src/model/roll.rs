//! The names of a scene of blocks, and which blocks each stands for.

use super::deck::{Deck, Names};
use super::hexahedron::Face;
use super::keys;
use crate::error::ModelError;
use std::collections::HashMap;
use std::ops::Range;

/// A block, or one face of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    /// Index of the block.
    pub(super) block: usize,
    /// None: all of it.
    pub(super) face: Option<Face>,
}

/// All blocks in the order in which they are laid, by name: those of the deck with their copies, then the
/// arch: voussoirs, left springing, right springing.
#[derive(Debug, Default)]
pub(super) struct Roll {
    /// Blocks that a name stands for.
    blocks: HashMap<String, Range<usize>>,
    /// Names in order, for advice.
    names: Vec<String>,
    /// Number of blocks.
    count: usize,
}

/// More names than these are a slip, refused elsewhere.
const MOST_NAMES: f64 = 1e6;

impl Roll {
    /// Calls all names of a deck, with an error for each that is there twice; none if there are far too
    /// many.
    pub(super) fn call(deck: &Deck) -> Option<(Self, Vec<ModelError>)> {
        let copies = deck
            .blocks
            .iter()
            .map(|block| block.copies.unwrap_or([1; 3]));
        let copies = copies.map(|n| n.iter().map(|n| f64::from(*n)).product::<f64>());
        let voussoirs = deck
            .arch
            .as_ref()
            .map_or(0.0, |arch| f64::from(arch.voussoirs));
        if copies.sum::<f64>() + voussoirs > MOST_NAMES {
            return None;
        }
        let (mut roll, mut twice) = (Self::default(), Vec::new());
        for (index, block) in deck.blocks.iter().enumerate() {
            let first = roll.count;
            let mut new = true;
            for name in names_of_copies(&block.name, block.copies) {
                new &= roll.add(name);
            }
            if block.copies.is_some() {
                new &= roll.group(&block.name, first);
            }
            if !new {
                twice.push(deck.error(
                    &format!("blocks.{index}.name"),
                    format!("there are two blocks named `{}`", block.name),
                    "give each a name of its own",
                ));
            }
        }
        if let Some(arch) = &deck.arch {
            let first = roll.count;
            let mut new = true;
            for i in 0..arch.voussoirs {
                new &= roll.add(format!("voussoir-{i}"));
            }
            new &= roll.group("voussoir", first);
            let springing = roll.count;
            for side in ["left", "right"] {
                new &= roll.add(format!("springing-{side}"));
            }
            new &= roll.group("springing", springing);
            if !new {
                twice.push(deck.error(
                    "arch",
                    "a block has the name of a stone of the arch",
                    "call it neither `voussoir` nor `springing`",
                ));
            }
        }
        Some((roll, twice))
    }

    /// Adds a block; false if its name is taken.
    fn add(&mut self, name: String) -> bool {
        let here = self.count..self.count + 1;
        self.count += 1;
        self.names.push(name.clone());
        self.blocks.insert(name, here).is_none()
    }

    /// Adds a name for all blocks from `first` on; false if it is taken.
    fn group(&mut self, name: &str, first: usize) -> bool {
        self.names.push(name.to_owned());
        let all = first..self.count;
        self.blocks.insert(name.to_owned(), all).is_none()
    }

    /// What the names at `path` stand for: blocks, or faces of blocks. `faces`: nothing but faces.
    ///
    /// # Errors
    /// No such block or face.
    pub(super) fn places(
        &self,
        deck: &Deck,
        path: &str,
        names: &Names,
        faces: bool,
    ) -> Result<Vec<Place>, ModelError> {
        let mut places = Vec::new();
        for name in &names.0 {
            let (range, face) = self.place(deck, path, name, faces)?;
            places.extend(range.map(|block| Place { block, face }));
        }
        Ok(places)
    }

    /// What one name at `path` stands for.
    ///
    /// # Errors
    /// No such block or face.
    pub(super) fn place(
        &self,
        deck: &Deck,
        path: &str,
        name: &str,
        faces: bool,
    ) -> Result<(Range<usize>, Option<Face>), ModelError> {
        let (block, face) = match name.rsplit_once('.') {
            None if faces => {
                return Err(deck.error(
                    path,
                    format!("`{name}` is no face"),
                    &format!("say which: {name}.top, {name}.left, ..."),
                ));
            }
            None => (name, None),
            Some((block, face)) => {
                let known = Face::ALL.iter().find(|(known, _)| *known == face);
                let Some((_, known)) = known else {
                    return Err(deck.error(
                        path,
                        format!("`{name}`: a block has no face `{face}`"),
                        "left (-x), right (+x), front (-y), back (+y), bottom (-z), top (+z)",
                    ));
                };
                (block, Some(*known))
            }
        };
        let range = self.blocks.get(block).cloned();
        let range = range.ok_or_else(|| self.unknown(deck, path, block))?;
        Ok((range, face))
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
    }
}

/// NAME, or NAME-0-0-0, NAME-1-0-0, … along x first.
fn names_of_copies(name: &str, copies: Option<[u32; 3]>) -> Vec<String> {
    let Some([nx, ny, nz]) = copies else {
        return vec![name.to_owned()];
    };
    let planes = (0..nz).flat_map(|k| (0..ny).map(move |j| (j, k)));
    let all = planes.flat_map(|(j, k)| (0..nx).map(move |i| (i, j, k)));
    all.map(|(i, j, k)| format!("{name}-{i}-{j}-{k}")).collect()
}
