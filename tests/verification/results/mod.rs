//! Tests of the room `results`.

mod files;
mod probes;
