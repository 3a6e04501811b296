//! Names of courses and storeys of walls.

use super::NameRegistry;
use crate::deck::schema::Deck;
use crate::element::hexahedron::Face;
use crate::error::{ErrorKind, ModelError};

impl NameRegistry {
    /// Name of a body or group, and index of its face, if the name has one.
    ///
    /// # Errors
    /// Unknown face, course or storey.
    pub(super) fn split<'n>(
        &self,
        deck: &Deck,
        path: &str,
        name: &'n str,
    ) -> Result<(&'n str, Option<usize>), ModelError> {
        if self.layers.contains_key(name) {
            return Ok((name, None));
        }
        let Some((body, face)) = name.rsplit_once('.') else {
            return Ok((name, None));
        };
        let known = Face::ALL.iter().find(|(known, _)| *known == face);
        if known.is_none() && !is_layer(face) {
            return Err(deck
                .error(
                    path,
                    format!("`{name}`: a block has no face `{face}`"),
                    "left (-x), right (+x), front (-y), back (+y), bottom (-z), top (+z)",
                )
                .of_kind(ErrorKind::UnknownName));
        }
        let whole = if known.is_some() { body } else { name };
        let wall = whole.rsplit_once('.').filter(|(_, layer)| is_layer(layer));
        if let Some((wall, _)) = wall.filter(|_| !self.layers.contains_key(whole)) {
            return Err(self.unknown_layer(deck, path, whole, wall));
        }
        Ok((whole, known.map(|(_, face)| *face as usize)))
    }

    /// Error of a course or storey that a wall has not.
    fn unknown_layer(&self, deck: &Deck, path: &str, name: &str, wall: &str) -> ModelError {
        let count = |kind: &str, first: usize| {
            (first..=usize::from(u16::MAX))
                .take_while(|k| self.layers.contains_key(&format!("{wall}.{kind}-{k}")))
                .count()
        };
        let help = match [count("course", 0), count("storey", 1)] {
            [0, _] => "only walls have courses and storeys".to_owned(),
            [courses, 0] => format!(
                "courses 0 to {}; no storeys: `storeys` of the wall gives their heights",
                courses - 1
            ),
            [courses, storeys] => format!("courses 0 to {}, storeys 1 to {storeys}", courses - 1),
        };
        deck.error(path, format!("there is no `{name}`"), &help)
            .of_kind(ErrorKind::UnknownName)
    }
}

/// Whether a part of a name is that of a course or a storey.
fn is_layer(name: &str) -> bool {
    name.starts_with("course-") || name.starts_with("storey-")
}
