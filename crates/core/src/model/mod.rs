//! What is computed: the frozen [`Model`], and how it is made from a deck.

pub mod mesh;
pub mod scene;

pub use mesh::Mesh;
pub use scene::Model;
