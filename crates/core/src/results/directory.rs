//! The folder of a run.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::beside::FieldsBeside;
use super::checkpoint::CheckpointFile;
use super::estimate::remove_companions;
use super::lock::{lock, writing};
use super::output::{
    CHECKPOINT, CRACK_PATTERN, DECK, FIELDS, HISTORY, INTERFACES, LOAD_DISPLACEMENT, MESSAGES,
    OF_A_RUN, OutputError, REPORT, SUMMARY, spare_inputs,
};
use super::plotting::columns::{Columns, columns};
use super::snapshot::{FrameChoice, Snapshots};
use super::summary::{Measured, ProbeRange};
use super::verdict::{Farthest, Motion, Verdict};
use super::{
    Answers, Curve, HistoryWriter, McapWriter, RunFolder, StepOfCurve, SummaryFile, VtkHdfWriter,
    elevation, plot, usage,
};
use crate::deck::Deck;
use crate::files::{self, write_whole};
use crate::model::Model;
use crate::model::reactions;
use crate::solve::Checkpoint;
use crate::solve::Recorder;
use crate::state::EnergyBalance;
use crate::state::{Frame, HistoryRow, Summary};

/// Minimum time between checkpoints, as a multiple of the time that the last one took: checkpoints take at most 2 %
/// of the run.
const PATIENCE: u32 = 50;
/// Longest time that a due checkpoint waits for the next frame.
const LONGEST: Duration = Duration::from_secs(3);

/// Writes all results of a run: [`HISTORY`], [`FIELDS`] and [`MESSAGES`] during the run, the pictures and finally
/// [`SUMMARY`] at its end. A folder without a summary belongs to a run that is in progress, was killed or could not
/// write.
#[derive(Debug)]
pub struct RunDirectory {
    path: PathBuf,
    /// Holds the lock until the run ends.
    _lock: File,
    history: HistoryWriter,
    fields: FieldsBeside,
    messages: Option<McapWriter>,
    curve: Curve,
    /// Use of each step in the curve. `[step]`
    steps: Vec<StepOfCurve>,
    energy: EnergyBalance,
    probes: Vec<ProbeRange>,
    last_frame: Option<Arc<Frame>>,
    /// Index in the curve, and fields, of the largest force so far, while no frame shows it.
    peak: Option<(usize, Arc<Frame>)>,
    motion: Motion,
    deck: DeckCopy,
    spent: Spent,
    kept: Kept,
}

/// Deck as TOML and the folder of its files, for checkpoints.
#[derive(Debug, Default)]
struct DeckCopy {
    text: Option<String>,
    folder: Option<String>,
    way_to_folder: Option<String>,
}

/// Time spent on the run.
#[derive(Debug)]
struct Spent {
    started: Instant,
    cpu_at_start: Option<f64>,
    /// Wall-clock and CPU time of the run before it was resumed [s].
    wall_before: f64,
    cpu_before: Option<f64>,
}

/// The files that grow during a run.
#[derive(Debug)]
pub(super) struct Files {
    pub history: HistoryWriter,
    pub fields: VtkHdfWriter,
    pub messages: Option<McapWriter>,
}

/// State of the checkpoints.
#[derive(Debug)]
struct Kept {
    at: Option<Instant>,
    /// Time that the last one took.
    took: Duration,
    /// Whether a frame was written since.
    frame: bool,
}

impl Kept {
    fn nothing() -> Self {
        Self {
            at: None,
            took: Duration::ZERO,
            frame: false,
        }
    }

    fn is_due(&self) -> bool {
        self.at.is_none_or(|at| {
            let since = at.elapsed();
            since >= PATIENCE * self.took && (self.frame || since >= LONGEST)
        })
    }
}

impl RunDirectory {
    /// Creates the folder if necessary, removes the results of an earlier run from it and starts the files that grow.
    /// Other files in it are not touched.
    ///
    /// # Errors
    /// [`OutputError`]: the path is a file, or the folder cannot be created or written to.
    pub fn create(path: &Path, model: &Model) -> Result<Self, OutputError> {
        if path.exists() && !path.is_dir() {
            return Err(OutputError::NotADirectory(path.to_owned()));
        }
        std::fs::create_dir_all(path).map_err(|why| OutputError::Create {
            path: path.to_owned(),
            why,
        })?;
        let lock = lock(path)?;
        Self::begin(path, lock, model)
    }

