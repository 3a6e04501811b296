//! Difficult cases: the stability atlas, moving blocks, general contact.

#![expect(
    clippy::too_many_lines,
    reason = "a test is read from its input to what it checks, and many are tables of cases"
)]

#[path = "../common/mod.rs"]
mod common;

mod atlas;
mod careful;
mod general_contact;
mod moving_blocks;
