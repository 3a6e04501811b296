//! What is computed: the frozen [`Model`], and how it is made from a [`Deck`].

mod arch;
mod bodies;
pub mod body;
mod build;
pub mod check;
pub mod deck;
mod findings;
mod gravity;
mod held;
pub mod hexahedron;
pub mod import;
mod imported;
mod joint;
pub mod keys;
mod loading;
pub mod masonry;
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
pub(crate) mod source;
mod tables;
pub mod templates;
mod touch;
mod unit;

pub use check::{CheckReport, check};
pub use deck::Deck;
pub use mesh::Mesh;
pub use scene::Model;
