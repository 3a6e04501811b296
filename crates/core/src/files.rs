//! Reading and writing of files.
//!
//! A file is always written as a new one beside its name, and renamed when it is complete:
//!
//! ```text
//! NAME.tmp   a new file; an existing file or link is removed first
//!    │ rename
//! NAME       the old file or the new one; a link of this name is replaced, never written through
//! ```
//!
//! So a symbolic or hard link to a result, such as a copy of the folder made by `cp -al`, keeps its content.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

/// Path of the file beside `path` whose name is extended by `ending`.
pub fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

/// Removes a file or a link, if there is one.
///
/// # Errors
/// Error of the system.
pub fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(why) if why.kind() != io::ErrorKind::NotFound => Err(why),
        _ => Ok(()),
    }
}

/// Creates a file. An existing file or link is removed and not written through.
///
/// # Errors
/// Error of the system, for instance if a folder has that name.
pub fn create(path: &Path) -> io::Result<File> {
    remove(path)?;
    // `create_new` also refuses a file created in between.
    File::options()
        .read(true)
        .write(true)
        .create_new(true)
        .open(path)
}

/// A file that gets its name when it is kept, and is removed when it is dropped before.
#[derive(Debug)]
pub struct NewFile {
    path: PathBuf,
    temporary: PathBuf,
    file: Option<File>,
}

impl NewFile {
    /// Begins a file with the final name `path`.
    ///
    /// # Errors
    /// Error of the system, or a device, a pipe or a folder has that name.
    pub fn create(path: &Path) -> io::Result<Self> {
        let there = fs::symlink_metadata(path).ok();
        if there.as_ref().is_some_and(fs::Metadata::is_dir) {
            // The system reports the error, because callers in Python expect its number. If it opens the folder, the
            // rename fails.
            File::options().write(true).open(path)?;
        }
        if there.is_some_and(|it| !it.is_file() && !it.is_symlink()) {
            let why = "a folder, a device or a pipe has this name: a result must be a file";
            return Err(io::Error::new(io::ErrorKind::InvalidInput, why));
        }
        let temporary = beside(path, ".tmp");
        Ok(Self {
            path: path.to_owned(),
            file: Some(create(&temporary)?),
            temporary,
        })
    }

    /// Its temporary path.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// Handle to write to.
    ///
    /// # Errors
    /// The handle could not be duplicated.
    pub fn file(&self) -> io::Result<File> {
        let gone = || io::Error::other("it is kept already");
        self.file.as_ref().ok_or_else(gone)?.try_clone()
    }

    /// Gives the file its name. Later writes to the handle go to the same file.
    ///
    /// # Errors
    /// It cannot be renamed. It is removed then.
    pub fn keep(mut self) -> io::Result<File> {
        fs::rename(&self.temporary, &self.path)?;
        let gone = || io::Error::other("it is kept already");
        self.file.take().ok_or_else(gone)
    }
}

impl Drop for NewFile {
    fn drop(&mut self) {
        if self.file.take().is_some() {
            // Best effort, because the caller already has an error.
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

/// Writes a file and syncs it to disk. Under its name there is either the complete file or the old state.
///
/// # Errors
/// It cannot be written, or a device, a pipe or a folder has that name.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let new = NewFile::create(path)?;
    let mut file = new.file()?;
    file.write_all(bytes)?;
    file.sync_all()?;
    new.keep().map(drop)
}

/// Writes a file named by the user like [`write_whole`]. Devices and pipes (`/dev/stdout`, `/dev/fd/63`) are written
/// to directly.
///
/// # Errors
/// It cannot be written.
pub fn write_out(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let stream = |it: &fs::Metadata| !it.is_file() && !it.is_symlink() && !it.is_dir();
    let is_stream = fs::symlink_metadata(path).is_ok_and(|it| stream(&it));
    // Links of the system to open files of this process.
    let of_system = ["/dev", "/proc"].iter().any(|root| path.starts_with(root));
    if is_stream || (of_system && path.exists()) {
        return File::options().write(true).open(path)?.write_all(bytes);
    }
    write_whole(path, bytes)
}

/// Opens a regular file for reading. Links are followed; pipes and devices are rejected.
///
/// # Errors
/// Error of the system, or it is not a regular file.
pub fn open(path: &Path) -> io::Result<File> {
    let about = fs::metadata(path)?;
    if about.is_dir() {
        return Err(io::ErrorKind::IsADirectory.into());
    }
    if !about.is_file() {
        let why = "this is a device or a pipe, not a file";
        return Err(io::Error::new(io::ErrorKind::InvalidInput, why));
    }
    File::open(path)
}

/// Reads a file of at most `most` bytes.
///
/// # Errors
/// As [`open`], or the file is longer.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if read as u64 > most {
        let why = format!("it is longer than the {most} bytes that such a file may have");
        return Err(io::Error::new(io::ErrorKind::InvalidData, why));
    }
    Ok(bytes)
}

/// Reads a text file of at most `most` bytes.
///
/// # Errors
/// As [`read`], or it is not UTF-8.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    String::from_utf8(read(path, most)?).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let why = format!("it is no text: byte {at} is not UTF-8");
        io::Error::new(io::ErrorKind::InvalidData, why)
    })
}

/// Number of bytes at the start of a file, and their CRC-32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Extent {
    /// Number of bytes.
    pub bytes: u64,
    /// Checksum.
    pub sum: u32,
}

impl Extent {
    /// Length and checksum of `bytes`.
    pub fn of(bytes: &[u8]) -> Self {
        Self {
            bytes: bytes.len() as u64,
            sum: crc32fast::hash(bytes),
        }
    }

