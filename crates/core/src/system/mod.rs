//! From point laws to a system of equations: unknowns, pattern, gather, linear solvers.

pub mod dofs;
pub mod pattern;

pub use dofs::DofMap;
pub use pattern::Gather;
