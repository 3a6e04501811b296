//! The lock of a folder, which one run holds at a time.

use std::fs::{File, TryLockError};
use std::io;
use std::path::Path;

use super::output::{LOCK, OutputError};
use crate::files;

/// Locks a folder for one run.
///
/// # Errors
/// [`OutputError::Busy`], or the lock file cannot be created.
pub(super) fn lock(folder: &Path) -> Result<File, OutputError> {
    let file = writing(folder, LOCK, open_lock)?;
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(OutputError::Busy(folder.to_owned())),
        // A file system without locks cannot exclude a second run.
        Ok(()) | Err(TryLockError::Error(_)) => Ok(file),
    }
}

/// Opens the lock file or creates it. Nothing is written to it.
fn open_lock(path: &Path) -> io::Result<File> {
    match std::fs::symlink_metadata(path) {
        Ok(there) if there.is_file() => File::options().write(true).open(path),
        // Opening a link would open its target; a run never locks a link, so it can be replaced.
        Ok(there) if there.is_symlink() => files::create(path),
        Ok(_) => Err(io::Error::other("there is something else of this name")),
        Err(_) => match File::options().write(true).create_new(true).open(path) {
            // Another process has created it in the meantime.
            Err(why) if why.kind() == io::ErrorKind::AlreadyExists => {
                File::options().write(true).open(path)
            }
            opened => opened,
        },
    }
}

/// Runs an operation on a file of the folder; an error names the file.
pub(super) fn writing<T>(
    folder: &Path,
    name: &str,
    write: impl FnOnce(&Path) -> io::Result<T>,
) -> Result<T, OutputError> {
    let path = folder.join(name);
    write(&path).map_err(|why| OutputError::Write { path, why })
}
