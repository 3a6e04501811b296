//! `run.mcap`: the course of a run as messages for Foxglove and other MCAP readers.
//!
//! ```text
//! /step         wythe.Step            one message per increment: its row of history.csv
//! /iteration    wythe.Iteration       one message per linear solve
//! /procedures   wythe.Procedures      changes of procedure with their reasons
//! /log          foxglove.Log          the same, warnings and the end of the run as text
//! /scene        foxglove.SceneUpdate  the deformed solids, coloured by damage       [m]
//! /interfaces   foxglove.SceneUpdate  the interfaces, coloured by state             [m]
//! attachments   model.toml, and the experiment named in the deck
//! ```
//!
//! All messages are JSON. Log times are uniform, [`TICK`] per increment regardless of its size and computing time, so
//! that a replay runs smoothly; the messages contain the step time. Repeated runs write the same bytes.
//!
//! Chunks are built in memory, appended as a whole and flushed at each increment. A truncated file therefore has
//! every increment before the cut, and [`salvage`] restores its index.

mod resuming;
pub mod salvage;
mod scene;
mod schemas;
mod sum;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Write as _};
use std::path::Path;

use ::mcap::records::MessageHeader;
use ::mcap::{Attachment, Compression, McapError, WriteOptions, Writer};
use serde::Serialize;
use serde_json::json;

use crate::files::NewFile;
use crate::model::Model;
use crate::state::{Frame, HistoryRow, Status, Summary};
pub use resuming::Mark;
use resuming::Topics;
use scene::Scene;
use schemas::{MESSAGE_ENCODING, SCHEMA_ENCODING, Schema};
use sum::Sum;

/// Log time from one increment to the next [ns].
pub const TICK: u64 = 100_000_000;

/// Levels of `foxglove.Log`.
#[derive(Clone, Copy)]
enum Level {
    Info = 2,
    Warning = 3,
    Error = 4,
}

/// Writes `run.mcap` increment by increment.
pub struct McapWriter {
    writer: Writer<BufWriter<File>>,
    /// The same file, to synchronise with the disk.
    file: File,
    scene: Scene,
    topics: Topics,
    /// Number of increments written.
    increments: u64,
    /// Number of messages since the last increment.
    between: u64,
    /// Number of frames received.
    frames: usize,
    /// Whether the last frame has been written.
    shown: bool,
    attachments: u64,
    /// Check sum of messages and attachments.
    sum: Sum,
    /// Error of a message between increments; it is returned at the next increment.
    pending: Option<io::Error>,
}

/// A channel of the file with its number of messages.
#[derive(Debug, Default)]
struct Topic {
    channel: u16,
    sequence: u32,
}

/// A row of the history with the names of its columns.
#[derive(Serialize)]
struct Step<'a> {
    #[serde(flatten)]
    row: &'a HistoryRow,
    #[serde(flatten)]
    probes: BTreeMap<String, f64>,
}

impl<'a> Step<'a> {
    fn new(model: &Model, row: &'a HistoryRow) -> Self {
        Self {
            row,
            probes: model
                .columns()
                .into_iter()
                .zip(row.probes.iter().copied())
                .collect(),
        }
    }
}

impl McapWriter {
    /// Creates or replaces the file and writes the model at rest.
    ///
    /// # Errors
    /// The file cannot be created or written.
    pub fn create(path: &Path, model: &Model) -> io::Result<Self> {
        let library = format!("wythe {}", env!("CARGO_PKG_VERSION"));
        let new = NewFile::create(path)?;
        let created = new.file()?;
        let file = created.try_clone()?;
        let mut writer = options("", &library)
            .create(BufWriter::new(created))
            .map_err(into_io)?;
        let topics = open_topics(&mut writer, model)?;
        let mut run = Self {
            writer,
            file,
            scene: Scene::of(model),
            topics,
            increments: 0,
            between: 0,
            frames: 0,
            shown: true,
            attachments: 0,
            sum: Sum::new("", &library),
            pending: None,
        };
        let (elements, nodes) = (model.mesh.elements.len(), model.mesh.nodes.len());
        let begin = format!("{}: {elements} elements, {nodes} nodes", model.title);
        run.log(Level::Info, &begin, 0)?;
        run.show(model, &scene::rest(model))?;
        run.flush()?;
        new.keep()?;
        Ok(run)
    }

