//! Publishes the field file by replacing it with a complete copy.
//!
//! ```text
//! results.vtkhdf.part   work file of HDF5; a flush consists of many writes, and the process may be killed in between
//!        │ copy, fsync
//! results.vtkhdf.tmp
//!        │ rename
//! results.vtkhdf        complete at any moment
//! ```
//! The published file ends with a seal. HDF5 ignores it because the header of the file states its length.
//!
//! ```text
//! HDF5   "wythe\0vh"   number of the bytes before u64   their CRC-32 u32     little-endian
//! ```
//! The single-writer-multiple-reader mode of HDF5 would serve as well, but hdf5-metno does not support it.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::files::{self, Extent, NewFile, beside};

/// Fraction of the run time that copies may take.
const SHARE: f64 = 0.02;

/// A published file and its work file.
#[derive(Debug)]
pub struct Publication {
    path: PathBuf,
    began: Instant,
    /// Total time of all copies, and the time of the last one; `None` before the first.
    spent: Duration,
    last: Option<Duration>,
}

impl Publication {
    /// For the file at `path`; nothing is written yet.
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            began: Instant::now(),
            spent: Duration::ZERO,
            last: None,
        }
    }

    /// Path of the published file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Path of the work file.
    pub fn work(&self) -> PathBuf {
        beside(&self.path, ".part")
    }

    /// Whether the time budget allows a copy; it always allows the first.
    pub fn is_due(&self) -> bool {
        self.last
            .is_none_or(|last| in_budget(self.spent, last, self.began.elapsed()))
    }

    /// Publishes the present state of the work file, which must be flushed.
    ///
    /// # Errors
    /// The copy cannot be written; the published file is unchanged.
    pub fn publish(&mut self) -> io::Result<()> {
        let start = Instant::now();
        let copied = self.copy();
        let took = start.elapsed();
        self.spent += took;
        self.last = Some(took);
        copied
    }

    fn copy(&self) -> io::Result<()> {
        let new = NewFile::create(&self.path)?;
        let mut copy = new.file()?;
        let extent = files::copy(&mut files::open(&self.work())?, &mut copy)?;
        copy.write_all(&seal(extent))?;
        copy.sync_all()?;
        new.keep().map(drop)
    }

    /// Copies the published file to a new work file.
    ///
    /// # Errors
    /// The file cannot be read, differs from the one published, or the copy cannot be written.
    pub fn take_back(&self) -> io::Result<()> {
        let mut shown = files::open(&self.path)?;
        let Some(sealed) = sealed(&mut shown)? else {
            return Err(changed("it has no check sum at its end"));
        };
        let mut work = files::create(&self.work())?;
        if files::copy(&mut shown.take(sealed.bytes), &mut work)? != sealed {
            return Err(changed(OTHER_SUM));
        }
        Ok(())
    }

    /// Turns the closed work file into the published file.
    ///
    /// # Errors
    /// The file cannot be sealed or renamed.
    pub fn finish(&self) -> io::Result<()> {
        let path = self.work();
        let extent = files::copy(&mut files::open(&path)?, &mut io::sink())?;
        let mut work = File::options().append(true).open(&path)?;
        work.write_all(&seal(extent))?;
        work.sync_all()?;
        fs::rename(&path, &self.path)
    }

    /// Removes the work file after an error.
    pub fn abandon(&self) {
        // Best effort: the caller already has an error.
        let _ = fs::remove_file(self.work());
    }
}

/// First bytes of a seal, and its length [byte].
const SEAL: [u8; 8] = *b"wythe\0vh";
const SEALED: usize = 8 + 8 + 4;

const OTHER_SUM: &str = "its check sum is another than when it was written";

/// Longer files are not checked before a frame is read, because the check reads the whole file [byte].
const MOST_READ: u64 = 1 << 30;

fn seal(extent: Extent) -> [u8; SEALED] {
    let mut seal = [0; SEALED];
    seal[..8].copy_from_slice(&SEAL);
    seal[8..16].copy_from_slice(&extent.bytes.to_le_bytes());
    seal[16..].copy_from_slice(&extent.sum.to_le_bytes());
    seal
}