    /// [`RunDirectory::create`] in a locked folder.
    pub(super) fn begin(path: &Path, lock: File, model: &Model) -> Result<Self, OutputError> {
        // The summary is removed first because it marks a complete folder.
        let unwanted = (!model.output.mcap).then_some(MESSAGES);
        let half = format!("{MESSAGES}.tmp");
        let names = [
            SUMMARY,
            LOAD_DISPLACEMENT,
            CRACK_PATTERN,
            CHECKPOINT,
            DECK,
            REPORT,
            FIELDS,
            INTERFACES,
            &half,
        ];
        let names: Vec<&str> = names.into_iter().chain(unwanted).collect();
        remove(path, &names)?;
        remove_companions(path)?;
        let files = Files {
            history: writing(path, HISTORY, |file| HistoryWriter::create(file, model))?,
            fields: writing(path, FIELDS, |file| VtkHdfWriter::create(file, model))?,
            messages: begin_messages(path, model)?,
        };
        Ok(Self::begun(path, lock, model, files))
    }

    /// [`RunDirectory::create`] for the model of a deck; stores a copy of the deck.
    ///
    /// # Errors
    /// The same, and [`OutputError::OverInput`]; the folder is unchanged then.
    pub fn of_deck(path: &Path, model: &Model, deck: &Deck) -> Result<Self, OutputError> {
        spare_inputs(path, OF_A_RUN, &deck.inputs())?;
        let mut run = Self::create(path, model)?;
        run.keep_deck(deck)?;
        Ok(run)
    }

    /// Directory with open files, which reach at least the checkpoint if a run continues.
    pub(super) fn begun(path: &Path, lock: File, model: &Model, files: Files) -> Self {
        let Files {
            history,
            fields,
            messages,
        } = files;
        Self {
            path: path.to_owned(),
            _lock: lock,
            history,
            fields: FieldsBeside::new(fields),
            messages,
            curve: Curve::default(),
            steps: StepOfCurve::all(model),
            energy: EnergyBalance::default(),
            probes: vec![ProbeRange::default(); model.columns().len()],
            last_frame: None,
            peak: None,
            motion: Motion::default(),
            deck: DeckCopy::default(),
            spent: Spent {
                started: Instant::now(),
                cpu_at_start: usage::cpu_seconds(),
                wall_before: 0.0,
                cpu_before: Some(0.0),
            },
            kept: Kept::nothing(),
        }
    }

    /// Continues after these rows and the last frame before the checkpoint.
    pub(super) fn resumed(
        mut self,
        (rows, last_frame): (&[HistoryRow], Option<Frame>),
        file: &CheckpointFile,
    ) -> Self {
        for row in rows {
            self.count(row);
        }
        self.last_frame = last_frame.map(Arc::new);
        let peak = file.peak.as_ref();
        self.peak = peak.map(|(index, fields)| (*index, Arc::new(fields.clone())));
        (self.spent.wall_before, self.spent.cpu_before) = (file.wall_s, file.cpu_s);
        self.deck.text.clone_from(&file.deck);
        self.deck.folder.clone_from(&file.deck_folder);
        self.deck.way_to_folder.clone_from(&file.way_to_deck_folder);
        self
    }

    /// Stores a copy of the deck with its overrides in the folder, in [`FIELDS`] and in [`MESSAGES`].
    ///
    /// # Errors
    /// [`OutputError::Write`].
    pub fn keep_deck(&mut self, deck: &Deck) -> Result<(), OutputError> {
        let text = writing(&self.path, DECK, |file| {
            let text = deck.to_toml().map_err(io::Error::other)?;
            write_whole(file, text.as_bytes()).map(|()| text)
        })?;
        writing(&self.path, FIELDS, |_| {
            self.fields.settled()?.keep_deck(&text)
        })?;
        let text_of =
            |path: Option<PathBuf>| path.and_then(|path| path.to_str().map(str::to_owned));
        let folder = Path::new(".").join(deck.folder());
        // Resolved without links: a relative link may point elsewhere after the project is moved.
        let ends = folder
            .canonicalize()
            .ok()
            .zip(self.path.canonicalize().ok());
        let way = ends.and_then(|(folder, run)| pathdiff::diff_paths(folder, run));
        self.deck.way_to_folder = text_of(way);
        self.deck.folder = text_of(std::path::absolute(folder).ok());
        // A resumed run with the same deck has it attached already.
        let new = self.deck.text.as_ref() != Some(&text);
        if let (Some(messages), true) = (&mut self.messages, new) {
            writing(&self.path, MESSAGES, |_| {
                messages.attach(DECK, "application/toml", &text)
            })?;
        }
        self.deck.text = Some(text);
        Ok(())
    }

