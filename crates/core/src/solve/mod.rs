//! From a frozen model to its converged frames.

mod balance;
pub mod checkpoint;
mod closure;
mod collapse;
mod commit;
mod course;

mod direction;
pub mod drive;
mod dynamics;
mod elimination;
mod energy_watch;
mod explain;
mod fidelity;
mod fields;
mod fingerprint;
mod follow;
mod hidden;
mod inertia;
mod judge;
mod kept;
mod ladder;
mod line_search;
mod loads;
mod method;
mod newton;
mod outcome;
mod path;
mod peak;
mod predict;
mod probes;
mod refuse;
mod relaxation;
mod schedule;
pub mod state;
mod stop;
mod tally;
mod told;

pub use checkpoint::{Checkpoint, CheckpointError, resume};
pub use drive::{RunError, run};
pub use method::Method;
pub use outcome::Clock;
pub use state::State;
