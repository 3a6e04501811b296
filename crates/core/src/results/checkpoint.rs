//! `checkpoint.bin`: the input of [`crate::solve::resume`] and the lengths of the other files in the folder.
//!
//! ```text
//! "wythe\0cp"  version u32  CRC-32 of the content u32  length of the content u64  content (postcard)
//! ```
//!
//! Numbers are little-endian. The file is written under a temporary name, synced and renamed. So there is always a
//! complete checkpoint under its own name, either the new one or the one before.

use std::io;
use std::path::{Path, PathBuf};

use miette::Diagnostic;
use serde::{Deserialize, Serialize};

use super::mcap::Mark;
use super::output::CHECKPOINT;
use crate::deck::Deck;
use crate::files::{self, Extent, write_whole};
use crate::solve::Checkpoint;
use crate::state::Frame;

/// First bytes of the file.
const MAGIC: [u8; 8] = *b"wythe\0cp";
/// Version of the content; increased by every change of the data.
const VERSION: u32 = 28;
/// Size of the header [byte].
const HEAD: usize = 8 + 4 + 4 + 8;

/// The content of the file.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CheckpointFile {
    /// Version of the program that wrote it.
    pub version: String,
    /// The deck of the run; `None` for a model without one.
    pub deck: Option<String>,
    /// Folder of the files named in the deck; `None` if its path is not valid Unicode.
    pub deck_folder: Option<String>,
    /// Relative path from the run folder to that folder, for a project that is moved as a whole.
    pub way_to_deck_folder: Option<String>,
    /// Extent of the history.
    pub history: Extent,
    /// Number of frames in the field file.
    pub frames: usize,
    /// Extent of the messages; `None` if none are written.
    pub messages: Option<Mark>,
    /// Wall-clock time of the run so far [s].
    pub wall_s: f64,
    /// CPU time of the run so far [s]; `None` if the system does not report it.
    pub cpu_s: Option<f64>,
    /// Index in the load-displacement curve, and fields, of the largest force so far, while the field file has no frame
    /// of it.
    pub peak: Option<(usize, Frame)>,
    /// State of the solver.
    pub solver: Checkpoint,
}

/// Errors of reading a checkpoint.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum CheckpointFileError {
    /// There is no checkpoint.
    #[error("{}: there is no {CHECKPOINT} to go on from", .0.display())]
    #[diagnostic(help(
        "it is written after the first increment of a run; begin anew with `wythe run`"
    ))]
    Missing(PathBuf),
    /// The file cannot be read.
    #[error("{}: cannot be read: {why}", path.display())]
    #[diagnostic(help("check the permissions of the file"))]
    Read {
        /// The file.
        path: PathBuf,
        /// Message of the system.
        why: io::Error,
    },
    /// The file is damaged.
    #[error("{}: is damaged: {why}", path.display())]
    #[diagnostic(help(
        "a run always leaves a whole file, so something else changed it: restore it from a copy of \
         the folder, or begin anew with `wythe run`"
    ))]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Description of the damage.
        why: &'static str,
    },
    /// The content has another version.
    #[error("{}: was written by another version of wythe (content {found}, this one reads {VERSION})", path.display())]
    #[diagnostic(help(
        "resume with the version that began the run, or begin anew with `wythe run`"
    ))]
    Version {
        /// The file.
        path: PathBuf,
        /// Version of the content.
        found: u32,
    },
}

impl CheckpointFile {
    /// Writes the whole file or nothing.
    ///
    /// # Errors
    /// The file or its temporary version cannot be written.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        write_whole(path, &self.encode()?)
    }

    /// Reads the file and rejects every damaged one.
    ///
    /// # Errors
    /// [`CheckpointFileError`]: the file is missing, unreadable, damaged or of another version.
    pub fn read(path: &Path) -> Result<Self, CheckpointFileError> {
        let bytes = files::read(path, u64::MAX - 1).map_err(|why| match why.kind() {
            io::ErrorKind::NotFound => {
                CheckpointFileError::Missing(path.parent().unwrap_or(path).to_owned())
            }
            _ => CheckpointFileError::Read {
                path: path.to_owned(),
                why,
            },
        })?;
        decode(&bytes).map_err(|fault| match fault {
            Fault::Damaged(why) => CheckpointFileError::Damaged {
                path: path.to_owned(),
                why,
            },
            Fault::Version(found) => CheckpointFileError::Version {
                path: path.to_owned(),
                found,
            },
        })
    }

    /// Sets the folder in which the files named in the deck are looked up. The first of these folders that has all of
    /// them is taken: the stored relative path from `run`, the folder stored at the start of the run, and `run`
    /// itself. If none has them, it is the folder stored at the start.
    pub fn place(&self, run: &Path, deck: Deck) -> Deck {
        let run_itself = run.canonicalize().unwrap_or_else(|_| run.to_owned());
        let way = self.way_to_deck_folder.as_ref();
        let way = way.map(|way| run_itself.join(way));
        let began = self.deck_folder.as_ref().map(PathBuf::from);
        let places = [way, began.clone(), Some(run.to_owned())];
        for place in places.into_iter().flatten() {
            let placed = deck.clone().in_folder(place);
            if placed.named_files().iter().all(|file| file.is_file()) {
                return placed;
            }
        }
        deck.in_folder(began.unwrap_or_else(|| run.to_owned()))
    }

    fn encode(&self) -> io::Result<Vec<u8>> {
        let bytes = postcard::to_extend(self, vec![0; HEAD]).map_err(io::Error::other)?;
        Ok(seal(bytes))
    }
}

