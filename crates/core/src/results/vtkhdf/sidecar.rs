//! `results.interfaces.vtkhdf`: shows `/interfaces` to VTK, which reads only a group called VTKHDF.

use std::io;
use std::path::{Path, PathBuf};

use hdf5_metno as hdf5;

use super::{INTERFACES, into_io};
use crate::files::{self, NewFile};

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
        return files::remove(&path);
    }
    let new = NewFile::create(&path)?;
    let name = fields.file_name().unwrap_or_default().to_string_lossy();
    let link = || -> hdf5::Result<()> {
        // Its own file anew: HDF5 takes no open one.
        files::remove(new.temporary()).map_err(|error| error.to_string())?;
        let file = hdf5::File::create_excl(new.temporary())?;
        file.link_external(&name, &format!("/{INTERFACES}"), "VTKHDF")?;
        file.close()
    };
    link().map_err(|error| into_io(&error))?;
    new.keep().map(drop)
}
