//! What a run leaves behind.

pub mod frame;

pub use frame::{Frame, HistoryRow, Recorder, Sizes, Status, Summary};