    /// Attaches a file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn attach(&mut self, name: &str, media_type: &str, text: &str) -> io::Result<()> {
        let attachment = Attachment {
            log_time: self.now(),
            create_time: 0,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            data: text.as_bytes().into(),
        };
        self.writer.attach(&attachment).map_err(into_io)?;
        let times = (attachment.log_time, attachment.create_time);
        self.sum
            .attachment(name, media_type, times, &attachment.data);
        self.attachments += 1;
        self.flush()
    }

    /// Appends an increment; it is on the disk on return.
    ///
    /// # Errors
    /// The frame does not fit the model, or the file cannot be written.
    pub fn increment(
        &mut self,
        model: &Model,
        row: &HistoryRow,
        frame: Option<&Frame>,
    ) -> io::Result<()> {
        if let Some(error) = self.pending.take() {
            return Err(error);
        }
        (self.increments, self.between) = (self.increments + 1, 0);
        let step = serde_json::to_string(&Step::new(model, row)).map_err(io::Error::other)?;
        self.send("/step", self.now(), &step)?;
        if let Some(frame) = frame {
            self.frames += 1;
            self.shown = self.frames.is_multiple_of(model.output.scene_every.max(1));
            if self.shown {
                self.show(model, frame)?;
            }
        }
        self.flush()
    }

    /// Reports a linear solve: step from 0, step time [s], and number of solves in this increment.
    pub fn progress(&mut self, step: usize, time: f64, iterations: usize) {
        let increment = self.increments + 1;
        let text = json!({
            "increment": increment, "step": step, "time": time, "iterations": iterations,
        });
        let stamp = self.soon();
        let sent = self.send("/iteration", stamp, &text.to_string());
        self.keep(sent);
    }

    /// Reports a change of procedure. A note that directly follows an increment is flushed at once: a checkpoint may
    /// follow, and the chunks must be the same with and without it.
    pub fn note(&mut self, reason: &str) {
        let increment = self.increments + 1;
        let of_last = self.between == 0;
        let text = json!({ "increment": increment, "reason": reason });
        let stamp = self.soon();
        let sent = self
            .send("/procedures", stamp, &text.to_string())
            .and_then(|()| self.log(Level::Info, reason, stamp))
            .and_then(|()| if of_last { self.flush() } else { Ok(()) });
        self.keep(sent);
    }

    /// Writes the warnings, the end of the run, the last frame if it is missing, and the index.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn finish(
        mut self,
        model: &Model,
        last: Option<&Frame>,
        run: &Summary,
        model_warnings: &[String],
    ) -> io::Result<()> {
        if let Some(error) = self.pending.take() {
            return Err(error);
        }
        if let Some(frame) = last.filter(|_| !self.shown) {
            self.show(model, frame)?;
        }
        let now = self.soon();
        for warning in model_warnings.iter().chain(&run.warnings) {
            self.log(Level::Warning, warning, now)?;
        }
        let (level, ended) = match run.status {
            Status::Completed => (Level::Info, "completed"),
            Status::Collapsed => (Level::Warning, "collapsed"),
            Status::Interrupted => (Level::Warning, "interrupted"),
            Status::Stopped => (Level::Warning, "stopped"),
            Status::NotConverged => (Level::Error, "not converged"),
        };
        let colon = if run.message.is_empty() { "" } else { ": " };
        self.log(level, &format!("{ended}{colon}{}", run.message), now)?;
        self.writer.finish().map_err(into_io)?;
        self.writer.into_inner().flush()
    }

    /// Log time of the last increment [ns].
    fn now(&self) -> u64 {
        self.increments * TICK
    }

    /// A log time after the last message and before the next increment [ns].
    fn soon(&mut self) -> u64 {
        self.between += 1;
        self.now() + TICK - TICK / (self.between + 1)
    }

    fn show(&mut self, model: &Model, frame: &Frame) -> io::Result<()> {
        let now = self.now();
        let solids = self.scene.solids(model, frame, now)?;
        self.send("/scene", now, &solids)?;
        if model.contact.slave_facets.is_empty() {
            return Ok(());
        }
        let interfaces = Scene::interfaces(model, frame, now)?;
        self.send("/interfaces", now, &interfaces)
    }

    fn log(&mut self, level: Level, message: &str, stamp: u64) -> io::Result<()> {
        let (sec, nsec) = (stamp / 1_000_000_000, stamp % 1_000_000_000);
        let text = json!({
            "timestamp": { "sec": sec, "nsec": nsec }, "level": level as u8, "message": message,
            "name": "wythe", "file": "", "line": 0,
        });
        self.send("/log", stamp, &text.to_string())
    }

    fn send(&mut self, name: &'static str, log_time: u64, text: &str) -> io::Result<()> {
        let topic = self.topics.entry(name).or_default();
        let header = MessageHeader {
            channel_id: topic.channel,
            sequence: topic.sequence,
            log_time,
            publish_time: log_time,
        };
        topic.sequence += 1;
        self.sum.message(name, &header, text.as_bytes());
        self.writer
            .write_to_known_channel(&header, text.as_bytes())
            .map_err(into_io)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.writer.flush().map_err(into_io)
    }

    /// Stores the first error for the next increment.
    fn keep(&mut self, sent: io::Result<()>) {
        if let Err(error) = sent {
            self.pending.get_or_insert(error);
        }
    }
}

