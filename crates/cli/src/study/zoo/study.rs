//! Runs walls and collects the results.

use std::ffi::OsString;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::time::Duration;

use super::reference::{Difference, careful};
use super::row::{OUT_OF_TIME, ZooRow, read, table};
use super::wall::Wall;
use crate::study::parallel::side_by_side;
use crate::study::process::{self, Call, key_of, limit_of, run_of};
use wythe_core::deck::{Deck, Strategy};
use wythe_core::error::IoError;
use wythe_core::files::write_whole;
use wythe_core::model::Model;
use wythe_core::results::limit::TABLE;
use wythe_core::results::output::{HISTORY, SUMMARY};
use wythe_core::results::{Curve, RunFolder};

/// Limit of CPU time of a reference over that of a run: a reference takes ten times as many increments.
const LONGER: u32 = 10;

/// Exit code of a run that the user stopped.
const INTERRUPTED: i32 = 130;

/// Options of the zoo.
#[derive(Clone, Debug)]
pub struct Options {
    /// Command that runs a deck: the `wythe` program with the arguments that precede `run`.
    pub program: Vec<OsString>,
    /// Limit of CPU time per run; ten times as much for a reference.
    pub limit: Duration,
    /// Number of runs at a time.
    pub jobs: usize,
    /// Number of threads per run.
    pub threads: usize,
    /// Modelling strategy of all walls.
    pub strategy: Strategy,
    /// Whether walls are compared with careful runs of the same strategy. A limit analysis has none.
    pub reference: bool,
    /// Whether walls with a stored result are run again.
    pub fresh: bool,
}

impl Options {
    /// Whether walls are compared with careful runs.
    fn compares(&self) -> bool {
        self.reference && self.strategy != Strategy::Limit
    }
}

/// Folder of the study.
#[derive(Clone, Debug)]
pub struct Folder(PathBuf);

impl Folder {
    /// File name of the table.
    pub const TABLE: &str = "zoo.csv";
    /// Sub-folder of decks and of the folders of runs.
    pub const WALLS: &str = "walls";

    /// Names the folder, which need not exist.
    pub fn new(path: &Path) -> Self {
        Self(path.to_owned())
    }

    /// Path of the table.
    pub fn table(&self) -> PathBuf {
        self.0.join(Self::TABLE)
    }

    /// Path of the deck of a seed.
    pub fn deck(&self, seed: u64) -> PathBuf {
        self.0.join(Self::WALLS).join(format!("{seed}.toml"))
    }

    fn run(&self, seed: u64) -> PathBuf {
        self.0.join(Self::WALLS).join(format!("{seed}.out"))
    }

    fn reference(&self, seed: u64) -> PathBuf {
        let name = format!("{seed}.reference.out");
        self.0.join(Self::WALLS).join(name)
    }

    /// Writes the deck of a wall.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write_deck(&self, wall: &Wall) -> Result<(), IoError> {
        let walls = self.0.join(Self::WALLS);
        std::fs::create_dir_all(&walls).map_err(failed(&walls))?;
        let path = self.deck(wall.seed);
        write_whole(&path, wall.deck.as_bytes()).map_err(failed(&path))
    }
}

fn failed(path: &Path) -> impl Fn(std::io::Error) -> IoError {
    let path = path.to_owned();
    move |why| IoError {
        path: path.clone(),
        why,
    }
}

