//! Tests of the module `results`.

mod answers;
mod files;
mod live_load;
mod probes;
mod sections;
