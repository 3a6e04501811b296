//! Results of a run in other formats: VTU for VTK, CSV for spreadsheets, INP for Abaqus; bodies as closed shells.

pub mod inp;
pub mod shells;
#[cfg(feature = "run-folder")]
pub mod table;
#[cfg(feature = "run-folder")]
pub mod vtu;

/// Name of a frame's file: `frame_0007` followed by `rest`.
pub fn frame_name(number: usize, rest: &str) -> String {
    format!("frame_{number:04}{rest}")
}
