//! Tests of the room `model`.

mod builder;
mod mirrors;
mod random_halves;
mod stands_by_symmetry;
mod symmetry;
