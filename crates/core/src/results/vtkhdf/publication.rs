//! The file that everybody reads is never written: it is replaced by a whole one.
//!
//! ```text
//! results.vtkhdf.part   the work file, HDF5's own: a flush of it is many writes, and a kill may come between
//!        │ copy, fsync
//! results.vtkhdf.tmp
//!        │ rename
//! results.vtkhdf        whole at any moment
//! ```
//! hdf5-metno cannot write in the single-writer-multiple-reader way, which would serve, too.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

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

/// The file beside `path` whose name ends so.
fn beside(path: &Path, end: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(end);
    name.into()
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
        let temporary = beside(&self.path, ".tmp");
        let copied = fs::copy(self.work(), &temporary)
            .and_then(|_| File::options().write(true).open(&temporary)?.sync_all())
            .and_then(|()| fs::rename(&temporary, &self.path));
        if copied.is_err() {
            // Best effort: the error that matters is the first.
            let _ = fs::remove_file(&temporary);
        }
        let took = start.elapsed();
        self.spent += took;
        self.last = Some(took);
        copied
    }

    /// Makes the work file, which is closed, the one that is read.
    ///
    /// # Errors
    /// It cannot be moved.
    pub fn finish(&self) -> io::Result<()> {
        let work = self.work();
        File::options().write(true).open(&work)?.sync_all()?;
        fs::rename(&work, &self.path)
    }

    /// Removes the work file, if there is one: it cannot be trusted, and takes room.
    pub fn abandon(&self) {
        // Best effort: whoever calls has an error already.
        let _ = fs::remove_file(self.work());
    }
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
        assert_eq!(fs::read_to_string(&path).unwrap(), "one");
        // A folder in the way of the copy.
        let temporary = folder.path().join("results.vtkhdf.tmp");
        fs::create_dir(&temporary).unwrap();
        assert!(publication.publish().is_err());
        assert_eq!(fs::read_to_string(&path).unwrap(), "one");
        fs::remove_dir(&temporary).unwrap();
        publication.finish().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "two");
        assert!(!publication.work().exists());
    }
}