impl std::fmt::Debug for McapWriter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("McapWriter")
            .field("increments", &self.increments)
            .field("frames", &self.frames)
            .finish_non_exhaustive()
    }
}

/// Creates the channels of a run; existing ones are kept.
fn open_topics<W: io::Write + io::Seek>(
    writer: &mut Writer<W>,
    model: &Model,
) -> io::Result<Topics> {
    let mut topics = Topics::new();
    for (topic, schema) in channels(model)? {
        let id = writer
            .add_schema(schema.name, SCHEMA_ENCODING, schema.text.as_bytes())
            .map_err(into_io)?;
        let channel = writer
            .add_channel(id, topic, MESSAGE_ENCODING, &BTreeMap::new())
            .map_err(into_io)?;
        let sequence = 0;
        topics.insert(topic, Topic { channel, sequence });
    }
    Ok(topics)
}

/// Topics and their schemas.
fn channels(model: &Model) -> io::Result<[(&'static str, Schema); 6]> {
    let row = HistoryRow {
        probes: vec![0.0; model.columns().len()],
        ..HistoryRow::default()
    };
    let step = serde_json::to_value(Step::new(model, &row)).map_err(io::Error::other)?;
    let iteration = json!({ "increment": 0, "step": 0, "time": 0.0, "iterations": 0 });
    let procedures = json!({ "increment": 0, "reason": "" });
    Ok([
        (
            "/step",
            schemas::like("wythe.Step", "A converged increment", &step),
        ),
        (
            "/iteration",
            schemas::like("wythe.Iteration", "A linear solve", &iteration),
        ),
        (
            "/procedures",
            schemas::like("wythe.Procedures", "A change of the procedure", &procedures),
        ),
        ("/log", schemas::log()),
        ("/scene", schemas::scene_update()),
        ("/interfaces", schemas::scene_update()),
    ])
}

/// Options for writing: one chunk per flush, built in memory and compressed on this thread. Higher compression levels
/// take half as long again and save 2 %.
fn options(profile: &str, library: &str) -> WriteOptions {
    WriteOptions::new()
        .compression(Some(Compression::Zstd))
        .compression_threads(0)
        .compression_level(1)
        .chunk_size(None)
        .disable_seeking(true)
        .profile(profile)
        .library(library)
}

/// The error of the system if there is one.
fn into_io(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        error => io::Error::other(format!("MCAP: {error}")),
    }
}

#[cfg(test)]
mod tests;
