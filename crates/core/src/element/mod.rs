//! The eight-node hexahedron: strains, forces and stiffness in a corotated frame, and the kinematics of the frame.

pub mod extent;
pub mod exterior;
pub mod facet;
mod formulation;
pub mod hex8;
pub mod hexahedron;
pub mod inside;
pub mod kinematics;
mod tangent;

pub use extent::extent;
pub use formulation::Formulation;
pub use hex8::{ElementShape, ShapeError};
pub use kinematics::{Corotated, green_strain};
