//! Gmsh `.msh` files, versions 2.2 and 4.1, in text or binary form (Gmsh reference manual, "MSH file format").
//!
//! Physical groups become sets: groups of volumes become sets of elements, groups of surfaces become surfaces and
//! sets of their nodes, groups of curves and points become sets of nodes. A group without a name is called
//! `volume-7`, `surface-2`, ….

mod cursor;
mod gather;
mod sections;

use super::{ImportError, ImportedMesh, Wrong};
use cursor::Cursor;
use gather::Gathered;

/// Reads a `.msh`.
///
/// # Errors
/// Data that cannot be read, solids other than hexahedra, surfaces that do not lie on hexahedra.
pub(super) fn read(name: &str, bytes: &[u8]) -> Result<ImportedMesh, ImportError> {
    let files = vec![name.to_owned()];
    match parse(bytes) {
        Ok(mesh) => Ok(ImportedMesh { files, ..mesh }),
        Err(wrong) => Err(wrong.of(&files)),
    }
}

fn parse(bytes: &[u8]) -> Result<ImportedMesh, Wrong> {
    let mut cursor = Cursor::new(bytes);
    let mut gathered = Gathered::default();
    let mut version = None;
    while let Some(line) = cursor.line() {
        let Some(section) = line.trim().strip_prefix('$') else {
            continue; // text between sections has no meaning
        };
        let section = section.to_owned();
        if section == "MeshFormat" {
            version = Some(sections::format(&mut cursor)?);
        } else if let Some(version) = version {
            match section.as_str() {
                "PhysicalNames" => sections::physical_names(&mut cursor, &mut gathered)?,
                "Entities" => sections::entities(&mut cursor, &mut gathered)?,
                "Nodes" => sections::nodes(&mut cursor, &mut gathered, version)?,
                "Elements" => sections::elements(&mut cursor, &mut gathered, version)?,
                "PartitionedEntities" => {
                    return Err(cursor.wrong(
                        "the mesh is cut into partitions",
                        "save it whole: Mesh.NbPartitions = 0",
                    ));
                }
                _ => {}
            }
        } else {
            return Err(cursor.wrong("no $MeshFormat comes first", "is it a file of Gmsh?"));
        }
        cursor.skip_end_of(&section)?;
    }
    if version.is_none() {
        return Err(cursor.wrong("there is no $MeshFormat", "is it a file of Gmsh?"));
    }
    gathered.mesh()
}
