//! What is computed: the frozen [`Model`], and how it is made from a [`Deck`].

mod arch;
mod blocks;
pub mod build;
mod build_blocks;
pub mod check;
pub mod deck;
mod findings;
pub mod general;
mod gravity;
pub mod hexahedron;
mod joint;
pub mod keys;
pub mod layout;
mod loading;
mod meeting;
pub mod mesh;
mod overrides;
mod pairing;
pub mod probes;
pub mod quantity;
mod roll;
pub mod scatter;
pub mod scene;
pub mod schema;
pub mod skin;
pub(crate) mod source;
mod supports;
mod tables;
pub mod templates;
mod touch;
mod unit;
pub mod wall;

pub use check::{CheckReport, check};
pub use deck::Deck;
pub use mesh::Mesh;
pub use scene::Model;
