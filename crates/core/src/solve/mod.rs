//! The solver: takes a frozen model to its converged increments.
//!
//! | Room | Holds |
//! |---|---|
//! | `increment` | one increment: predictor, Newton iterations, line search, convergence |
//! | `stepping` | the steps of a run: increment sizes, procedures, acceptance, peaks, history rows |
//! | `dynamics` | inertia: time integration, onset of motion, collapse |
//! | `restart` | checkpoints and resumed runs |
//! | `fidelity` | solution of a mirror half, or of an elastic substitute, instead of the whole model |
//! | `stability` | whether an equilibrium is stable |
//! | `vibration` | natural modes about a state |

mod dynamics;
mod fidelity;
mod increment;

mod recorder;
mod restart;
mod stability;
mod stepper;
mod stepping;
pub mod vibration;

pub use recorder::Recorder;
pub use restart::checkpoint::{Checkpoint, CheckpointError, resume};
pub use stepper::{Increment, Stepper};

pub use stepping::run::{RunError, run, run_whole};
