//! `run.mcap`: the run in time, for Foxglove and whatever else reads MCAP.
//!
//! ```text
//! /step         wythe.Step            a message an increment: its row of history.csv
//! /iteration    wythe.Iteration       a message a linear solve
//! /ladder       wythe.Ladder          where the procedure changes, and why
//! /log          foxglove.Log          the same, warnings and how the run ended, for people
//! /scene        foxglove.SceneUpdate  the deformed solids, coloured by damage       [m]
//! /interfaces   foxglove.SceneUpdate  the interfaces, coloured by state             [m]
//! attachments   model.toml, and the experiment that the deck names
//! ```
//!
//! All messages are JSON. Log times are uniform, [`TICK`] an increment, whatever the increment's size
//! and whatever it took, so that a replay is smooth; the step time is in the messages. One run writes
//! the same bytes each time.
//!
//! Chunks are made in memory, appended whole, and flushed at each increment: a file that was cut short
//! has every whole increment before the cut, and [`salvage`] gives it back its index.

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
    /// The same file, to wait for the disk.
    file: File,
    scene: Scene,
    topics: Topics,
    /// Increments written.
    increments: u64,
    /// Messages since the last increment.
    between: u64,
    /// Frames seen.
    frames: usize,
    /// Whether the last frame is in the file.
    shown: bool,
    attachments: u64,
    /// Check sum of what they and the messages say.
    sum: Sum,
    /// What could not be written between increments, where nobody can be told.
    pending: Option<io::Error>,
}

/// A channel of the file and the number of its messages.
#[derive(Debug, Default)]
struct Topic {
    channel: u16,
    sequence: u32,
}

/// A row of the history under the names of its columns.
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
    /// Creates (or replaces) the file, with the model at rest.
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

    /// Attaches a file of the user's.
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

    /// Appends an increment, on disk on return.
    ///
    /// # Errors
    /// The frame is not of this model, or the file cannot be written.
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

    /// Tells of a linear solve: step from 0, step time [s], and how many there were in this increment.
    pub fn progress(&mut self, step: usize, time: f64, iterations: usize) {
        let increment = self.increments + 1;
        let text = json!({
            "increment": increment, "step": step, "time": time, "iterations": iterations,
        });
        let stamp = self.soon();
        let sent = self.send("/iteration", stamp, &text.to_string());
        self.keep(sent);
    }

    /// Tells of a change of the procedure. What is told of the increment before goes to the file at once: a
    /// checkpoint may follow, and chunks are to be the same with it and without.
    pub fn note(&mut self, reason: &str) {
        let increment = self.increments + 1;
        let of_last = self.between == 0;
        let text = json!({ "increment": increment, "reason": reason });
        let stamp = self.soon();
        let sent = self
            .send("/ladder", stamp, &text.to_string())
            .and_then(|()| self.log(Level::Info, reason, stamp))
            .and_then(|()| if of_last { self.flush() } else { Ok(()) });
        self.keep(sent);
    }

    /// Writes warnings, how the run ended, the last frame if it is not yet there, and the index.
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

    /// A log time after the last message's and before the next increment's [ns].
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

    /// Keeps the first error for the next increment.
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

/// The channels of a run in its file; those that are there already stay as they are.
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
    let ladder = json!({ "increment": 0, "reason": "" });
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
            "/ladder",
            schemas::like("wythe.Ladder", "A change of the procedure", &ladder),
        ),
        ("/log", schemas::log()),
        ("/scene", schemas::scene_update()),
        ("/interfaces", schemas::scene_update()),
    ])
}

/// How files are written: chunks made in memory, one a flush, packed on this thread. Higher levels take
/// half as long again for two percent.
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

/// The system's error where there is one.
fn into_io(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        error => io::Error::other(format!("MCAP: {error}")),
    }
}

#[cfg(test)]
mod tests;
