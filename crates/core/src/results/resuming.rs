//! Resumes a run that has stopped, in its own folder.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use miette::Diagnostic;

use super::checkpoint::{CheckpointFile, CheckpointFileError};
use super::directory::{Files, begin_messages, remove};
use super::estimate::remove_companions;
use super::history::written;
use super::lock::{lock, writing};
use super::mcap::Mark;
use super::output::{
    CHECKPOINT, CRACK_PATTERN, DECK, FIELDS, HISTORY, LOAD_DISPLACEMENT, MESSAGES, OF_A_RUN,
    REPORT, SUMMARY, spare_inputs,
};
use super::reading::read_history;
use super::vtkhdf::read::FieldsFile;
use super::{
    HistoryWriter, McapWriter, OutputError, ReadError, RunDirectory, RunFolder, VtkHdfWriter,
};
use crate::deck::Deck;
use crate::deck::schema::DeckChange;
use crate::error::{DeckError, ModelError};
use crate::files::{Extent, NewFile};
use crate::model::Model;
use crate::solve::{Checkpoint, CheckpointError};
use crate::state::{Frame, HistoryRow, Status};

/// Reasons why a run cannot be resumed.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum ResumeError {
    /// The folder is not that of a run, or its files cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Read(#[from] ReadError),
    /// There is no usable checkpoint.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Checkpoint(#[from] CheckpointFileError),
    /// Another run is writing into the folder, or it is not writable.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Output(#[from] OutputError),
    /// The deck is invalid.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Deck(#[from] DeckError),
    /// The deck has changed.
    #[error("{}: {change}", path.display())]
    #[diagnostic(help("{}", advice(change)))]
    Changed {
        /// The deck in the folder.
        path: PathBuf,
        /// Description of the change.
        change: DeckChange,
    },
    /// The folder or the checkpoint has no deck.
    #[error("{}: there is no {DECK}, or the checkpoint knows none", .0.display())]
    #[diagnostic(help(
        "a run from a deck keeps it there: put it back, or begin anew with `wythe run`"
    ))]
    NoDeck(PathBuf),
    /// The model differs from that of the checkpoint although the deck is the same.
    #[error("{}: {why}", path.display())]
    #[diagnostic(help(
        "the deck is the same: a file that it names has changed, or this is another version of wythe"
    ))]
    OtherModel {
        /// The checkpoint.
        path: PathBuf,
        /// Description of the difference.
        why: CheckpointError,
    },
}

fn advice(change: &DeckChange) -> String {
    change
        .help()
        .map_or_else(String::new, |help| help.to_string())
}

impl From<ModelError> for ResumeError {
    fn from(error: ModelError) -> Self {
        Self::Deck(error.into())
    }
}

/// Locked folder of a run that has stopped.
#[derive(Debug)]
pub struct StoppedRun {
    path: PathBuf,
    lock: File,
    file: CheckpointFile,
    /// Old length of the last step over its present length; 1 unless the step was lengthened.
    part: f64,
}

/// A run that is ready to continue: by `solve::resume(model, checkpoint, &mut directory)`, or by `solve::run` if
/// there is no checkpoint.
#[derive(Debug)]
pub struct Resumed {
    /// The folder; its files end at the checkpoint.
    pub directory: RunDirectory,
    /// State of the solver; `None` if the run must start again by `solve::run`.
    pub checkpoint: Option<Checkpoint>,
    /// Faults that do not prevent the continuation.
    pub warnings: Vec<String>,
}

impl StoppedRun {
    /// Locks the folder and reads its checkpoint. Nothing is changed yet.
    ///
    /// # Errors
    /// The folder is not that of a run, another run is using it, or the checkpoint is missing or damaged.
    pub fn open(path: &Path) -> Result<Self, ResumeError> {
        let _is_a_run = RunFolder::open(path)?;
        let lock = lock(path)?;
        let file = CheckpointFile::read(&path.join(CHECKPOINT))?;
        Ok(Self {
            path: path.to_owned(),
            lock,
            file,
            part: 1.0,
        })
    }

    /// State of the solver.
    pub fn checkpoint(&self) -> &Checkpoint {
        &self.file.solver
    }

    /// The deck in the folder with `overrides` (dotted path, value), checked against the deck of the run. Only the
    /// title, `output` and the length of the last step may differ; a longer last step keeps its speed and its
    /// increment sizes.
    ///
    /// # Errors
    /// The deck is missing or invalid, or a change affects the results.
    pub fn deck(&mut self, overrides: &[(String, String)]) -> Result<Deck, ResumeError> {
        let path = self.path.join(DECK);
        let (Some(text), true) = (&self.file.deck, path.is_file()) else {
            return Err(ResumeError::NoDeck(self.path.clone()));
        };
        let before = Deck::from_str(text, CHECKPOINT)?;
        let mut deck = Deck::load(&path, overrides)?;
        if self.file.deck_folder.is_some() {
            deck = self.file.place(&self.path, deck);
        }
        spare_inputs(&self.path, OF_A_RUN, &deck.named_files())?;
        let (deck, part) = deck
            .resumed_from(&before)
            .map_err(|change| ResumeError::Changed { path, change })?;
        self.part = part;
        Ok(deck)
    }

