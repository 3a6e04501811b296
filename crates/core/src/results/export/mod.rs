//! A run in the formats of other programs: VTU for VTK, CSV for spreadsheets, INP for Abaqus.

pub mod inp;
pub mod table;
pub mod vtu;

/// Name of a frame's file: `frame_0007`, and what comes after it.
pub fn frame_name(number: usize, rest: &str) -> String {
    format!("frame_{number:04}{rest}")
}
