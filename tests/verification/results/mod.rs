//! Tests of the module `results`.

mod files;
mod probes;