    /// Whether all steps of `model` are computed and their results written.
    ///
    /// # Errors
    /// The folder is no longer that of a run.
    pub fn is_complete(&self, model: &Model) -> Result<bool, ResumeError> {
        let done = self.part == 1.0 && self.file.solver.is_the_end_of(model);
        // An unreadable summary counts as missing and is written again.
        let summary = RunFolder::open(&self.path)?.summary().unwrap_or(None);
        let status = summary.map(|summary| summary.status);
        // A collapsed run has no further increments.
        let collapsed = self.part == 1.0 && status == Some(Status::Collapsed);
        Ok(collapsed || (done && status == Some(Status::Completed)))
    }

    /// Prepares the files of the folder for continuation from the checkpoint. All files are checked by their check
    /// sums before any of them is changed. A damaged history is rebuilt from the fields; damaged fields or messages
    /// start again; without a history the run starts again. Damaged files are kept under another name.
    ///
    /// # Errors
    /// The model is not that of the checkpoint, or a file cannot be written. The folder is unchanged if the model is
    /// at fault.
    pub fn resume(mut self, model: &Model) -> Result<Resumed, ResumeError> {
        if self.part < 1.0 {
            self.file.solver.lengthen(model, self.part);
        }
        let path = self.path.clone();
        self.file
            .solver
            .check(model)
            .map_err(|why| ResumeError::OtherModel {
                path: path.join(CHECKPOINT),
                why,
            })?;
        let mut warnings = Vec::new();
        warnings.extend(self.other_version());
        let lines = self.history(model);
        let rows = match &lines {
            Ok(lines) => read_history(&path.join(HISTORY), &lines.bytes)?.rows,
            Err(_) => Vec::new(),
        };
        let fields = self.fields(model, &rows);
        let messages = self.messages(model);
        // All files are checked. The summary, which marks a complete folder, is removed before anything else changes.
        remove(&path, &[SUMMARY, LOAD_DISPLACEMENT, CRACK_PATTERN, REPORT])?;
        remove_companions(&path)?;
        let lines = match lines {
            Ok(lines) => lines,
            Err(why) => {
                // Removes the temporary files of the fields and messages.
                drop((fields, messages));
                return self.begin_anew(model, &why, warnings);
            }
        };
        let history = self.continue_history(model, &lines, &mut warnings)?;
        let (fields, last_frame) = match fields {
            Ok(both) => both,
            Err(why) => (self.new_fields(model, &why, &mut warnings)?, None),
        };
        let messages = match messages {
            Some(Ok((messages, new))) => {
                writing(&path, MESSAGES, |_| new.keep())?;
                Some(messages)
            }
            Some(Err(why)) => self.new_messages(model, &why, &mut warnings)?,
            None => {
                warnings.extend(self.messages_end());
                None
            }
        };
        let files = Files {
            history,
            fields,
            messages,
        };
        let begun = RunDirectory::begun(&path, self.lock, model, files);
        Ok(Resumed {
            directory: begun.resumed((&rows, last_frame), &self.file),
            checkpoint: Some(self.file.solver),
            warnings,
        })
    }

    /// Warning about a run that another version began.
    fn other_version(&self) -> Option<String> {
        let (began, version) = (&self.file.version, env!("CARGO_PKG_VERSION"));
        (began != version).then(|| {
            format!("the run began with wythe {began}, this is {version}: last digits may differ")
        })
    }

    /// Begins the run again, since its history is lost.
    fn begin_anew(
        self,
        model: &Model,
        why: &str,
        mut warnings: Vec<String>,
    ) -> Result<Resumed, ResumeError> {
        let kept = set_aside(&self.path, HISTORY);
        warnings.push(format!(
            "{HISTORY} cannot be read ({why}), nor made anew from {FIELDS}: {kept}the run begins anew"
        ));
        Ok(Resumed {
            directory: RunDirectory::begin(&self.path, self.lock, model)?,
            checkpoint: None,
            warnings,
        })
    }

    /// Writer behind these lines. A file that was rebuilt is put in the place of the damaged one.
    fn continue_history(
        &self,
        model: &Model,
        lines: &Lines,
        warnings: &mut Vec<String>,
    ) -> Result<HistoryWriter, OutputError> {
        if let Some(why) = &lines.made_anew {
            let kept = set_aside(&self.path, HISTORY);
            warnings.push(format!(
                "{HISTORY} cannot be read ({why}): {kept}it is made anew from {FIELDS}"
            ));
        }
        let resume = |file: &Path| HistoryWriter::resume(file, model, &lines.bytes);
        writing(&self.path, HISTORY, resume)
    }

