//! Contact between faceted surfaces: broad-phase search, projection, and the constitutive laws of joints.
//!
//! This is a leaf crate. It receives positions, facets and history records, and returns the force and the stiffness
//! of one point against one facet. It does not know meshes, load steps or solvers.
#![forbid(unsafe_code)]
// Input of users ends in typed errors.
#![cfg_attr(
    not(test),
    deny(clippy::unwrap_used, clippy::expect_used, clippy::panic)
)]

pub mod aabb;
pub mod bvh;
pub mod cap;
pub mod checks;
mod cohesive;
mod cohesive_frictional;
pub mod edges;
pub mod four;
mod friction;
pub mod joint;
pub mod lanes;
pub mod law;
pub mod pairs;
pub mod part;
pub mod path;
pub mod projection;
pub mod registry;
pub mod shifted;
pub mod softening;
pub mod stencil;
pub mod surface;

pub use aabb::Aabb;
pub use bvh::Bvh;
pub use cap::{Cap, CapCurve};
pub use edges::EdgePair;
pub use four::{FourPlaced, FourSeen, Symmetric, write_symmetric};
pub use joint::{JointLaw, Output};
pub use lanes::Lanes;
pub use law::{
    CohesiveFrictional, Coupling, InterfaceHistory, InterfaceResponse, PointStatus, SLOTS,
};
pub use pairs::{Candidates, PointPair, Reach, Search, pair_point, rim_point, to_frame};
pub use part::Part;
pub use path::{Entry, Place, entry};
pub use projection::{Projection, extend, project};
pub use registry::InterfaceLaw;
pub use shifted::{FlatBranches, Shift};
pub use stencil::{
    Anchor, Kinematics, PointStiffness, PointsAlong, SlavePoint, corner_points, gauss_points,
    points_of, write_stiffness,
};
pub use surface::{Surface, frame_at};
