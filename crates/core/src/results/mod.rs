//! Result files of a run: their writers and their readers.
//!
//! ```text
//! solve ──row, frame──▶ Recorder = RunDirectory ──▶ history.csv          one row per increment
//!                                               ├─▶ results.vtkhdf       one step per output increment; beside it
//!                                               │                        results.interfaces.vtkhdf, which links to it
//!                                               ├─▶ run.mcap             messages per increment
//!                                               ├─▶ model.toml           the deck with its overrides
//!                                               ├─▶ checkpoint.bin       state to resume from, replaced during the run
//!                                               ├─▶ load_displacement.svg, crack_pattern.svg
//!                                               └─▶ summary.json         written last: marks a complete folder
//! RunFolder reads them: report (one page), plotting (pictures), comparison (with an experiment), export (VTU,
//! CSV, INP). StoppedRun resumes from them.
//! ```

mod beside;
pub mod branch;
pub mod checkpoint;
pub mod comparison;
pub mod curve;
pub mod directory;
pub mod elevation;
pub mod export;
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
pub use comparison::{Comparison, compare};
pub use curve::{Curve, StepOfCurve};
pub use directory::{OutputError, RunDirectory};
pub use history::HistoryWriter;
pub use mcap::McapWriter;
pub use reading::{ReadError, ReadHistory, RunFolder};
pub use report::Report;
pub use resuming::{ResumeError, Resumed, StoppedRun};
pub use snapshot::{FrameChoice, Snapshot};
pub use summary::SummaryFile;
pub use verdict::{Verdict, VerdictKind};
pub use vtkhdf::VtkHdfWriter;
pub use vtkhdf::read::FieldsFile;