    /// Path of the folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The load-displacement curve so far.
    pub fn curve(&self) -> &Curve {
        &self.curve
    }

    /// Adds a row to the quantities of the summary.
    fn count(&mut self, row: &HistoryRow) {
        let of = self.steps.get(row.step).copied().unwrap_or_default();
        self.curve.push(row, of);
        self.energy.push(row);
        self.motion = Motion::of(row);
        for (range, value) in self.probes.iter_mut().zip(&row.probes) {
            range.push(*value);
        }
    }

    /// Writes the fields of the largest force so far as a frame, if no frame shows it. It comes before the frame of a
    /// later increment, so that the frames are in the order of time.
    fn write_peak(&mut self) -> io::Result<()> {
        let Some((index, fields)) = self.peak.take() else {
            return Ok(());
        };
        if self.curve.peak().is_some_and(|peak| peak.index == index) {
            writing(&self.path, FIELDS, |_| self.fields.append(&fields))?;
            self.last_frame = Some(fields);
        }
        Ok(())
    }

    /// Wall-clock and CPU time of the run [s], with the time before it was resumed.
    fn times(&self) -> (f64, Option<f64>) {
        let wall = self.spent.wall_before + self.spent.started.elapsed().as_secs_f64();
        let cpu = usage::cpu_seconds().zip(self.spent.cpu_at_start);
        let cpu = cpu.zip(self.spent.cpu_before);
        (wall, cpu.map(|((now, then), before)| before + now - then))
    }

    /// Writes the pictures and then the summary, for every status of the run.
    ///
    /// # Errors
    /// [`OutputError::Write`]; no summary is written then.
    pub fn finish(
        mut self,
        model: &Model,
        run: &Summary,
        model_warnings: &[String],
    ) -> Result<SummaryFile, OutputError> {
        writing(&self.path.clone(), FIELDS, |_| self.write_peak())?;
        let (wall_s, cpu_s) = self.times();
        let Self {
            path,
            fields,
            messages,
            curve,
            energy,
            probes,
            last_frame,
            motion,
            // Held until all files are written.
            _lock,
            ..
        } = self;
        let frame = last_frame.as_deref();
        let farthest = frame.and_then(|frame| Farthest::of(model, frame));
        let verdict = Verdict::on(model, run, &curve, farthest.as_ref(), motion);
        writing(&path, FIELDS, |_| fields.finish())?;
        // Fields that cannot be read back leave out the answers that need them, and end no run.
        let frames = RunFolder::open(&path).and_then(|folder| Snapshots::open(&folder));
        // The folder of a program's own run may have no deck.
        let frames = frames.map(|frames| frames.of_model(model));
        let answers = Answers::of_run(model, run, &curve, frames.as_ref().ok());
        writing(&path, LOAD_DISPLACEMENT, |file| {
            let svg = picture_of(&path, model, &curve).map_err(io::Error::other)?;
            write_whole(file, svg.as_bytes())
        })?;
        if let Some(messages) = messages {
            writing(&path, MESSAGES, |_| {
                messages.finish(model, last_frame.as_deref(), run, model_warnings)
            })?;
        }
        if let Some(frame) = last_frame {
            let last = frames.ok().and_then(|f| f.at(FrameChoice::Last).ok());
            let svg = match last {
                Some(last) => elevation::crack_pattern_of(&last, Some(model)),
                None => elevation::crack_pattern(model, &frame),
            };
            writing(&path, CRACK_PATTERN, |file| {
                write_whole(file, svg.as_bytes())
            })?;
        }
        let columns = model.columns().into_iter();
        let ranges = columns.zip(probes.iter().copied());
        let ranges = ranges.filter(|(column, _)| !reactions::is_column(column));
        let summary = SummaryFile::new(
            run,
            &Measured {
                curve: &curve,
                verdict: &verdict,
                energy: &energy,
                answers: Some(&answers),
                probes: &ranges.collect(),
                wall_s,
                cpu_s,
                peak_rss_megabytes: usage::peak_memory_megabytes(),
                model_warnings,
                assumed: &model.assumed,
            },
        );
        writing(&path, SUMMARY, |file| summary.write(file))?;
        Ok(summary)
    }
}

