//! A run that stopped, or was stopped, and goes on in its folder.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use miette::Diagnostic;

use super::checkpoint::{CHECKPOINT, CheckpointFile, CheckpointFileError};
use super::directory::{
    CRACK_PATTERN, DECK, FIELDS, Files, HISTORY, LOAD_DISPLACEMENT, MESSAGES, REPORT, SUMMARY,
    begin_messages, lock, remove, writing,
};
use super::mcap::Mark;
use super::vtkhdf::read::FieldsFile;
use super::{
    Frame, HistoryWriter, McapWriter, OutputError, ReadError, RunDirectory, RunFolder, Status,
    VtkHdfWriter,
};
use crate::error::{DeckError, ModelError};
use crate::model::deck::DeckChange;
use crate::model::{Deck, Model};
use crate::solve::{Checkpoint, CheckpointError};

/// A run that cannot go on.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum ResumeError {
    /// The folder is not one of a run, or its files cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Read(#[from] ReadError),
    /// There is no checkpoint that could be taken up.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Checkpoint(#[from] CheckpointFileError),
    /// Another run writes into the folder, or it cannot be written into.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Output(#[from] OutputError),
    /// The deck is wrong.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Deck(#[from] DeckError),
    /// The deck has changed.
    #[error("{}: {change}", path.display())]
    #[diagnostic(help("{}", advice(change)))]
    Changed {
        /// The deck in the folder.
        path: PathBuf,
        /// What has changed.
        change: DeckChange,
    },
    /// The run had no deck that the folder would hold.
    #[error("{}: there is no {DECK}, or the checkpoint knows none", .0.display())]
    #[diagnostic(help(
        "a run from a deck keeps it there: put it back, or begin anew with `wythe run`"
    ))]
    NoDeck(PathBuf),
    /// The model is not that of the checkpoint though the deck is.
    #[error("{}: {why}", path.display())]
    #[diagnostic(help(
        "the deck is the same: a file that it names has changed, or this is another version of wythe"
    ))]
    OtherModel {
        /// The checkpoint.
        path: PathBuf,
        /// What differs.
        why: CheckpointError,
    },
    /// The history ends before the checkpoint, or is another's.
    #[error("{}: does not go with {CHECKPOINT}: {why}", path.display())]
    #[diagnostic(help(
        "the file was changed or lost with the disk: restore it, or begin anew with `wythe run`"
    ))]
    History {
        /// The history.
        path: PathBuf,
        /// What is wrong.
        why: io::Error,
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

/// The folder of a run that has stopped, locked for whoever goes on with it.
#[derive(Debug)]
pub struct StoppedRun {
    path: PathBuf,
    lock: File,
    file: CheckpointFile,
    /// The last step then over the one now, and whether it is longer.
    part: f64,
}

/// A run that can go on: `solve::resume(model, checkpoint, &mut directory)`.
#[derive(Debug)]
pub struct Resumed {
    /// The folder, its files cut back to the checkpoint.
    pub directory: RunDirectory,
    /// Where the solver was.
    pub checkpoint: Checkpoint,
    /// What is not as it should be, and no reason to stop.
    pub warnings: Vec<String>,
}

impl StoppedRun {
    /// Locks the folder and reads its checkpoint. Nothing is changed yet.
    ///
    /// # Errors
    /// No folder of a run, another run in it, no checkpoint or a damaged one.
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

    /// Where the solver was.
    pub fn checkpoint(&self) -> &Checkpoint {
        &self.file.solver
    }

    /// The deck in the folder, keys of `overrides` (dotted path, value) said anew, if the run can go on
    /// with it: beside the title and `output` only the last step may differ, by being longer. That keeps
    /// its speed and its increments.
    ///
    /// # Errors
    /// There is no deck, it is wrong, or it has changed in what decides the results.
    pub fn deck(&mut self, overrides: &[(String, String)]) -> Result<Deck, ResumeError> {
        let path = self.path.join(DECK);
        let (Some(text), true) = (&self.file.deck, path.is_file()) else {
            return Err(ResumeError::NoDeck(self.path.clone()));
        };
        let before = Deck::from_str(text, CHECKPOINT)?;
        let mut deck = Deck::load(&path, overrides)?;
        if let Some(folder) = &self.file.deck_folder {
            deck = deck.in_folder(folder.into());
        }
        let (deck, part) = deck
            .resumed_from(&before)
            .map_err(|change| ResumeError::Changed { path, change })?;
        self.part = part;
        Ok(deck)
    }

    /// Whether everything of `model` is done and written.
    ///
    /// # Errors
    /// The summary cannot be read.
    pub fn is_complete(&self, model: &Model) -> Result<bool, ResumeError> {
        let done = self.part == 1.0 && self.file.solver.is_the_end_of(model);
        let summary = RunFolder::open(&self.path)?.summary()?;
        let status = summary.map(|summary| summary.status);
        // Of what has collapsed nothing is left to do.
        let collapsed = self.part == 1.0 && status == Some(Status::Collapsed);
        Ok(collapsed || (done && status == Some(Status::Completed)))
    }

    /// Cuts the files of the folder back to the checkpoint and goes on with them.
    ///
    /// # Errors
    /// The model is not that of the checkpoint, the history ends before it, or a file cannot be read or
    /// written. Nothing is changed if the model or the history is to blame.
    pub fn resume(mut self, model: &Model) -> Result<Resumed, ResumeError> {
        if self.part < 1.0 {
            self.file.solver.lengthen(model, self.part);
        }
        let (path, file) = (&self.path, &self.file);
        file.solver
            .check(model)
            .map_err(|why| ResumeError::OtherModel {
                path: path.join(CHECKPOINT),
                why,
            })?;
        let mut warnings = Vec::new();
        let version = env!("CARGO_PKG_VERSION");
        if file.version != version {
            warnings.push(format!(
                "the run began with wythe {}, this is {version}: last digits may differ",
                file.version
            ));
        }
        let rows = file.solver.increments();
        let history = HistoryWriter::resume(&path.join(HISTORY), model, rows).map_err(|why| {
            let path = path.join(HISTORY);
            ResumeError::History { path, why }
        })?;
        // What says "whole" goes before anything else changes.
        remove(path, &[SUMMARY, LOAD_DISPLACEMENT, CRACK_PATTERN, REPORT])?;
        let kept = RunFolder::open(path)?.history()?.rows;
        let (fields, last_frame) = self.fields(model, &mut warnings)?;
        let messages = self.messages(model, &mut warnings)?;
        let files = Files {
            history,
            fields,
            messages,
        };
        let directory =
            RunDirectory::resumed(path, self.lock, model, files, (&kept, last_frame), file);
        Ok(Resumed {
            directory,
            checkpoint: self.file.solver,
            warnings,
        })
    }

    /// The fields and the last frame that counts. Where they are damaged, new ones begin here: the
    /// checkpoint has all that the solver needs.
    fn fields(
        &self,
        model: &Model,
        warnings: &mut Vec<String>,
    ) -> Result<(VtkHdfWriter, Option<Frame>), OutputError> {
        let (path, frames) = (self.path.join(FIELDS), self.file.frames);
        let increments = self.file.solver.increments();
        let last = || -> io::Result<Option<Frame>> {
            let Some(last) = frames.checked_sub(1) else {
                return Ok(None);
            };
            FieldsFile::open(&path)?.frame(last).map(Some)
        };
        let read =
            last().and_then(|last| Ok((VtkHdfWriter::reopen(&path, model, increments)?, last)));
        match read {
            Ok(both) => Ok(both),
            Err(why) => {
                let why = first_line(&why);
                warnings.push(format!(
                    "{FIELDS} cannot be read ({why}): it begins anew, without the {frames} frames before"
                ));
                let fields = writing(&self.path, FIELDS, |file| VtkHdfWriter::create(file, model))?;
                Ok((fields, None))
            }
        }
    }

    /// The messages up to the checkpoint, or new ones from here on.
    fn messages(
        &self,
        model: &Model,
        warnings: &mut Vec<String>,
    ) -> Result<Option<McapWriter>, OutputError> {
        let path = self.path.join(MESSAGES);
        let late = Mark::late(self.file.solver.increments(), self.file.frames);
        let mark = self.file.messages.as_ref();
        if !model.output.mcap {
            if mark.is_some() {
                warnings.push(format!(
                    "{MESSAGES} ends here: the deck wants none any more"
                ));
            }
            return Ok(None);
        }
        let why = match mark {
            Some(mark) => match McapWriter::resume(&path, model, mark) {
                Ok(messages) => return Ok(Some(messages)),
                Err(why) => format!("cannot be read ({})", first_line(&why)),
            },
            None => "was not wanted before".to_owned(),
        };
        let increments = self.file.solver.increments();
        warnings.push(format!(
            "{MESSAGES} {why}: it begins anew, without the {increments} increments before"
        ));
        let mut begun = begin_messages(&self.path, model)?;
        if let Some(messages) = &mut begun {
            messages.begin_at(mark.unwrap_or(&late));
            if let Some(deck) = &self.file.deck {
                writing(&self.path, MESSAGES, |_| {
                    messages.attach(DECK, "application/toml", deck)
                })?;
            }
        }
        Ok(begun)
    }
}

/// HDF5 says more than anybody wants to read.
fn first_line(why: &io::Error) -> String {
    let why = why.to_string();
    why.lines().next().unwrap_or_default().to_owned()
}