/// Runs the walls of these seeds that have no result in the folder yet, and writes the table after each wall.
/// Returns all rows of the table, sorted by seed. `progress` is called with each finished wall, on any thread.
/// `stop` is called continually; walls that are not finished when it returns true leave no row.
///
/// A wall has a result if the table has its row and its stored deck equals the deck of the seed. A wall that
/// exceeded its time limit is run again if the limit is now larger, one of another strategy in any case.
///
/// # Errors
/// [`IoError`]: the folder cannot be written, its table cannot be read, or a process cannot be started.
pub fn zoo(
    seeds: &[u64],
    folder: &Folder,
    options: &Options,
    progress: &(dyn Fn(&ZooRow) + Sync),
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Vec<ZooRow>, IoError> {
    let mut known = read(&folder.table())?;
    let limit = options.limit.as_secs_f64();
    let mut jobs = Vec::new();
    for &seed in seeds {
        let wall = Wall::drawn(seed);
        let same = || std::fs::read_to_string(folder.deck(seed)).is_ok_and(|t| t == wall.deck);
        let at = known.iter().position(|row| row.seed == seed);
        let before = at.map(|at| known[at].clone()).filter(|row| {
            let longer = row.status == OUT_OF_TIME && row.limit_s < limit;
            let strategy = row.strategy == options.strategy.name();
            !options.fresh && !longer && strategy && same()
        });
        let compared = |row: &ZooRow| {
            let longer = row.reference_status == OUT_OF_TIME && row.limit_s < limit;
            !options.compares() || !(row.reference_status.is_empty() || longer)
        };
        if before.as_ref().is_some_and(compared) {
            continue;
        }
        if let (Some(at), None) = (at, &before) {
            known.remove(at);
        }
        folder.write_deck(&wall)?;
        jobs.push((wall, before));
    }
    let zoo = Zoo {
        folder,
        options,
        stop,
    };
    let rows = Mutex::new(known);
    let keep = |row: ZooRow| -> Result<(), IoError> {
        let mut rows = rows
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner);
        rows.retain(|other| other.seed != row.seed);
        rows.push(row);
        rows.sort_by_key(|row| row.seed);
        let path = folder.table();
        write_whole(&path, table(&rows).as_bytes()).map_err(failed(&path))
    };
    let job = |(wall, before): (Wall, Option<ZooRow>)| -> Result<(), IoError> {
        if let Some(row) = zoo.one(&wall, before)? {
            progress(&row);
            keep(row)?;
        }
        Ok(())
    };
    let done = side_by_side(jobs, options.jobs, stop, &job);
    done.into_iter().flatten().collect::<Result<(), _>>()?;
    Ok(rows
        .into_inner()
        .unwrap_or_else(std::sync::PoisonError::into_inner))
}

/// Data that all runs of a study share.
struct Zoo<'a> {
    folder: &'a Folder,
    options: &'a Options,
    stop: &'a (dyn Fn() -> bool + Sync),
}

impl Zoo<'_> {
    /// Runs a wall, and its reference if requested. Returns none if the user stopped it.
    fn one(&self, wall: &Wall, before: Option<ZooRow>) -> Result<Option<ZooRow>, IoError> {
        let Self {
            folder, options, ..
        } = self;
        let mut row = if let Some(row) = before {
            row
        } else {
            let out = folder.run(wall.seed);
            match self.run(wall, &out, &[], options.limit)? {
                Some(row) => row,
                None => return Ok(None),
            }
        };
        // Without a model there is no reference run.
        let deck = Deck::from_str(&wall.deck, "zoo.toml").ok();
        let model = deck.and_then(|deck| Model::from_deck(&deck).ok());
        if let (true, Some((model, _))) = (options.compares(), model) {
            let (out, limit) = (folder.reference(wall.seed), options.limit * LONGER);
            match self.run(wall, &out, &careful(&model), limit)? {
                None => return Ok(None),
                Some(reference) => {
                    let curves = [folder.run(wall.seed), out].map(|path| curve(&path));
                    let completed = [&row, &reference].iter().all(|r| r.status == "completed");
                    let difference = match &curves {
                        [Some(run), Some(reference)] => Difference::of(run, reference, completed),
                        _ => None,
                    };
                    row.compared(&reference, difference);
                    row.limit_s = row.limit_s.max(options.limit.as_secs_f64());
                }
            }
        }
        Ok(Some(row))
    }

    /// Runs a wall once.
    fn run(
        &self,
        wall: &Wall,
        out: &Path,
        set: &[(String, String)],
        limit: Duration,
    ) -> Result<Option<ZooRow>, IoError> {
        // Files of an earlier run would otherwise be read as the result of a run that is rejected and writes none.
        for name in [HISTORY, SUMMARY, TABLE] {
            let path = out.join(name);
            match std::fs::remove_file(&path) {
                Err(why) if why.kind() != ErrorKind::NotFound => return Err(failed(&path)(why)),
                _ => {}
            }
        }
        let program = &self.options.program;
        let call = Call {
            program,
            arguments: &self.arguments(wall, out, set),
            limit,
        };
        let ended = process::run(&call, self.stop);
        let name = Path::new(
            program
                .first()
                .map_or("wythe".as_ref(), OsString::as_os_str),
        );
        let Some(ended) = ended.map_err(failed(name))? else {
            return Ok(None);
        };
        if ended.code == Some(INTERRUPTED) {
            // Ctrl-C reached the process before this one.
            return Ok(None);
        }
        let mut row = ZooRow::of_wall(wall);
        self.options.strategy.name().clone_into(&mut row.strategy);
        row.took(out, &ended, limit.as_secs_f64())
            .map_err(failed(out))?;
        Ok(Some(row))
    }

    /// Arguments of the program for a wall, with these keys of its deck.
    fn arguments(&self, wall: &Wall, out: &Path, set: &[(String, String)]) -> Vec<OsString> {
        let Options {
            strategy, threads, ..
        } = *self.options;
        let deck = self.folder.deck(wall.seed);
        if strategy == Strategy::Limit {
            return limit_of(&deck, out, set);
        }
        let mut set = set.to_vec();
        if strategy != Strategy::default() {
            set.push(key_of(strategy));
        }
        // The message file is many times larger than the other files, and a study does not replay it.
        set.push(("output.mcap".to_owned(), "false".to_owned()));
        run_of(&deck, out, &set, threads)
    }
}

