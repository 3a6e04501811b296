//! Tests of the module `linear`.

mod elimination;
mod factors;
