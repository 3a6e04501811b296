//! From a frozen model to its converged frames.

pub mod drive;
mod explain;
mod line_search;
mod newton;
mod schedule;
pub mod state;

pub use drive::{RunError, run};
pub use newton::Clock;
pub use state::State;