/// Load-displacement curve of a run; none if the run left none.
fn curve(folder: &Path) -> Option<Curve> {
    let history = RunFolder::open(folder).ok()?.history().ok()?;
    Some(history.curve())
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// A program that writes no results and ends with this exit code.
    fn options(code: u8) -> Options {
        let script = format!("echo refused >&2; exit {code}");
        Options {
            program: ["sh", "-c", &script, "sh"].map(OsString::from).to_vec(),
            limit: Duration::from_secs(60),
            jobs: 2,
            threads: 1,
            strategy: Strategy::Detailed,
            reference: false,
            fresh: false,
        }
    }

    #[test]
    fn walls_that_were_run_are_not_run_again_unless_asked_to() {
        let folder = tempfile::tempdir().unwrap();
        let folder = Folder::new(folder.path());
        let count = AtomicUsize::new(0);
        let ran = |seeds: &[u64], options: &Options| {
            count.store(0, Ordering::Relaxed);
            let progress = |_: &ZooRow| {
                count.fetch_add(1, Ordering::Relaxed);
            };
            let rows = zoo(seeds, &folder, options, &progress, &|| false).unwrap();
            let seeds: Vec<u64> = rows.iter().map(|row| row.seed).collect();
            (seeds, count.load(Ordering::Relaxed))
        };
        let refused = options(2);
        assert_eq!(ran(&[3, 1], &refused), (vec![1, 3], 2));
        assert_eq!(ran(&[1, 2, 3], &refused), (vec![1, 2, 3], 1));
        assert_eq!(ran(&[2], &refused), (vec![1, 2, 3], 0));
        let fresh = Options {
            fresh: true,
            ..options(2)
        };
        assert_eq!(ran(&[2], &fresh), (vec![1, 2, 3], 1));
        // The stored deck differs from that of the seed: the row belongs to another wall.
        std::fs::write(folder.deck(2), "format = 1\n").unwrap();
        assert_eq!(ran(&[1, 2, 3], &refused), (vec![1, 2, 3], 1));
        let rigid = Options {
            strategy: Strategy::Rigid,
            ..options(2)
        };
        assert_eq!(ran(&[1], &rigid), (vec![1, 2, 3], 1));
        assert_eq!(ran(&[1, 2], &refused), (vec![1, 2, 3], 1));
        // A missing reference is computed once.
        let reference = Options {
            reference: true,
            ..options(2)
        };
        assert_eq!(ran(&[1], &reference), (vec![1, 2, 3], 1));
        assert_eq!(ran(&[1], &reference), (vec![1, 2, 3], 0));
    }

    #[test]
    fn a_wall_that_was_out_of_time_is_run_again_with_more_of_it() {
        let folder = tempfile::tempdir().unwrap();
        let folder = Folder::new(folder.path());
        let with = |seconds| Options {
            program: ["sh", "-c", "while :; do :; done", "sh"]
                .map(OsString::from)
                .to_vec(),
            limit: Duration::from_secs_f64(seconds),
            ..options(0)
        };
        let cpu = |options: &Options| {
            let rows = zoo(&[1], &folder, options, &|_| (), &|| false).unwrap();
            assert_eq!(rows[0].status, OUT_OF_TIME);
            rows[0].cpu_s
        };
        let first = cpu(&with(0.05));
        assert_eq!(cpu(&with(0.05)), first);
        assert!(cpu(&with(0.3)) > 0.3);
    }

    #[test]
    fn a_study_that_is_stopped_keeps_what_it_has() {
        let folder = tempfile::tempdir().unwrap();
        let folder = Folder::new(folder.path());
        zoo(&[1], &folder, &options(2), &|_| (), &|| false).unwrap();
        let rows = zoo(&[1, 2], &folder, &options(2), &|_| (), &|| true).unwrap();
        assert_eq!(rows.len(), 1);
        assert_eq!(read(&folder.table()).unwrap(), rows);
    }
}
