//! One deck by every modelling strategy: forces, curves and costs side by side.
//!
//! ```text
//! deck ─▶ a process a strategy: wythe run, wythe limit ─▶ Row ─▶ page, chart of the curves
//! ```

mod page;
mod row;

pub use page::{chart, page};
pub use row::{Answer, LimitLoad, Row};

use std::ffi::OsString;
use std::io::{Error, ErrorKind};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::process::{self, Call, key_of, limit_of, run_of};
use wythe_core::deck::Strategy;
use wythe_core::error::IoError;
use wythe_core::results::limit::TABLE;
use wythe_core::results::output::{HISTORY, SUMMARY};

/// What is run.
#[derive(Clone, Debug)]
pub struct Options {
    /// Command that runs a deck: the `wythe` program with the arguments that precede `run`.
    pub program: Vec<OsString>,
    /// The deck.
    pub deck: PathBuf,
    /// Keys of the deck that all strategies replace.
    pub set: Vec<(String, String)>,
    /// Folder of the study.
    pub out: PathBuf,
    /// Strategies.
    pub strategies: Vec<Strategy>,
    /// Limit of CPU time per strategy.
    pub limit: Duration,
    /// Number of threads.
    pub threads: usize,
}

/// Runs the strategies one after the other, so that none disturbs the time of another. Stops early if `stop`.
///
/// # Errors
/// Folders that cannot be written, programs that cannot be started.
pub fn strategies(
    options: &Options,
    progress: &dyn Fn(&Row),
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Vec<Row>, IoError> {
    let mut rows = Vec::new();
    for &strategy in &options.strategies {
        let Some(row) = run(options, strategy, stop)? else {
            break;
        };
        progress(&row);
        rows.push(row);
    }
    Ok(rows)
}

/// Runs one strategy in a folder of its own; none if the user stopped it.
fn run(
    options: &Options,
    strategy: Strategy,
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<Row>, IoError> {
    let folder = options.out.join(strategy.name());
    std::fs::create_dir_all(&folder).map_err(|why| failed(&folder, why))?;
    // Files of an earlier study must not be read as results of a run that is refused.
    for name in [HISTORY, SUMMARY, TABLE] {
        match std::fs::remove_file(folder.join(name)) {
            Err(why) if why.kind() != ErrorKind::NotFound => return Err(failed(&folder, why)),
            _ => {}
        }
    }
    let call = Call {
        program: &options.program,
        arguments: &arguments(options, strategy, &folder),
        limit: options.limit,
    };
    let ended = process::run(&call, stop).map_err(|why| failed(&folder, why))?;
    let Some(ended) = ended else {
        return Ok(None);
    };
    let row = Row::read(strategy, &folder, &ended);
    row.map(Some).map_err(|why| failed(&folder, why))
}

/// Arguments of the program.
fn arguments(options: &Options, strategy: Strategy, folder: &Path) -> Vec<OsString> {
    let mut set = options.set.clone();
    if strategy == Strategy::Limit {
        return limit_of(&options.deck, folder, &set);
    }
    set.push(key_of(strategy));
    set.push(("output.mcap".to_owned(), "false".to_owned()));
    run_of(&options.deck, folder, &set, options.threads)
}

fn failed(path: &Path, why: Error) -> IoError {
    IoError {
        path: path.to_owned(),
        why,
    }
}
