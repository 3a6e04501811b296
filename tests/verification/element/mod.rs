//! Tests of the module `element`.

mod corotated;
mod hex8;
