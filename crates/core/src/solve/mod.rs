//! From a frozen model to its converged frames.
//!
//! | Room | Holds |
//! |---|---|
//! | `increment` | one increment: predictor, Newton iterations, line search, convergence |
//! | `stepping` | the steps of a run: sizes of increments, procedures, acceptance, peaks, history rows |
//! | `dynamics` | inertia: time integration, where bodies begin to move, collapse |
//! | `restart` | checkpoints and resumed runs |
//! | `fidelity` | a mirror half or an elastic stand-in instead of the whole model |

mod dynamics;
mod fidelity;
mod increment;

mod recorder;
mod restart;
mod stepping;

pub use recorder::Recorder;
pub use restart::checkpoint::{Checkpoint, CheckpointError, resume};

pub use stepping::run::{RunError, run};