/// Extent stored in the seal of a file, whose position is reset to its start; `None` without a valid seal, for
/// example after HDF5 has written to the file.
fn sealed(file: &mut File) -> io::Result<Option<Extent>> {
    let length = file.metadata()?.len();
    let Some(bytes) = length.checked_sub(SEALED as u64) else {
        return Ok(None);
    };
    let mut seal = [0; SEALED];
    file.seek(SeekFrom::Start(bytes))?;
    file.read_exact(&mut seal)?;
    file.rewind()?;
    let (mut told, mut sum) = ([0; 8], [0; 4]);
    told.copy_from_slice(&seal[8..16]);
    sum.copy_from_slice(&seal[16..]);
    let extent = Extent {
        bytes: u64::from_le_bytes(told),
        sum: u32::from_le_bytes(sum),
    };
    Ok((seal[..8] == SEAL && extent.bytes == bytes).then_some(extent))
}

/// Checks that a file is as published. HDF5 does not verify its input. A file without a seal passes.
///
/// # Errors
/// The file was changed or cannot be read.
pub fn check(path: &Path) -> io::Result<()> {
    let mut shown = files::open(path)?;
    let Some(sealed) = sealed(&mut shown)?.filter(|seal| seal.bytes <= MOST_READ) else {
        return Ok(());
    };
    if files::copy(&mut shown.take(sealed.bytes), &mut io::sink())? == sealed {
        Ok(())
    } else {
        Err(changed(OTHER_SUM))
    }
}

fn changed(why: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, why.to_owned())
}

/// Whether another copy as long as the last one stays within the time budget.
fn in_budget(spent: Duration, last: Duration, elapsed: Duration) -> bool {
    (spent + last).as_secs_f64() <= SHARE * elapsed.as_secs_f64()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_take_at_most_their_share_of_time() {
        let s = Duration::from_secs_f64;
        assert!(in_budget(s(0.0), s(0.2), s(10.0)));
        assert!(in_budget(s(0.1), s(0.1), s(10.0)));
        assert!(!in_budget(s(0.1), s(0.11), s(10.0)));
        assert!(!in_budget(s(0.0), s(0.01), s(0.0)));
    }

    #[test]
    fn a_published_copy_is_replaced_as_a_whole_or_not_at_all() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.vtkhdf");
        let mut publication = Publication::new(&path);
        assert!(publication.is_due());
        fs::write(publication.work(), "one").unwrap();
        publication.publish().unwrap();
        // No time has passed, so a copy would exceed the budget.
        assert!(!publication.is_due());
        fs::write(publication.work(), "two").unwrap();
        let text = || String::from_utf8_lossy(&fs::read(&path).unwrap()).into_owned();
        assert!(text().starts_with("onewythe"));
        // A folder blocks the temporary name.
        let temporary = folder.path().join("results.vtkhdf.tmp");
        fs::create_dir(&temporary).unwrap();
        assert!(publication.publish().is_err());
        assert!(text().starts_with("onewythe"));
        fs::remove_dir(&temporary).unwrap();
        publication.finish().unwrap();
        assert!(text().starts_with("twowythe"));
        assert!(!publication.work().exists());
        // A sealed file is restored completely.
        publication.take_back().unwrap();
        assert_eq!(fs::read_to_string(publication.work()).unwrap(), "two");
    }

    #[test]
    fn every_changed_bit_of_a_published_copy_is_detected() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.vtkhdf");
        let mut publication = Publication::new(&path);
        fs::write(publication.work(), [7_u8; 200]).unwrap();
        publication.publish().unwrap();
        check(&path).unwrap();
        let whole = fs::read(&path).unwrap();
        for bit in 0..8 * whole.len() {
            let mut changed = whole.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            fs::write(&path, &changed).unwrap();
            assert!(publication.take_back().is_err(), "bit {bit}");
            // Without a seal it counts as any HDF5 file.
            let of_seal = (8 * 200..8 * 216).contains(&bit);
            assert_eq!(check(&path).is_ok(), of_seal, "bit {bit}");
        }
        for length in 0..whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            assert!(publication.take_back().is_err(), "{length} bytes");
        }
    }
}
