//! Names of the files of a run and the errors of writing them.

use std::io;
use std::path::{Path, PathBuf};

use miette::Diagnostic;

use crate::files;

/// Name of the history in the folder.
pub const HISTORY: &str = "history.csv";
/// Name of the deck's copy in the folder.
pub const DECK: &str = "model.toml";
/// Name of the fields in the folder.
pub const FIELDS: &str = "results.vtkhdf";
/// Name of the file in the folder that shows the interfaces.
pub const INTERFACES: &str = "results.interfaces.vtkhdf";
/// Name of the messages in the folder.
pub const MESSAGES: &str = "run.mcap";
/// Name of the checkpoint in the folder.
pub const CHECKPOINT: &str = "checkpoint.bin";
/// Name of the summary in the folder.
pub const SUMMARY: &str = "summary.json";
/// Name of the load-displacement curve in the folder.
pub const LOAD_DISPLACEMENT: &str = "load_displacement.svg";
/// Name of the elevation in the folder.
pub const CRACK_PATTERN: &str = "crack_pattern.svg";
/// Name of the report in the folder, unless it is written elsewhere.
pub const REPORT: &str = "report.html";
/// Name of the empty lock file. A run in progress holds a lock on it; it stays in the folder for later runs.
pub const LOCK: &str = ".lock";

/// Every file that a run writes into its folder, or removes from it.
pub const OF_A_RUN: [&str; 11] = [
    HISTORY,
    DECK,
    FIELDS,
    INTERFACES,
    MESSAGES,
    SUMMARY,
    LOAD_DISPLACEMENT,
    CRACK_PATTERN,
    REPORT,
    CHECKPOINT,
    LOCK,
];

/// Checks that no result replaces an input of a deck. Each of `names` in `folder` is checked together with the
/// temporary names that it has while it is written.
///
/// # Errors
/// [`OutputError::OverInput`] with the path of the file.
pub fn spare_inputs<'a>(
    folder: &Path,
    names: impl IntoIterator<Item = &'a str>,
    inputs: &[PathBuf],
) -> Result<(), OutputError> {
    for name in names {
        for ending in ["", ".tmp", ".part"] {
            let target = folder.join(format!("{name}{ending}"));
            if files::replaced(&target, inputs).is_some() {
                return Err(OutputError::OverInput(target));
            }
        }
    }
    Ok(())
}

/// Errors of writing results.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum OutputError {
    /// The path of the folder is a file.
    #[error("{}: this is a file, but the results need a folder", .0.display())]
    #[diagnostic(help("name another folder for the results, or move the file away"))]
    NotADirectory(PathBuf),
    /// The folder cannot be created.
    #[error("{}: the folder for the results cannot be created: {why}", path.display())]
    #[diagnostic(help("check the permissions of the folder above it, or name another one"))]
    Create {
        /// The folder.
        path: PathBuf,
        /// Message of the system.
        why: io::Error,
    },
    /// Another run is writing into the folder.
    #[error("{}: another run is writing its results into this folder", .0.display())]
    #[diagnostic(help("wait until it has ended, or name another folder with --out"))]
    Busy(PathBuf),
    /// A result would replace the deck or a file that it names.
    #[error("{}: a result of this name would replace an input: the deck, a file that it names, or data that were read", .0.display())]
    #[diagnostic(help("name another place for the results, with --out; the file is as it was"))]
    OverInput(PathBuf),
    /// A file cannot be written.
    #[error("{}: cannot be written: {why}", path.display())]
    #[diagnostic(help(
        "check the free space of the disk and the permissions of the folder; a folder without \
         summary.json is not whole"
    ))]
    Write {
        /// The file.
        path: PathBuf,
        /// Message of the system.
        why: io::Error,
    },
}

impl From<OutputError> for io::Error {
    fn from(error: OutputError) -> Self {
        let (OutputError::Create { why, .. } | OutputError::Write { why, .. }) = &error else {
            return Self::other(error);
        };
        Self::new(why.kind(), error)
    }
}
