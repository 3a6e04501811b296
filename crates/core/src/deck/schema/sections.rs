//! `[[sections]]`: cuts whose resultants the history follows.

use super::{Heading, Names};
use crate::deck::quantity::Length;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_with::skip_serializing_none;

/// A plane cut, or the cuts of all piers and spandrels of a wall. Six columns of the history for each cut: normal
/// force, shear forces, moments, torque.
#[skip_serializing_none]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DeckSection {
    /// Name; the names of the columns begin with it. With `piers`: the name of the wall if absent.
    pub name: Option<String>,
    /// A point of the plane at rest [mm]. `[xyz]`
    pub through: Option<[Length; 3]>,
    /// Normal of the plane; z if absent. The part on its side acts on the other one.
    pub normal: Option<Heading>,
    /// Bodies that are cut; all if absent.
    pub of: Option<Names>,
    /// Lowest and highest corner of a box: elements whose middle lies in it are cut [mm]; all if absent.
    /// `[corner][xyz]`
    #[serde(rename = "box")]
    pub within: Option<[[Length; 3]; 2]>,
    /// A wall with openings: a section in the middle of each of its piers and spandrels.
    pub piers: Option<String>,
}

impl DeckSection {
    /// Direction of the normal, of length 1, or 0 if its vector is 0.
    pub(in crate::deck) fn unit_normal(&self) -> [f64; 3] {
        self.normal.map_or([0.0, 0.0, 1.0], Heading::unit)
    }
}
