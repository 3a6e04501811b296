//! Files that are written and read.
//!
//! A file is always a new one, written beside its name and moved there when it is whole:
//!
//! ```text
//! NAME.tmp   created anew: one that is there is removed first, be it a link
//!    │ rename
//! NAME       the old file or the new one; a link of this name is replaced, never written through
//! ```
//!
//! So whoever has a symbolic or a hard link to a result, such as a copy of the folder made by `cp -al`, keeps what it had.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Component, Path, PathBuf};

use serde::{Deserialize, Serialize};

/// The file beside `path` whose name goes on with `ending`.
pub fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    name.into()
}

/// Removes a file or a link; none there is as well.
///
/// # Errors
/// The system's.
pub fn remove(path: &Path) -> io::Result<()> {
    match fs::remove_file(path) {
        Err(why) if why.kind() != io::ErrorKind::NotFound => Err(why),
        _ => Ok(()),
    }
}

/// Creates a file, in place of a file or link that is there, which is removed and not written through.
///
/// # Errors
/// The system's; there is a folder of that name.
pub fn create(path: &Path) -> io::Result<File> {
    remove(path)?;
    // Whatever came in between is not opened either.
    File::options()
        .read(true)
        .write(true)
        .create_new(true)
        .open(path)
}

/// A file that takes its name when it is kept, and is removed when it is dropped before.
#[derive(Debug)]
pub struct NewFile {
    path: PathBuf,
    temporary: PathBuf,
    file: Option<File>,
}

impl NewFile {
    /// Begins a file that is to be called `path`.
    ///
    /// # Errors
    /// The system's; a device, a pipe or a folder has that name.
    pub fn create(path: &Path) -> io::Result<Self> {
        let there = fs::symlink_metadata(path).ok();
        if there.as_ref().is_some_and(fs::Metadata::is_dir) {
            // Refused by the system, whose error number callers in Python expect; a folder that it would open is
            // refused by the rename.
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

    /// Where it is written meanwhile.
    pub fn temporary(&self) -> &Path {
        &self.temporary
    }

    /// The file, to be written.
    ///
    /// # Errors
    /// It could not be duplicated.
    pub fn file(&self) -> io::Result<File> {
        let gone = || io::Error::other("it is kept already");
        self.file.as_ref().ok_or_else(gone)?.try_clone()
    }

    /// Gives the file its name; what is written to it from then on is seen under it.
    ///
    /// # Errors
    /// It cannot be moved; it is removed then.
    pub fn keep(mut self) -> io::Result<File> {
        fs::rename(&self.temporary, &self.path)?;
        let gone = || io::Error::other("it is kept already");
        self.file.take().ok_or_else(gone)
    }
}

impl Drop for NewFile {
    fn drop(&mut self) {
        if self.file.take().is_some() {
            // Best effort: whoever drops it has an error already.
            let _ = fs::remove_file(&self.temporary);
        }
    }
}

/// Writes a file, which is on the disk on return: under its name it is either whole or not there.
///
/// # Errors
/// It cannot be written; a device, a pipe or a folder has that name.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let new = NewFile::create(path)?;
    let mut file = new.file()?;
    file.write_all(bytes)?;
    file.sync_all()?;
    new.keep().map(drop)
}

/// Writes what the user has given a name, as [`write_whole`], but that devices and pipes (`/dev/stdout`, `/dev/fd/63`)
/// are written to as they are.
///
/// # Errors
/// It cannot be written.
pub fn write_out(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let stream = |it: &fs::Metadata| !it.is_file() && !it.is_symlink() && !it.is_dir();
    let is_stream = fs::symlink_metadata(path).is_ok_and(|it| stream(&it));
    // Links of the system to what this process has open, a file perhaps.
    let of_system = ["/dev", "/proc"].iter().any(|root| path.starts_with(root));
    if is_stream || (of_system && path.exists()) {
        return File::options().write(true).open(path)?.write_all(bytes);
    }
    write_whole(path, bytes)
}

/// Opens a file to be read. What is none, such as a pipe that never ends, is refused; links are followed.
///
/// # Errors
/// The system's; it is no file.
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
/// As [`open`]; it is longer.
pub fn read(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let read = open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if read as u64 > most {
        let why = format!("it is longer than the {most} bytes that such a file may have");
        return Err(io::Error::new(io::ErrorKind::InvalidData, why));
    }
    Ok(bytes)
}

/// As [`read`], of text.
///
/// # Errors
/// As there; it is not UTF-8.
pub fn read_text(path: &Path, most: u64) -> io::Result<String> {
    String::from_utf8(read(path, most)?).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let why = format!("it is no text: byte {at} is not UTF-8");
        io::Error::new(io::ErrorKind::InvalidData, why)
    })
}

/// The first bytes of a file: how many, and their CRC-32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Extent {
    /// Number of bytes.
    pub bytes: u64,
    /// Check sum of them.
    pub sum: u32,
}

impl Extent {
    /// Of bytes.
    pub fn of(bytes: &[u8]) -> Self {
        Self {
            bytes: bytes.len() as u64,
            sum: crc32fast::hash(bytes),
        }
    }

    /// The bytes of a file that these are.
    ///
    /// # Errors
    /// As [`open`]; the file is shorter, or other bytes stand there.
    pub fn read(self, path: &Path) -> io::Result<Vec<u8>> {
        let wrong = |why: &str| io::Error::new(io::ErrorKind::InvalidData, why.to_owned());
        let mut bytes = Vec::new();
        open(path)?.take(self.bytes).read_to_end(&mut bytes)?;
        if (bytes.len() as u64) < self.bytes {
            return Err(wrong("it ends before the checkpoint"));
        }
        if crc32fast::hash(&bytes) != self.sum {
            return Err(wrong("its check sum is another than at the checkpoint"));
        }
        Ok(bytes)
    }
}

/// Copies all bytes and returns their number and check sum.
///
/// # Errors
/// One of the two cannot be read or written.
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

/// Which of `inputs` a new file of the name `target` would replace: the same file, however it is named, or a link to
/// one.
pub fn replaced<'a>(target: &Path, inputs: &'a [PathBuf]) -> Option<&'a Path> {
    let target = name_of(target)?;
    // A name that is not there, or is no file, takes nothing away.
    fs::symlink_metadata(&target).ok()?;
    let same = |input: &&PathBuf| {
        name_of(input).as_ref() == Some(&target)
            || input.canonicalize().is_ok_and(|input| input == target)
    };
    inputs.iter().find(same).map(PathBuf::as_path)
}

/// The name of a file in its folder without links; a link that is the file itself stays one.
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
        // A folder in the way of the temporary file: the old content must stay.
        fs::create_dir(folder.path().join("summary.json.tmp")).unwrap();
        assert!(write_whole(&path, b"half").is_err());
        assert_eq!(fs::read(&path).unwrap(), b"whole");
        // Nothing takes the place of a folder.
        let error = write_whole(folder.path(), b"half").unwrap_err();
        assert_eq!(error.kind(), io::ErrorKind::IsADirectory, "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn links_are_replaced_and_what_they_lead_to_stays() {
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
        // One that is not kept leaves nothing.
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
            // A link that is replaced takes nothing from what it leads to.
            assert!(replaced(&at("link.toml"), &[at("model.toml")]).is_none());
        }
    }
}
