//! Solver for the detailed micro-model of masonry: from a deck (TOML text) to converged results.
//!
//! Units are N, mm, MPa, tonne and s throughout. Tension is positive; a gap is positive when open.
//!
//! Cargo features: `hdf5` ([`results`]' `results.vtkhdf`), `mcap` (`run.mcap`), `plot` (pictures), and `run-folder`,
//! the default, which is all of them with the folder of a run. Without features no C is compiled.
#![forbid(unsafe_code)]
// Input of users ends in typed errors.
#![cfg_attr(
    not(test),
    deny(clippy::unwrap_used, clippy::expect_used, clippy::panic)
)]

pub mod assembly;
pub mod command;
pub mod deck;
pub mod element;
pub mod error;
pub mod experiment;
pub mod files;
pub mod input;
pub mod limit;
pub mod linear;
pub mod material;
pub mod model;
pub mod point;
pub mod results;
pub mod solve;
pub mod state;
pub mod tensor;
