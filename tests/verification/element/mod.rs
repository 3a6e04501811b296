//! Tests of the room `element`.

mod corotated;
mod hex8;
