//! Continues the `run.mcap` of a run that has stopped.
//!
//! The valid records are copied to a new file, which then replaces the old one and grows; an interruption leaves
//! either file complete. Messages are numbered by topic, so a [`Mark`] identifies exactly those before a checkpoint.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use ::mcap::records::{Header, Record};
use serde::{Deserialize, Serialize};

use super::salvage::{self, Out};
use super::sum::Sum;
use super::{McapWriter, Scene, Topic, into_io, open_topics};
use crate::files::NewFile;
use crate::model::Model;

/// Extent of the file at a checkpoint.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Mark {
    increments: u64,
    between: u64,
    frames: usize,
    shown: bool,
    attachments: u64,
    /// Number of messages by topic.
    messages: BTreeMap<String, u32>,
    /// Check sum of all messages and attachments.
    sum: u32,
}

impl Mark {
    /// Mark of a file that starts after this many increments and frames.
    pub fn late(increments: usize, frames: usize) -> Self {
        Self {
            increments: increments as u64,
            frames,
            shown: true,
            ..Self::default()
        }
    }
}

/// Filter that passes the records before a mark.
#[derive(Debug)]
pub(super) struct Until<'m> {
    mark: &'m Mark,
    /// Topic of each channel and number of its messages before the mark.
    kept: BTreeMap<u16, (String, u32)>,
    attachments: u64,
    /// Check sum of the passed records; `None` before the header.
    sum: Option<Sum>,
}

impl Until<'_> {
    /// Starts with the header of the file.
    pub fn begin(&mut self, header: &Header) {
        self.sum = Some(Sum::new(&header.profile, &header.library));
    }

    /// Whether the record is before the mark.
    pub fn keeps(&mut self, record: &Record) -> bool {
        match record {
            Record::Channel(channel) => {
                let kept = self.mark.messages.get(&channel.topic).copied();
                let kept = (channel.topic.clone(), kept.unwrap_or(0));
                self.kept.insert(channel.id, kept);
                true
            }
            Record::Message { header, data } => {
                let Some((topic, kept)) = self.kept.get(&header.channel_id) else {
                    return false;
                };
                let keeps = header.sequence < *kept;
                if let (true, Some(sum)) = (keeps, &mut self.sum) {
                    sum.message(topic, header, data);
                }
                keeps
            }
            Record::Attachment { header, data, .. } => {
                self.attachments += 1;
                let keeps = self.attachments <= self.mark.attachments;
                if let (true, Some(sum)) = (keeps, &mut self.sum) {
                    let times = (header.log_time, header.create_time);
                    sum.attachment(&header.name, &header.media_type, times, data);
                }
                keeps
            }
            _ => true,
        }
    }
}

impl McapWriter {
    /// Extent of the file now; all of it is on the disk on return.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn mark(&mut self) -> io::Result<Mark> {
        if let Some(error) = self.pending.take() {
            return Err(error);
        }
        flush(&mut self.writer)?;
        self.file.sync_data()?;
        let messages = self.topics.iter();
        Ok(Mark {
            increments: self.increments,
            between: self.between,
            frames: self.frames,
            shown: self.shown,
            attachments: self.attachments,
            sum: self.sum.value(),
            messages: messages
                .map(|(topic, of)| ((*topic).to_owned(), of.sequence))
                .collect(),
        })
    }

    /// Opens the file of a run of this model, complete or truncated, to continue at `mark`; later records are
    /// dropped. The old file is unchanged until the new one is kept.
    ///
    /// # Errors
    /// The file cannot be read or written, or data before the mark are missing or changed.
    pub fn resume(path: &Path, model: &Model, mark: &Mark) -> io::Result<(Self, NewFile)> {
        let new = NewFile::create(path)?;
        let run = reopen(path, new.file()?, model, mark)?;
        run.file.sync_data()?;
        Ok((run, new))
    }

    /// Takes over the counters of a mark, in a file without the earlier data.
    pub fn begin_at(&mut self, mark: &Mark) {
        (self.increments, self.between) = (mark.increments, mark.between);
        self.frames = mark.frames;
    }
}

fn reopen(path: &Path, new: File, model: &Model, mark: &Mark) -> io::Result<McapWriter> {
    let wrong = |why: &str| io::Error::new(io::ErrorKind::InvalidData, why.to_owned());
    let file = new.try_clone()?;
    let mut until = Until {
        mark,
        kept: BTreeMap::new(),
        attachments: 0,
        sum: None,
    };
    let copied = salvage::copy_until(path, BufWriter::new(new), &mut until)?;
    let Some((mut writer, found)) = copied else {
        return Err(wrong("it does not begin like an MCAP file"));
    };
    let messages: u64 = mark.messages.values().map(|n| u64::from(*n)).sum();
    if found.messages < messages || found.attachments < mark.attachments {
        return Err(wrong("it ends before the checkpoint, or is damaged there"));
    }
    let sum = until.sum.filter(|sum| sum.value() == mark.sum);
    let Some(sum) = sum else {
        return Err(wrong("its check sum differs from that in the checkpoint"));
    };
    let mut topics = open_topics(&mut writer, model)?;
    for (topic, of) in &mut topics {
        of.sequence = mark.messages.get(*topic).copied().unwrap_or(0);
    }
    flush(&mut writer)?;
    Ok(McapWriter {
        writer,
        file,
        scene: Scene::of(model),
        topics,
        increments: mark.increments,
        between: mark.between,
        frames: mark.frames,
        shown: mark.shown,
        attachments: mark.attachments,
        sum,
        pending: None,
    })
}

fn flush(writer: &mut Out) -> io::Result<()> {
    writer.flush().map_err(into_io)
}

/// Topics of a run by name.
pub(super) type Topics = BTreeMap<&'static str, Topic>;
