//! What a run leaves behind.
//!
//! ```text
//! solve ──row, frame──▶ Recorder = RunDirectory ──▶ history.csv          a row an increment
//!                                               ├─▶ results.vtkhdf       a step an output increment; beside it
//!                                               │                        results.interfaces.vtkhdf, a link
//!                                               ├─▶ run.mcap             messages an increment
//!                                               ├─▶ model.toml           the deck, overrides taken in
//!                                               ├─▶ checkpoint.bin       to go on from, replaced as the run goes
//!                                               ├─▶ load_displacement.svg, crack_pattern.svg
//!                                               └─▶ summary.json         last: its presence says "whole"
//! RunFolder reads them back: report (one page), plotting (pictures), comparison (with an experiment), export (VTU,
//! CSV, INP). StoppedRun goes on with them.
//! ```

mod beside;
pub mod branch;
pub mod checkpoint;
pub mod comparison;
pub mod curve;
pub mod directory;
pub mod elevation;
pub mod export;
pub mod frame;
pub mod history;
pub mod mcap;
pub mod plot;
pub mod plotting;
pub mod reading;
pub mod report;
pub mod resuming;
pub mod snapshot;
pub mod summary;
pub mod usage;
pub mod verdict;
pub mod vtkhdf;

#[cfg(test)]
pub(crate) mod fake;

pub use crate::experiment::{Experiment, ExperimentError};
pub use crate::model::sizes::Sizes;
pub use comparison::{Comparison, compare};
pub use curve::{Curve, StepOfCurve};
pub use directory::{OutputError, RunDirectory};
pub use frame::{
    Fall, FallenBody, Frame, HistoryRow, InterfaceFrame, InterfaceState, Lost, OutputField,
    Recorder, Status, Summary,
};
pub use history::HistoryWriter;
pub use mcap::McapWriter;
pub use reading::{ReadError, ReadHistory, RunFolder};
pub use report::Report;
pub use resuming::{ResumeError, Resumed, StoppedRun};
pub use snapshot::{FrameChoice, Snapshot};
pub use summary::{EnergyBalance, SummaryFile};
pub use verdict::{Verdict, VerdictKind};
pub use vtkhdf::VtkHdfWriter;
pub use vtkhdf::read::FieldsFile;
