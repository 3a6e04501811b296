//! What a run leaves behind.
//!
//! ```text
//! solve ──row, frame──▶ Recorder = RunDirectory ──▶ history.csv          a row an increment
//!                                               ├─▶ results.vtkhdf       a step an output increment
//!                                               ├─▶ model.toml           the deck, overrides taken in
//!                                               ├─▶ checkpoint.bin       to go on from, replaced as the run goes
//!                                               ├─▶ load_displacement.svg, crack_pattern.svg
//!                                               └─▶ summary.json         last: its presence says "whole"
//! RunFolder reads them back; StoppedRun goes on with them.
//! ```

pub mod checkpoint;
pub mod curve;
pub mod directory;
pub mod elevation;
pub mod frame;
pub mod history;
pub mod plot;
pub mod reading;
pub mod resuming;
pub mod summary;
pub mod usage;
pub mod vtkhdf;

#[cfg(test)]
mod fake;

pub use curve::Curve;
pub use directory::{OutputError, RunDirectory};
pub use frame::{
    Frame, HistoryRow, InterfaceFrame, InterfaceState, Recorder, Sizes, Status, Summary,
};
pub use history::HistoryWriter;
pub use reading::{ReadError, ReadHistory, RunFolder};
pub use resuming::{ResumeError, Resumed, StoppedRun};
pub use summary::SummaryFile;
pub use vtkhdf::VtkHdfWriter;
pub use vtkhdf::read::FieldsFile;
