//! Tests of the module `model`.

mod builder;
mod floors;
mod layers;
mod mirrors;
mod random_halves;
mod stands_by_symmetry;
mod symmetry;
mod ties;
