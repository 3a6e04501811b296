//! Tests of the module `results`.

mod answers;
mod files;
mod probes;
mod sections;
