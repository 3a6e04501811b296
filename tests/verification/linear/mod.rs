//! Tests of the module `linear`.

mod eigen;
mod elimination;
mod factors;
