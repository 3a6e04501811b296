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
//! `answers` holds what engineers and codes ask of a run; RunDirectory puts it into summary.json at the end.
//! RunFolder reads them: report (one page), plotting (pictures), comparison (with an experiment), export (VTU,
//! CSV, INP). StoppedRun resumes from them. `estimate` runs companions below the folder and adds the error of the
//! figures to summary.json.
//! ```

#[cfg(feature = "run-folder")]
pub mod animation;
#[cfg(feature = "run-folder")]
pub mod answers;
pub mod backbone;
#[cfg(feature = "run-folder")]
mod beside;
pub mod branch;
#[cfg(feature = "run-folder")]
pub mod checkpoint;
pub mod colours;
pub mod comparison;
pub mod curve;
#[cfg(feature = "run-folder")]
pub mod directory;
#[cfg(feature = "run-folder")]
pub mod elevation;
pub mod estimate;
#[cfg(feature = "run-folder")]
pub mod evaluation;
pub mod export;
pub mod history;
#[cfg(feature = "run-folder")]
pub mod limit;
#[cfg(any(feature = "mcap", feature = "run-folder"))]
mod lock;
#[cfg(feature = "mcap")]
pub mod mcap;
#[cfg(feature = "run-folder")]
pub mod modes;
pub mod output;
#[cfg(feature = "plot")]
pub mod plot;
#[cfg(feature = "plot")]
pub mod plotting;
#[cfg(any(feature = "hdf5", feature = "mcap"))]
mod quarters;
#[cfg(feature = "run-folder")]
pub mod reading;
#[cfg(feature = "run-folder")]
pub mod report;
#[cfg(feature = "run-folder")]
pub mod resuming;
#[cfg(feature = "run-folder")]
pub mod snapshot;
pub mod summary;
#[cfg(any(feature = "plot", feature = "run-folder"))]
pub(crate) mod svg_text;
pub mod usage;
pub mod verdict;
#[cfg(feature = "hdf5")]
pub mod vtkhdf;
#[cfg(feature = "run-folder")]
pub mod wall_picture;

#[cfg(test)]
pub(crate) mod fake;

pub use crate::experiment::{Experiment, ExperimentError};
#[cfg(feature = "run-folder")]
pub use answers::Answers;
pub use comparison::{Comparison, compare};
pub use curve::{Curve, StepOfCurve};
#[cfg(feature = "run-folder")]
pub use directory::RunDirectory;
pub use history::HistoryWriter;
#[cfg(feature = "run-folder")]
pub use limit::FoundLimit;
#[cfg(feature = "mcap")]
pub use mcap::McapWriter;
#[cfg(feature = "run-folder")]
pub use modes::{FoundModes, ModesError};
pub use output::OutputError;
#[cfg(feature = "run-folder")]
pub use reading::{ReadError, ReadHistory, RunFolder};
#[cfg(feature = "run-folder")]
pub use report::Report;
#[cfg(feature = "run-folder")]
pub use resuming::{ResumeError, Resumed, StoppedRun};
#[cfg(feature = "run-folder")]
pub use snapshot::{FrameChoice, Snapshot};
pub use summary::SummaryFile;
pub use verdict::{Verdict, VerdictKind};
#[cfg(feature = "hdf5")]
pub use vtkhdf::VtkHdfWriter;
#[cfg(feature = "hdf5")]
pub use vtkhdf::read::FieldsFile;
