//! Positions at which stiffness is taken.

use serde::{Deserialize, Serialize};
use wythe_contact::PointPair;

/// Where the stiffness of elements and points is taken. Empty: where they are.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Poses {
    /// Positions of the corners [mm]. `[element][node][xyz]`
    pub solids: Vec<[[f64; 3]; 8]>,
    /// Feet and frames. `[slave facet][point]`
    pub points: Vec<PointPose>,
    /// Whether so few points slide that the others keep their numerical stiffness for it.
    pub steady: bool,
}

/// Foot of a contact point on its master facet, and the frame there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PointPose {
    /// Facet and foot.
    pub pair: PointPair,
    /// n, t₁, t₂.
    pub frame: [[f64; 3]; 3],
}
