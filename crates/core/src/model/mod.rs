//! The frozen [`Model`] of a scene: mesh, bodies, joints, supports, loads and steps. It does not depend on TOML.

pub mod amplitude;
pub mod axis;
pub mod boundary_facets;
pub mod builder;
pub mod columns;
pub mod drive;
mod dry_faces;
pub mod floors;
pub mod general;
pub mod live;
pub mod loads;
pub mod mesh;
pub mod mirrored;
pub mod probes;
pub mod reactions;
pub(crate) mod rounding;
pub mod scene;
pub mod sections;
pub mod sizes;
pub mod steps;
pub mod surfaces;
pub mod ties;

pub use mesh::Mesh;
pub use scene::Model;
