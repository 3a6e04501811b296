//! What is computed: the frozen [`Model`], and how it is made from a [`Deck`].

pub mod build;
pub mod check;
pub mod deck;
mod findings;
pub mod keys;
pub mod layout;
pub mod mesh;
mod overrides;
pub mod quantity;
pub mod scene;
mod source;
mod supports;
mod tables;
mod unit;
pub mod wall;

pub use check::{CheckReport, check};
pub use deck::Deck;
pub use mesh::Mesh;
pub use scene::Model;
