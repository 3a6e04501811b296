//! `results.interfaces.vtkhdf`: makes `/interfaces` readable for VTK, which only reads a group named VTKHDF.

use std::io;
use std::path::{Path, PathBuf};

use hdf5_metno as hdf5;

use super::{INTERFACES, into_io};
use crate::files::{self, NewFile};

/// Path of the sidecar of a field file.
pub fn path_of(fields: &Path) -> PathBuf {
    fields.with_extension("interfaces.vtkhdf")
}

/// Writes the sidecar, an external link to the group in the field file, or removes it if there are no interfaces.
///
/// # Errors
/// The sidecar cannot be written or removed.
pub fn write(fields: &Path, there_are_interfaces: bool) -> io::Result<()> {
    let path = path_of(fields);
    if !there_are_interfaces {
        return files::remove(&path);
    }
    let new = NewFile::create(&path)?;
    let name = fields.file_name().unwrap_or_default().to_string_lossy();
    let link = || -> hdf5::Result<()> {
        // HDF5 creates its own file; it cannot take over an open one.
        files::remove(new.temporary()).map_err(|error| error.to_string())?;
        let file = hdf5::File::create_excl(new.temporary())?;
        file.link_external(&name, &format!("/{INTERFACES}"), "VTKHDF")?;
        file.close()
    };
    link().map_err(|error| into_io(&error))?;
    new.keep().map(drop)
}