    /// Reads these bytes of a file.
    ///
    /// # Errors
    /// As [`open`], or the file is shorter, or its bytes differ.
    pub fn read(self, path: &Path) -> io::Result<Vec<u8>> {
        let wrong = |why: &str| io::Error::new(io::ErrorKind::InvalidData, why.to_owned());
        let mut bytes = Vec::new();
        open(path)?.take(self.bytes).read_to_end(&mut bytes)?;
        if (bytes.len() as u64) < self.bytes {
            return Err(wrong("it ends before the checkpoint"));
        }
        if crc32fast::hash(&bytes) != self.sum {
            return Err(wrong("its check sum differs from that in the checkpoint"));
        }
        Ok(bytes)
    }
}

/// Copies all bytes. Returns their number and checksum.
///
/// # Errors
/// Reading or writing fails.
pub fn copy(from: &mut impl Read, to: &mut impl Write) -> io::Result<Extent> {
    let mut sum = crc32fast::Hasher::new();
    let (mut piece, mut bytes) = (vec![0; 1 << 16], 0);
    loop {
        match from.read(&mut piece) {
            Ok(0) => break,
            Ok(read) => {
                sum.update(&piece[..read]);
                to.write_all(&piece[..read])?;
                bytes += read as u64;
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(Extent {
        bytes,
        sum: sum.finalize(),
    })
}

/// The one of `inputs` that a new file named `target` would replace: the same file under any name, or a link to it.
pub fn replaced<'a>(target: &Path, inputs: &'a [PathBuf]) -> Option<&'a Path> {
    let target = name_of(target)?;
    // A new name replaces nothing.
    fs::symlink_metadata(&target).ok()?;
    let same = |input: &&PathBuf| {
        name_of(input).as_ref() == Some(&target)
            || input.canonicalize().is_ok_and(|input| input == target)
    };
    inputs.iter().find(same).map(PathBuf::as_path)
}

/// Path of a file with the links of its folder resolved. A link that is the file itself stays one.
fn name_of(path: &Path) -> Option<PathBuf> {
    let Some(Component::Normal(name)) = path.components().next_back() else {
        return None;
    };
    let folder = path.parent().filter(|folder| *folder != OsStr::new(""));
    Some(
        folder
            .unwrap_or(Path::new("."))
            .canonicalize()
            .ok()?
            .join(name),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_whole_or_absent() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("summary.json");
        write_whole(&path, b"whole").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"whole");
        // A folder blocks the temporary file. The old content must remain.
        fs::create_dir(folder.path().join("summary.json.tmp")).unwrap();
        assert!(write_whole(&path, b"half").is_err());
        assert_eq!(fs::read(&path).unwrap(), b"whole");
        // A folder is never replaced.
        let error = write_whole(folder.path(), b"half").unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::IsADirectory, "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn links_are_replaced_and_their_targets_remain() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("mine"), "mine").unwrap();
        for name in ["result", "result.tmp"] {
            symlink(at("mine"), at(name)).unwrap();
        }
        write_whole(&at("result"), b"one").unwrap();
        fs::hard_link(at("result"), at("copy")).unwrap();
        write_whole(&at("result"), b"two").unwrap();
        symlink(at("nowhere"), at("result.tmp")).unwrap();
        let new = NewFile::create(&at("result")).unwrap();
        new.file().unwrap().write_all(b"three").unwrap();
        let mut file = new.keep().unwrap();
        file.write_all(b" and more").unwrap();
        let text = |name: &str| fs::read_to_string(at(name)).unwrap();
        assert_eq!(
            [text("mine"), text("copy"), text("result")],
            ["mine", "one", "three and more"]
        );
        assert!(!at("nowhere").exists() && !at("result.tmp").exists());
        // A file that is not kept leaves no trace.
        drop(NewFile::create(&at("result")).unwrap());
        assert_eq!(text("result"), "three and more");
        assert!(!at("result.tmp").exists());
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn devices_are_written_by_name_only_and_never_read() {
        let full = Path::new("/dev/full");
        assert!(write_whole(full, b"").is_err());
        let error = write_out(full, b"text").unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        assert!(read(Path::new("/dev/zero"), 8).is_err());
        let folder = tempfile::tempdir().unwrap();
        let link = folder.path().join("history.csv");
        std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
        assert!(open(&link).unwrap_err().to_string().contains("device"));
        fs::write(folder.path().join("long"), [b'a'; 9]).unwrap();
        assert!(read(&folder.path().join("long"), 8).is_err());
        assert_eq!(read(&folder.path().join("long"), 9).unwrap().len(), 9);
    }

    #[test]
    fn a_file_is_known_by_all_of_its_names() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::create_dir(at("wall.out")).unwrap();
        for name in ["model.toml", "wall.out/model.toml"] {
            fs::write(at(name), "").unwrap();
        }
        let inputs = [at("wall.out/../model.toml"), at("absent.csv")];
        assert!(replaced(&at("model.toml"), &inputs).is_some());
        assert!(replaced(&at("wall.out/model.toml"), &inputs).is_none());
        assert!(replaced(&at("absent.csv"), &inputs).is_none());
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(at("model.toml"), at("link.toml")).unwrap();
            // The link is the input, or leads to it.
            assert!(replaced(&at("link.toml"), &[at("link.toml")]).is_some());
            assert!(replaced(&at("model.toml"), &[at("link.toml")]).is_some());
            // Replacing a link does not change its target.
            assert!(replaced(&at("link.toml"), &[at("model.toml")]).is_none());
        }
    }
}
