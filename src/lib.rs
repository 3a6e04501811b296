//! wythe pushes walls of bricks to collapse: the detailed micro-model of masonry.
#![forbid(unsafe_code)]

pub use wythe_contact as contact;
pub use wythe_core::*;

/// The Rust code of the README, run as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

/// The Rust code of the guide, run as tests.
#[cfg(doctest)]
#[doc = include_str!("../docs/how-to/use-from-rust.md")]
struct UseFromRust;
