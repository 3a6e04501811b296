//! Units, laws, elements, contact and the solver against closed forms, finite differences and each other. The test
//! modules mirror the modules of the library (ARCHITECTURE.md).

#![expect(
    clippy::too_many_lines,
    reason = "a test is read from its input to what it checks, and many are tables of cases"
)]

#[path = "../common/mod.rs"]
mod common;

mod assembly;
mod contact;
mod deck;
mod element;
mod limit;
mod limits;
mod linear;
mod material;
mod model;
mod results;
mod rooms;
mod solve;
