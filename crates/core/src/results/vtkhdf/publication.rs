//! The file that everybody reads is never written: it is replaced by a whole one.
//!
//! ```text
//! results.vtkhdf.part   the work file, HDF5's own: a flush of it is many writes, and a kill may come between
//!        │ copy, fsync
//! results.vtkhdf.tmp
//!        │ rename
//! results.vtkhdf        whole at any moment
//! ```
//! What is shown ends with a seal, which HDF5 does not read: it knows from its own head where it ends.
//!
//! ```text
//! HDF5   "wythe\0vh"   number of the bytes before u64   their CRC-32 u32     little-endian
//! ```
//! hdf5-metno cannot write in the single-writer-multiple-reader way, which would serve, too.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::files::{self, Extent, NewFile, beside};

/// Part of the run's time that copies may take.
const SHARE: f64 = 0.02;

/// A file and the work file that it is made of.
#[derive(Debug)]
pub struct Publication {
    path: PathBuf,
    began: Instant,
    /// What copies have taken, and the last of them; none before the first.
    spent: Duration,
    last: Option<Duration>,
}

impl Publication {
    /// Of the file at `path`; nothing is written yet.
    pub fn new(path: &Path) -> Self {
        Self {
            path: path.to_owned(),
            began: Instant::now(),
            spent: Duration::ZERO,
            last: None,
        }
    }

    /// The file that is read.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file that is written.
    pub fn work(&self) -> PathBuf {
        beside(&self.path, ".part")
    }

    /// Whether there is time for a copy: always for the first.
    pub fn is_due(&self) -> bool {
        self.last
            .is_none_or(|last| in_budget(self.spent, last, self.began.elapsed()))
    }

    /// Shows the work file, which is flushed, as it is now.
    ///
    /// # Errors
    /// The copy cannot be written; what was shown stays.
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

    /// Makes a work file of the file that is read, which stays as it is.
    ///
    /// # Errors
    /// It cannot be read, is not as it was shown, or the copy cannot be written.
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

    /// Makes the work file, which is closed, the one that is read.
    ///
    /// # Errors
    /// It cannot be moved.
    pub fn finish(&self) -> io::Result<()> {
        let path = self.work();
        let extent = files::copy(&mut files::open(&path)?, &mut io::sink())?;
        let mut work = File::options().append(true).open(&path)?;
        work.write_all(&seal(extent))?;
        work.sync_all()?;
        fs::rename(&path, &self.path)
    }

    /// Removes the work file, if there is one: it cannot be trusted, and takes room.
    pub fn abandon(&self) {
        // Best effort: whoever calls has an error already.
        let _ = fs::remove_file(self.work());
    }
}

/// First bytes of a seal, and all of its bytes.
const SEAL: [u8; 8] = *b"wythe\0vh";
const SEALED: usize = 8 + 8 + 4;

const OTHER_SUM: &str = "its check sum is another than when it was written";

/// Files longer than this are not read as a whole before one frame of them is.
const MOST_READ: u64 = 1 << 30;

fn seal(extent: Extent) -> [u8; SEALED] {
    let mut seal = [0; SEALED];
    seal[..8].copy_from_slice(&SEAL);
    seal[8..16].copy_from_slice(&extent.bytes.to_le_bytes());
    seal[16..].copy_from_slice(&extent.sum.to_le_bytes());
    seal
}

/// What the seal of a file says, which is left at its begin; none where there is none, as where HDF5 has written to it.
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

/// Whether a file is as it was shown, if it has a seal that says so: HDF5 trusts what it reads.
///
/// # Errors
/// It is not, or cannot be read.
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

/// Whether another copy like the last one stays within the share of the time.
fn in_budget(spent: Duration, last: Duration, elapsed: Duration) -> bool {
    (spent + last).as_secs_f64() <= SHARE * elapsed.as_secs_f64()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_take_their_share_and_no_more() {
        let s = Duration::from_secs_f64;
        assert!(in_budget(s(0.0), s(0.2), s(10.0)));
        assert!(in_budget(s(0.1), s(0.1), s(10.0)));
        assert!(!in_budget(s(0.1), s(0.11), s(10.0)));
        assert!(!in_budget(s(0.0), s(0.01), s(0.0)));
    }

    #[test]
    fn what_is_shown_is_replaced_whole_or_stays() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("results.vtkhdf");
        let mut publication = Publication::new(&path);
        assert!(publication.is_due());
        fs::write(publication.work(), "one").unwrap();
        publication.publish().unwrap();
        // No time has passed of which the copy would be a small part.
        assert!(!publication.is_due());
        fs::write(publication.work(), "two").unwrap();
        let text = || String::from_utf8_lossy(&fs::read(&path).unwrap()).into_owned();
        assert!(text().starts_with("onewythe"));
        // A folder in the way of the copy.
        let temporary = folder.path().join("results.vtkhdf.tmp");
        fs::create_dir(&temporary).unwrap();
        assert!(publication.publish().is_err());
        assert!(text().starts_with("onewythe"));
        fs::remove_dir(&temporary).unwrap();
        publication.finish().unwrap();
        assert!(text().starts_with("twowythe"));
        assert!(!publication.work().exists());
        // What is sealed comes back whole.
        publication.take_back().unwrap();
        assert_eq!(fs::read_to_string(publication.work()).unwrap(), "two");
    }

    #[test]
    fn every_changed_bit_of_what_is_shown_is_seen() {
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
            // Without its seal it is a file of HDF5 like any other.
            let of_seal = (8 * 200..8 * 216).contains(&bit);
            assert_eq!(check(&path).is_ok(), of_seal, "bit {bit}");
        }
        for length in 0..whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            assert!(publication.take_back().is_err(), "{length} bytes");
        }
    }
}
