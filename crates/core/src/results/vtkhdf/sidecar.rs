//! `results.interfaces.vtkhdf`: shows `/interfaces` to VTK, which reads only a group called VTKHDF.

use std::io;
use std::path::{Path, PathBuf};

use hdf5_metno as hdf5;

use super::{INTERFACES, into_io};

/// The sidecar of a file of fields.
pub fn path_of(fields: &Path) -> PathBuf {
    fields.with_extension("interfaces.vtkhdf")
}

/// Writes the sidecar, a link by name to what lies beside it, or removes one where there are no interfaces.
///
/// # Errors
/// It cannot be written or removed.
pub fn write(fields: &Path, there_are_interfaces: bool) -> io::Result<()> {
    let path = path_of(fields);
    if !there_are_interfaces {
        return match std::fs::remove_file(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => Err(error),
            _ => Ok(()),
        };
    }
    let temporary = fields.with_extension("interfaces.vtkhdf.tmp");
    let name = fields.file_name().unwrap_or_default().to_string_lossy();
    let link = || -> hdf5::Result<()> {
        let file = hdf5::File::create(&temporary)?;
        file.link_external(&name, &format!("/{INTERFACES}"), "VTKHDF")?;
        file.close()
    };
    let written = link()
        .map_err(|error| into_io(&error))
        .and_then(|()| std::fs::rename(&temporary, &path));
    if written.is_err() {
        // Best effort: the error that matters is the first.
        let _ = std::fs::remove_file(&temporary);
    }
    written
}
