//! Names of the faces of stones that a file brings.

use super::{NameRegistry, Place};
use crate::deck::schema::Deck;
use crate::error::{ErrorKind, ModelError};

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
}