/// Fills in the header before the content.
fn seal(mut bytes: Vec<u8>) -> Vec<u8> {
    let content = &bytes[HEAD..];
    let (sum, length) = (crc32fast::hash(content), content.len() as u64);
    bytes[..8].copy_from_slice(&MAGIC);
    bytes[8..12].copy_from_slice(&VERSION.to_le_bytes());
    bytes[12..16].copy_from_slice(&sum.to_le_bytes());
    bytes[16..HEAD].copy_from_slice(&length.to_le_bytes());
    bytes
}

/// Reason why bytes are not a valid checkpoint.
#[derive(Debug, PartialEq, Eq)]
enum Fault {
    Damaged(&'static str),
    Version(u32),
}

fn decode<T: for<'de> Deserialize<'de>>(bytes: &[u8]) -> Result<T, Fault> {
    let short = Fault::Damaged("it ends too early");
    let (magic, rest) = bytes.split_first_chunk::<8>().ok_or(short)?;
    if *magic != MAGIC {
        return Err(Fault::Damaged("it does not begin as a checkpoint"));
    }
    let head = rest.split_first_chunk::<4>().and_then(|(version, rest)| {
        let (sum, rest) = rest.split_first_chunk::<4>()?;
        let (length, content) = rest.split_first_chunk::<8>()?;
        Some((version, sum, length, content))
    });
    let Some((version, sum, length, content)) = head else {
        return Err(Fault::Damaged("it ends too early"));
    };
    let version = u32::from_le_bytes(*version);
    if version != VERSION {
        return Err(Fault::Version(version));
    }
    if u64::from_le_bytes(*length) != content.len() as u64 {
        return Err(Fault::Damaged("its length is not the one that it names"));
    }
    if u32::from_le_bytes(*sum) != crc32fast::hash(content) {
        return Err(Fault::Damaged("its check sum does not fit its content"));
    }
    // A length within the content cannot exhaust the memory: serde reserves at most 1 MiB before it reads the
    // elements.
    match postcard::take_from_bytes(content) {
        Ok((file, [])) => Ok(file),
        _ => Err(Fault::Damaged("its content is none of a checkpoint")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Content = (String, Vec<f64>, Option<Vec<[f64; 3]>>);

    fn content() -> Content {
        let numbers = [1.0 / 3.0, -0.0, 4.9e-324, f64::MAX];
        ("wythe".into(), numbers.into(), Some(vec![[0.1; 3]; 5]))
    }

    fn sealed(content: &Content) -> Vec<u8> {
        seal(postcard::to_extend(content, vec![0; HEAD]).unwrap())
    }

    #[test]
    fn a_checkpoint_is_read_back_bit_for_bit() {
        let read: Content = decode(&sealed(&content())).unwrap();
        assert_eq!(read, content());
        assert_eq!(read.1[1].to_bits(), (-0.0_f64).to_bits());
    }

    #[test]
    fn every_truncation_and_every_changed_byte_is_rejected() {
        let whole = sealed(&content());
        for end in 0..whole.len() {
            assert!(decode::<Content>(&whole[..end]).is_err(), "{end} bytes");
        }
        for at in 0..whole.len() {
            for change in [1, 0x80, 0xFF] {
                let mut changed = whole.clone();
                changed[at] ^= change;
                assert!(decode::<Content>(&changed).is_err(), "byte {at}");
            }
        }
        let mut longer = whole;
        longer.push(0);
        assert!(decode::<Content>(&longer).is_err());
    }

    #[test]
    fn a_length_beyond_the_file_is_rejected_without_allocation() {
        // A vector of 2⁶³ numbers, as a varint, in a file with a valid check sum.
        let mut bytes = vec![0; HEAD];
        bytes.push(0);
        bytes.extend([0x80; 9]);
        bytes.push(0x01);
        let read = decode::<Content>(&seal(bytes));
        assert_eq!(
            read,
            Err(Fault::Damaged("its content is none of a checkpoint"))
        );
    }

    #[test]
    fn another_version_is_named() {
        let mut other = sealed(&content());
        other[8] = VERSION as u8 + 1;
        assert_eq!(decode::<Content>(&other), Err(Fault::Version(VERSION + 1)));
    }

    #[test]
    fn errors_name_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(CHECKPOINT);
        let missing = CheckpointFile::read(&path).unwrap_err();
        assert!(matches!(missing, CheckpointFileError::Missing(_)));
        std::fs::write(&path, b"no checkpoint").unwrap();
        let damaged = CheckpointFile::read(&path).unwrap_err();
        assert!(damaged.to_string().contains(CHECKPOINT), "{damaged}");
        assert!(damaged.help().is_some());
    }
}
