//! Poses for stiffness reuse.

use serde::{Deserialize, Serialize};
use wythe_contact::PointPair;

/// Positions at which the stiffness of elements and points is taken. Empty: the present positions.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Poses {
    /// Positions of the corners [mm]. `[element][node][xyz]`
    pub solids: Vec<[[f64; 3]; 8]>,
    /// Feet and frames. `[slave facet][point]`
    pub points: Vec<PointPose>,
    /// Whether few enough points slide for the others to keep their numerical stiffness.
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
