//! `checkpoint.bin`: what [`crate::solve::resume`] needs, and how far the other files of the folder go.
//!
//! ```text
//! "wythe\0cp"  version u32  CRC-32 of the content u32  length of the content u64  content (postcard)
//! ```
//!
//! Numbers are little-endian. The file is written beside its name, synced and renamed: under its name there is
//! always a whole one, the last or the one before.

use std::io;
use std::path::{Path, PathBuf};

use miette::Diagnostic;
use serde::{Deserialize, Serialize};

use super::mcap::Mark;
use crate::files::{self, Extent, write_whole};
use crate::model::Deck;
use crate::solve::Checkpoint;

/// Name of the file in the folder.
pub const CHECKPOINT: &str = "checkpoint.bin";

/// First bytes of the file.
const MAGIC: [u8; 8] = *b"wythe\0cp";
/// Version of the content: another number for every change of what is in it.
const VERSION: u32 = 14;
/// Bytes before the content.
const HEAD: usize = 8 + 4 + 4 + 8;

/// The content of the file.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct CheckpointFile {
    /// Version of the program that wrote it.
    pub version: String,
    /// The deck as it was run; none of a model that had none.
    pub deck: Option<String>,
    /// The folder that files named by the deck are relative to; none if no text can name it.
    pub deck_folder: Option<String>,
    /// The way there from the folder of the run, for a project that is moved as a whole.
    pub way_to_deck_folder: Option<String>,
    /// How far the history goes.
    pub history: Extent,
    /// Frames in the file of fields.
    pub frames: usize,
    /// How far the messages go; none where none are wanted.
    pub messages: Option<Mark>,
    /// Wall-clock time of the run so far [s].
    pub wall_s: f64,
    /// CPU time of the run so far [s], where the system tells.
    pub cpu_s: Option<f64>,
    /// Where the solver was.
    pub solver: Checkpoint,
}

/// A checkpoint that cannot be taken up.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum CheckpointFileError {
    /// There is none.
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
        /// What the system says.
        why: io::Error,
    },
    /// The file is not what a run has written.
    #[error("{}: is damaged: {why}", path.display())]
    #[diagnostic(help(
        "a run always leaves a whole file, so something else changed it: restore it from a copy of \
         the folder, or begin anew with `wythe run`"
    ))]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: &'static str,
    },
    /// The file has another version of the content.
    #[error("{}: was written by another version of wythe (content {found}, this one reads {VERSION})", path.display())]
    #[diagnostic(help(
        "resume with the version that began the run, or begin anew with `wythe run`"
    ))]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
    },
}

impl CheckpointFile {
    /// Writes the file whole or not at all.
    ///
    /// # Errors
    /// The file, or its temporary neighbour, cannot be written.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        write_whole(path, &self.encode()?)
    }

    /// Reads the file. What is damaged is refused, whatever its bytes are.
    ///
    /// # Errors
    /// [`CheckpointFileError`].
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

    /// Where the files that the deck names lie, seen from the folder of the run: where all of them are, the way from
    /// it first, then the place where the run began, then the folder itself; else where the run began.
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

/// Fills the head before the content.
fn seal(mut bytes: Vec<u8>) -> Vec<u8> {
    let content = &bytes[HEAD..];
    let (sum, length) = (crc32fast::hash(content), content.len() as u64);
    bytes[..8].copy_from_slice(&MAGIC);
    bytes[8..12].copy_from_slice(&VERSION.to_le_bytes());
    bytes[12..16].copy_from_slice(&sum.to_le_bytes());
    bytes[16..HEAD].copy_from_slice(&length.to_le_bytes());
    bytes
}

/// Why bytes are no checkpoint.
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
    // Lengths within are believed only as far as bytes follow: serde sets aside no more than a mebibyte
    // ahead of them.
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
    fn what_is_written_is_read_bit_for_bit() {
        let read: Content = decode(&sealed(&content())).unwrap();
        assert_eq!(read, content());
        assert_eq!(read.1[1].to_bits(), (-0.0_f64).to_bits());
    }

    #[test]
    fn every_cut_and_every_changed_byte_is_refused() {
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
    fn a_length_beyond_the_bytes_is_refused_without_room_for_it() {
        // A vector of 2⁶³ numbers, as a varint, in a file whose sum is right.
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
