//! Names of the faces of stones that a file brings.

use super::{NameRegistry, Place};
use crate::deck::schema::Deck;
use crate::error::{ErrorKind, ModelError};
use std::ops::Range;

impl NameRegistry {
    /// Face `side` of each block of a file that `body` denotes.
    pub(super) fn side_of_stones(
        &self,
        deck: &Deck,
        path: &str,
        body: &str,
        side: &str,
    ) -> Result<Vec<Place>, ModelError> {
        let range = self.bodies.get(body).cloned();
        let range = range.ok_or_else(|| self.unknown(deck, path, body))?;
        let mut places = Vec::new();
        for body in range {
            let count = self
                .stones
                .get(&body)
                .map_or(0, |sides| sides.iter().map(Vec::len).sum());
            let face = side.parse().ok().filter(|face: &usize| *face < count);
            places.extend(face.map(|face| Place {
                body,
                face: Some(face),
                side: false,
            }));
        }
        if places.is_empty() {
            let message = format!("`{body}` has no face `side-{side}`");
            let help = "stones with other shapes than a hexahedron have side-0, side-1, ...; all have left, right, front, \
                        back, bottom, top";
            return Err(deck
                .error(path, message, help)
                .of_kind(ErrorKind::UnknownName));
        }
        Ok(places)
    }

    /// Faces of bodies that look to one side, for a name that stands for stones of a file. `of`: the bodies, and the index
    /// of the side.
    ///
    /// # Errors
    /// No face looks that way.
    pub(super) fn stones_towards(
        &self,
        deck: &Deck,
        path: &str,
        name: &str,
        (range, side): (Range<usize>, usize),
    ) -> Result<Vec<Place>, ModelError> {
        let mut places = Vec::new();
        for body in range {
            match self.stones.get(&body) {
                Some(sides) => {
                    let of_side = sides[side].iter();
                    places.extend(of_side.map(|face| Place {
                        body,
                        face: Some(*face),
                        side: false,
                    }));
                }
                None => places.push(Place {
                    body,
                    face: Some(side),
                    side: false,
                }),
            }
        }
        if places.is_empty() {
            let message = format!("`{name}`: no face of the stone looks that way");
            let help = "name another side, or one of its faces: side-0, side-1, ...";
            return Err(deck
                .error(path, message, help)
                .of_kind(ErrorKind::UnknownName));
        }
        Ok(places)
    }
}
