//! From a frozen model to its converged frames.

pub mod drive;
mod line_search;
mod newton;
mod schedule;
pub mod state;

pub use drive::{Options, RunError, run};
pub use state::State;
