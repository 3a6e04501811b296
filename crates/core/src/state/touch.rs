//! Places where bodies touch by general contact.

use serde::{Deserialize, Serialize};
use wythe_contact::InterfaceHistory;

/// How two bodies touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Kind {
    /// A node on a facet.
    Corner,
    /// An edge across another.
    Edges,
}

/// A place where two bodies touch, as a commit leaves it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Touch {
    /// How.
    pub kind: Kind,
    /// The node, or the first edge.
    pub first: u32,
    /// The facet that it is on, or the second edge.
    pub second: u32,
    /// Facets of the first and of the second body between which the forces act.
    pub facets: [u32; 2],
    /// Foot on the facet, or where each edge is crossed [-].
    pub at: [f64; 2],
    /// Area that it stands for [mm²].
    pub area: f64,
    /// Gap at which contact begins [mm]: 0, or how deep it was found (negative).
    pub offset: f64,
    /// History of the law.
    pub history: InterfaceHistory,
}

impl Touch {
    /// Kind, first and second: no two touches share them.
    pub(crate) fn key(&self) -> (Kind, u32, u32) {
        (self.kind, self.first, self.second)
    }
}
