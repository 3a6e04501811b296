//! Abaqus input files: nodes, hexahedra, sets, surfaces, parts and instances, materials and sections.

mod lines;
mod materials;
mod raw;
mod reader;
mod resolve;
mod sets;

use super::{ImportError, ImportedMesh, Loader};
use lines::Lines;
use reader::Reader;

/// Reads an `.inp`. `load` returns the contents of the files that it includes.
///
/// # Errors
/// Syntax errors, duplicate or unknown labels.
pub(super) fn read(
    name: &str,
    bytes: &[u8],
    load: Loader<'_>,
) -> Result<ImportedMesh, ImportError> {
    let mut lines = Lines::new(load);
    let mut reader = Reader::default();
    let read = lines
        .scan(name, bytes, &mut reader)
        .and_then(|()| reader.end())
        .and_then(resolve::resolve);
    let files = lines.files;
    match read {
        Ok(mesh) => Ok(ImportedMesh { files, ..mesh }),
        Err(wrong) => Err(wrong.of(&files)),
    }
}
