//! Tests of the room `linear`.

mod elimination;
mod factors;
