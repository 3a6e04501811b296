//! Contact between faceted surfaces: broad phase, projection, and the cohesive-frictional law.
//!
//! A leaf: it receives positions, facets and history records and returns the force and stiffness
//! of one point against one facet. It knows no mesh, no step and no solver.
#![forbid(unsafe_code)]

pub mod law;

pub use law::{Coupling, InterfaceHistory, InterfaceLaw, PointStatus};