/// The load-displacement curve, or the probes over time of a run without one.
fn picture_of(folder: &Path, model: &Model, curve: &Curve) -> Result<String, String> {
    if !curve.points().is_empty() {
        return plot::load_displacement(&model.title, curve);
    }
    let history = RunFolder::open(folder).and_then(|folder| folder.history());
    let picture = history.and_then(|history| {
        let runs = [("", &history)];
        columns(&model.title, &runs, &Columns::default())
    });
    picture.map_err(|error| error.to_string())
}

/// Starts [`MESSAGES`] and attaches the experiment named in the deck; `None` if the model asks for no messages.
pub(super) fn begin_messages(
    folder: &Path,
    model: &Model,
) -> Result<Option<McapWriter>, OutputError> {
    if !model.output.mcap {
        return Ok(None);
    }
    writing(folder, MESSAGES, |file| {
        let mut messages = McapWriter::create(file, model)?;
        if let Some(experiment) = &model.output.experiment {
            messages.attach(&experiment.file, "text/csv", &experiment.text)?;
        }
        Ok(Some(messages))
    })
}

/// Removes files from the folder together with their temporary versions, which a killed run leaves behind.
pub(super) fn remove(folder: &Path, names: &[&str]) -> Result<(), OutputError> {
    for name in names {
        for old in [folder.join(name), folder.join(format!("{name}.tmp"))] {
            files::remove(&old).map_err(|why| OutputError::Write { path: old, why })?;
        }
    }
    Ok(())
}

impl Recorder for RunDirectory {
    fn take(&mut self, model: &Model, row: &HistoryRow, frame: Option<&Frame>) -> io::Result<bool> {
        writing(&self.path, HISTORY, |_| self.history.append(row))?;
        self.count(row);
        writing(&self.path, FIELDS, |_| {
            self.fields.settled().map(|fields| fields.row(row))
        })?;
        if let Some(frame) = frame {
            self.write_peak()?;
            let frame = Arc::new(frame.clone());
            writing(&self.path, FIELDS, |_| self.fields.append(&frame))?;
            self.last_frame = Some(frame);
            self.kept.frame = true;
        }
        if let Some(messages) = &mut self.messages {
            writing(&self.path, MESSAGES, |_| {
                messages.increment(model, row, frame)
            })?;
        }
        Ok(true)
    }

    /// The fields of each largest force so far are kept, and written if the next frame lies lower.
    fn wants_fields(&self) -> bool {
        let last = self.curve.points().len().checked_sub(1);
        last.is_some() && self.curve.peak().map(|peak| peak.index) == last
    }

    fn keep(&mut self, _model: &Model, fields: Frame) {
        if let Some(last) = self.curve.points().len().checked_sub(1) {
            self.peak = Some((last, Arc::new(fields)));
        }
    }

    fn note(&mut self, text: &str) {
        if let Some(messages) = &mut self.messages {
            messages.note(text);
        }
    }

    fn progress(&mut self, step: usize, time: f64, iterations: usize) {
        if let Some(messages) = &mut self.messages {
            messages.progress(step, time, iterations);
        }
    }

    fn checkpoint(&mut self, last: bool, make: &dyn Fn() -> Checkpoint) -> io::Result<()> {
        if !last && !self.kept.is_due() {
            return Ok(());
        }
        let start = Instant::now();
        let (wall_s, cpu_s) = self.times();
        // Rows, frames and messages must be on the disk before the checkpoint that refers to them.
        writing(&self.path, HISTORY, |_| self.history.sync())?;
        let frames = writing(&self.path, FIELDS, |_| {
            let fields = self.fields.settled()?;
            fields.publish()?;
            Ok(fields.steps())
        })?;
        let messages = match &mut self.messages {
            Some(messages) => Some(writing(&self.path, MESSAGES, |_| messages.mark())?),
            None => None,
        };
        let file = CheckpointFile {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            deck: self.deck.text.clone(),
            deck_folder: self.deck.folder.clone(),
            way_to_deck_folder: self.deck.way_to_folder.clone(),
            history: self.history.extent(),
            frames,
            messages,
            wall_s,
            cpu_s,
            peak: self
                .peak
                .as_ref()
                .map(|(index, fields)| (*index, fields.as_ref().clone())),
            solver: make(),
        };
        writing(&self.path, CHECKPOINT, |path| file.write(path))?;
        self.kept = Kept {
            at: Some(Instant::now()),
            took: start.elapsed(),
            frame: false,
        };
        Ok(())
    }
}

#[cfg(test)]
mod tests;
