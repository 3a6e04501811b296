//! Touches of general contact.

use serde::{Deserialize, Serialize};
use wythe_contact::InterfaceHistory;

/// Kind of a touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Kind {
    /// A node on a facet.
    Corner,
    /// An edge across another.
    Edges,
}

/// A place where two bodies touch, as committed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Touch {
    /// Kind.
    pub kind: Kind,
    /// A touch of a corner and a face: the node of the corner. A touch of two edges: the first edge.
    pub first: u32,
    /// The facet that the corner lies on, or the second edge.
    pub second: u32,
    /// Facets of the first and of the second body between which the forces act.
    pub facets: [u32; 2],
    /// Parameters of the foot on the facet, or of the crossing on each edge [-].
    pub at: [f64; 2],
    /// Contact area [mm²].
    pub area: f64,
    /// Gap at which contact begins [mm]: 0, or the depth at which it was found (negative).
    pub offset: f64,
    /// History of the law.
    pub history: InterfaceHistory,
}

impl Touch {
    /// Kind, first and second. They are unique to a touch.
    pub(crate) fn key(&self) -> (Kind, u32, u32) {
        (self.kind, self.first, self.second)
    }
}