    /// Fields without the frames of a file that cannot be read.
    fn new_fields(
        &self,
        model: &Model,
        why: &str,
        warnings: &mut Vec<String>,
    ) -> Result<VtkHdfWriter, OutputError> {
        let (kept, frames) = (set_aside(&self.path, FIELDS), self.file.frames);
        warnings.push(format!(
            "{FIELDS} cannot be read ({why}): {kept}it begins anew, without the {frames} frames before"
        ));
        let create = |file: &Path| VtkHdfWriter::create(file, model);
        writing(&self.path, FIELDS, create)
    }

    /// Warning about messages that the deck no longer wants.
    fn messages_end(&self) -> Option<String> {
        let ends = || format!("{MESSAGES} ends here: the deck wants none any more");
        self.file.messages.is_some().then(ends)
    }

    /// Complete lines of the history up to the checkpoint, rebuilt from the fields if the file is damaged; or the
    /// reason why there are none.
    fn history(&self, model: &Model) -> Result<Lines, String> {
        let extent = self.file.history;
        let why = match extent.read(&self.path.join(HISTORY)) {
            Ok(bytes) => {
                return Ok(Lines {
                    bytes,
                    made_anew: None,
                });
            }
            Err(why) => first_line(&why),
        };
        let made_anew = || -> io::Result<Vec<u8>> {
            let fields = FieldsFile::open(&self.path.join(FIELDS))?;
            written(model, &fields.rows(model, self.file.solver.increments())?)
        };
        match made_anew() {
            Ok(bytes) if Extent::of(&bytes) == extent => Ok(Lines {
                bytes,
                made_anew: Some(why),
            }),
            _ => Err(why),
        }
    }

    /// Fields and their last frame before the checkpoint, or the reason why they cannot continue. Readers see no
    /// change.
    fn fields(
        &self,
        model: &Model,
        rows: &[HistoryRow],
    ) -> Result<(VtkHdfWriter, Option<Frame>), String> {
        let (path, frames) = (self.path.join(FIELDS), self.file.frames);
        let read = || -> io::Result<_> {
            let file = FieldsFile::open(&path)?;
            let all = file.times().iter().zip(file.increments()).take(frames);
            let same = |(time, increment): (&f64, &usize)| {
                let row = increment.checked_sub(1).and_then(|row| rows.get(row));
                row.is_some_and(|row| row.time == *time)
            };
            if all.clone().count() < frames || !all.clone().all(same) {
                let why = format!("its frames are not those of {HISTORY}");
                return Err(io::Error::new(io::ErrorKind::InvalidData, why));
            }
            let last = frames.checked_sub(1).map(|last| file.frame(last));
            let last = last.transpose()?;
            drop(file);
            let writer =
                VtkHdfWriter::reopen(&path, model, (self.file.solver.increments(), frames))?;
            Ok((writer, last))
        };
        read().map_err(|why| first_line(&why))
    }

    /// Messages up to the checkpoint and the file that will replace the old one, or the reason why there are none;
    /// `None` if the model asks for no messages.
    fn messages(&self, model: &Model) -> Option<Result<(McapWriter, NewFile), String>> {
        if !model.output.mcap {
            return None;
        }
        Some(match &self.file.messages {
            Some(mark) => McapWriter::resume(&self.path.join(MESSAGES), model, mark)
                .map_err(|why| format!("cannot be read ({})", first_line(&why))),
            None => Err("was not wanted before".to_owned()),
        })
    }

    /// Messages that start at the checkpoint.
    fn new_messages(
        &self,
        model: &Model,
        why: &str,
        warnings: &mut Vec<String>,
    ) -> Result<Option<McapWriter>, OutputError> {
        let increments = self.file.solver.increments();
        let kept = set_aside(&self.path, MESSAGES);
        warnings.push(format!(
            "{MESSAGES} {why}: {kept}it begins anew, without the {increments} increments before"
        ));
        let mut begun = begin_messages(&self.path, model)?;
        if let Some(messages) = &mut begun {
            let late = Mark::late(increments, self.file.frames);
            messages.begin_at(self.file.messages.as_ref().unwrap_or(&late));
            if let Some(deck) = &self.file.deck {
                writing(&self.path, MESSAGES, |_| {
                    messages.attach(DECK, "application/toml", deck)
                })?;
            }
        }
        Ok(begun)
    }
}

/// The history up to the checkpoint.
struct Lines {
    bytes: Vec<u8>,
    /// Fault of the file if the lines were rebuilt from the fields.
    made_anew: Option<String>,
}

/// Renames a damaged file to the form `history.damaged.csv` and returns a message; the message is empty if there is
/// no such file.
fn set_aside(folder: &Path, name: &str) -> String {
    let (stem, ending) = name.rsplit_once('.').unwrap_or((name, ""));
    let aside = format!("{stem}.damaged.{ending}");
    match std::fs::rename(folder.join(name), folder.join(&aside)) {
        Ok(()) => format!("it is kept as {aside}, and "),
        // The file may have been removed or never have existed.
        Err(_) => String::new(),
    }
}

/// Messages of HDF5 contain a whole stack of errors; the first line suffices.
fn first_line(why: &io::Error) -> String {
    let why = why.to_string();
    why.lines().next().unwrap_or_default().to_owned()
}
