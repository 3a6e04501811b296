//! From a frozen model to its converged frames.

pub mod drive;
mod dynamics;
mod explain;
mod line_search;
mod loads;
mod newton;
mod outcome;
mod probes;
mod schedule;
pub mod state;
mod tally;

pub use drive::{RunError, run};
pub use outcome::Clock;
pub use state::State;
