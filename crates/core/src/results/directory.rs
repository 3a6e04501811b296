//! The folder of a run.

use std::io;
use std::path::{Path, PathBuf};
use std::time::Instant;

use miette::Diagnostic;

use super::summary::{EnergyBalance, Measured, ProbeRange, write_whole};
use super::{
    Curve, Frame, HistoryRow, HistoryWriter, McapWriter, Recorder, Summary, SummaryFile,
    VtkHdfWriter, elevation, plot, usage,
};
use crate::model::scene::{BeamMotion, Step};
use crate::model::{Deck, Model};

/// Name of the history in the folder.
pub const HISTORY: &str = "history.csv";
/// Name of the deck's copy in the folder.
pub const DECK: &str = "model.toml";
/// Name of the fields in the folder.
pub const FIELDS: &str = "results.vtkhdf";
/// Name of what shows the interfaces of the fields in the folder.
pub const INTERFACES: &str = "results.interfaces.vtkhdf";
/// Name of the messages in the folder.
pub const MESSAGES: &str = "run.mcap";
/// Name of the summary in the folder.
pub const SUMMARY: &str = "summary.json";
/// Name of the load-displacement curve in the folder.
pub const LOAD_DISPLACEMENT: &str = "load_displacement.svg";
/// Name of the elevation in the folder.
pub const CRACK_PATTERN: &str = "crack_pattern.svg";
/// Name of the report in the folder, unless it is written elsewhere.
pub const REPORT: &str = "report.html";

/// Results that could not be written.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum OutputError {
    /// Where the folder should be there is a file.
    #[error("{}: this is a file, but the results need a folder", .0.display())]
    #[diagnostic(help("name another folder for the results, or move the file away"))]
    NotADirectory(PathBuf),
    /// The folder could not be made.
    #[error("{}: the folder for the results cannot be created: {why}", path.display())]
    #[diagnostic(help("check the permissions of the folder above it, or name another one"))]
    Create {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        why: io::Error,
    },
    /// A file could not be written.
    #[error("{}: cannot be written: {why}", path.display())]
    #[diagnostic(help(
        "check the free space of the disk and the permissions of the folder; a folder without \
         summary.json is not whole"
    ))]
    Write {
        /// The file.
        path: PathBuf,
        /// What the system says.
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

/// Writes everything that a run leaves behind: [`HISTORY`], [`FIELDS`] and [`MESSAGES`] as the increments come,
/// the pictures and last of all [`SUMMARY`] at the end. A folder without a summary is that of a run
/// which goes on, was killed, or could not write.
#[derive(Debug)]
pub struct RunDirectory {
    path: PathBuf,
    history: HistoryWriter,
    fields: VtkHdfWriter,
    messages: Option<McapWriter>,
    curve: Curve,
    energy: EnergyBalance,
    probes: Vec<ProbeRange>,
    last_frame: Option<Frame>,
    started: Instant,
    cpu_at_start: Option<f64>,
}

impl RunDirectory {
    /// Makes the folder if need be, removes the results of an earlier run from it, and begins the
    /// files that grow. Other files in it are left alone.
    ///
    /// # Errors
    /// [`OutputError`]: there is a file of that name, or it cannot be made or written in.
    pub fn create(path: &Path, model: &Model) -> Result<Self, OutputError> {
        if path.exists() && !path.is_dir() {
            return Err(OutputError::NotADirectory(path.to_owned()));
        }
        std::fs::create_dir_all(path).map_err(|why| OutputError::Create {
            path: path.to_owned(),
            why,
        })?;
        // The summary goes first: it says that the rest is whole.
        let unwanted = (!model.output.mcap).then_some(MESSAGES);
        let names = [
            SUMMARY,
            LOAD_DISPLACEMENT,
            CRACK_PATTERN,
            DECK,
            REPORT,
            FIELDS,
            INTERFACES,
        ];
        for name in names.into_iter().chain(unwanted) {
            let old = path.join(name);
            match std::fs::remove_file(&old) {
                Err(why) if why.kind() != io::ErrorKind::NotFound => {
                    return Err(OutputError::Write { path: old, why });
                }
                _ => {}
            }
        }
        let history = writing(path, HISTORY, |file| HistoryWriter::create(file, model))?;
        let fields = writing(path, FIELDS, |file| VtkHdfWriter::create(file, model))?;
        let messages = begin_messages(path, model)?;
        Ok(Self {
            path: path.to_owned(),
            history,
            fields,
            messages,
            curve: Curve::default(),
            energy: EnergyBalance::default(),
            probes: vec![ProbeRange::default(); model.probes.len()],
            last_frame: None,
            started: Instant::now(),
            cpu_at_start: usage::cpu_seconds(),
        })
    }

    /// Keeps a copy of the deck, overrides taken in, beside the results and in [`FIELDS`] and [`MESSAGES`].
    ///
    /// # Errors
    /// [`OutputError::Write`].
    pub fn keep_deck(&mut self, deck: &Deck) -> Result<(), OutputError> {
        let text = writing(&self.path, DECK, |file| {
            let text = deck.to_toml().map_err(io::Error::other)?;
            write_whole(file, text.as_bytes()).map(|()| text)
        })?;
        writing(&self.path, FIELDS, |_| self.fields.keep_deck(&text))?;
        let Some(messages) = &mut self.messages else {
            return Ok(());
        };
        writing(&self.path, MESSAGES, |_| {
            messages.attach(DECK, "application/toml", &text)
        })
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The load-displacement curve so far.
    pub fn curve(&self) -> &Curve {
        &self.curve
    }

    /// Writes the pictures and then the summary, whichever way the run ended.
    ///
    /// # Errors
    /// [`OutputError::Write`]; there is no summary then.
    pub fn finish(
        self,
        model: &Model,
        run: &Summary,
        model_warnings: &[String],
    ) -> Result<SummaryFile, OutputError> {
        let Self {
            path,
            fields,
            messages,
            curve,
            energy,
            probes,
            last_frame,
            started,
            cpu_at_start,
            ..
        } = self;
        writing(&path, FIELDS, |_| fields.finish())?;
        writing(&path, LOAD_DISPLACEMENT, |file| {
            let svg = plot::load_displacement(&model.title, &curve).map_err(io::Error::other)?;
            write_whole(file, svg.as_bytes())
        })?;
        if let Some(messages) = messages {
            writing(&path, MESSAGES, |_| {
                messages.finish(model, last_frame.as_ref(), run, model_warnings)
            })?;
        }
        if let Some(frame) = last_frame {
            let svg = elevation::crack_pattern(model, &frame);
            writing(&path, CRACK_PATTERN, |file| {
                write_whole(file, svg.as_bytes())
            })?;
        }
        let columns = model.probes.iter().map(|p| p.column.clone());
        let cpu_now = usage::cpu_seconds();
        let summary = SummaryFile::new(
            run,
            &Measured {
                curve: &curve,
                energy: &energy,
                probes: &columns.zip(probes).collect(),
                wall_s: started.elapsed().as_secs_f64(),
                cpu_s: cpu_now.zip(cpu_at_start).map(|(now, then)| now - then),
                peak_rss_megabytes: usage::peak_memory_megabytes(),
                model_warnings,
            },
        );
        writing(&path, SUMMARY, |file| summary.write(file))?;
        Ok(summary)
    }
}

/// Begins [`MESSAGES`], with the experiment that the deck names; none if it wants none.
fn begin_messages(folder: &Path, model: &Model) -> Result<Option<McapWriter>, OutputError> {
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

/// Does something to a file of the folder and names the file if it fails.
fn writing<T>(
    folder: &Path,
    name: &str,
    write: impl FnOnce(&Path) -> io::Result<T>,
) -> Result<T, OutputError> {
    let path = folder.join(name);
    write(&path).map_err(|why| OutputError::Write { path, why })
}

/// A step drives if its beam moves. A preload merely names the direction in which it is told.
fn drives(step: &Step) -> bool {
    step.driven.is_some_and(|(beam, direction)| {
        matches!(step.motion[beam][direction], BeamMotion::Driven(_))
    })
}

impl Recorder for RunDirectory {
    fn take(&mut self, model: &Model, row: &HistoryRow, frame: Option<&Frame>) -> io::Result<bool> {
        let Self {
            path,
            history,
            fields,
            messages,
            ..
        } = self;
        writing(path, HISTORY, |_| history.append(row))?;
        self.curve
            .push(row, model.steps.get(row.step).is_some_and(drives));
        self.energy.push(row);
        for (range, value) in self.probes.iter_mut().zip(&row.probes) {
            range.push(*value);
        }
        fields.row(row);
        if let Some(frame) = frame {
            writing(path, FIELDS, |_| fields.append(frame))?;
            self.last_frame = Some(frame.clone());
        }
        if let Some(messages) = messages {
            writing(path, MESSAGES, |_| messages.increment(model, row, frame))?;
        }
        Ok(true)
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::{Status, fake};

    const WORK: &str = "results.vtkhdf.part";

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn a_run_leaves_its_files_and_the_summary_last() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/wall.out");
        let model = fake::model();
        let mut run = RunDirectory::create(&path, &model).unwrap();
        assert!(run.take(&model, &fake::row(1, 0, 0.0, 0.0), None).unwrap());
        for (i, (d, f)) in [(1.0, 10.0), (2.0, 20.0), (3.0, 10.0)]
            .into_iter()
            .enumerate()
        {
            let frame = fake::frame(&model, d);
            assert!(
                run.take(&model, &fake::row(i + 2, 1, d, f), Some(&frame))
                    .unwrap()
            );
            assert_eq!(
                names(&path),
                [HISTORY, FIELDS, WORK, MESSAGES],
                "nothing that says whole while it runs"
            );
        }
        let summary = run
            .finish(&model, &fake::summary(Status::Completed), &[])
            .unwrap();
        assert_eq!(
            names(&path),
            [
                CRACK_PATTERN,
                HISTORY,
                LOAD_DISPLACEMENT,
                FIELDS,
                MESSAGES,
                SUMMARY
            ]
        );
        assert_eq!(summary.peak_force_kN, Some(20.0));
        assert_eq!(summary.displacement_at_80_percent_mm, Some(2.4));
        assert_eq!(summary.initial_stiffness_kN_per_mm, Some(10.0));
        let history = std::fs::read_to_string(path.join(HISTORY)).unwrap();
        assert_eq!(history.lines().count(), 5);

        // The next run into the same folder begins by removing what says "whole".
        std::fs::write(path.join("notes.txt"), "mine").unwrap();
        let _next = RunDirectory::create(&path, &model).unwrap();
        assert_eq!(names(&path), [HISTORY, "notes.txt", FIELDS, WORK, MESSAGES]);
        let header_only = std::fs::read_to_string(path.join(HISTORY)).unwrap();
        assert_eq!(header_only.lines().count(), 1);
    }

    #[test]
    fn a_file_in_the_way_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("wall.out");
        std::fs::write(&path, "mine").unwrap();
        let error = RunDirectory::create(&path, &fake::model()).unwrap_err();
        assert!(matches!(&error, OutputError::NotADirectory(p) if *p == path));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
        let below = RunDirectory::create(&path.join("below"), &fake::model()).unwrap_err();
        assert!(matches!(below, OutputError::Create { .. }));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_met_before_the_run_and_names_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let model = fake::model();
        let history = folder.path().join(HISTORY);
        std::os::unix::fs::symlink("/dev/full", &history).unwrap();
        let error = io::Error::from(RunDirectory::create(folder.path(), &model).unwrap_err());
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        assert!(error.to_string().contains(HISTORY), "{error}");
        assert_eq!(names(folder.path()), [HISTORY]);
    }
    #[test]
    #[cfg(target_os = "linux")]
    fn messages_that_cannot_be_written_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let model = fake::model();
        let messages = folder.path().join(MESSAGES);
        std::os::unix::fs::symlink("/dev/full", &messages).unwrap();
        let error = io::Error::from(RunDirectory::create(folder.path(), &model).unwrap_err());
        assert_eq!(error.kind(), io::ErrorKind::StorageFull);
        assert!(error.to_string().contains(MESSAGES), "{error}");
    }

    #[test]
    fn messages_that_are_not_wanted_are_not_there() {
        let folder = tempfile::tempdir().unwrap();
        let mut model = fake::model();
        drop(RunDirectory::create(folder.path(), &model).unwrap());
        model.output.mcap = false;
        let mut run = RunDirectory::create(folder.path(), &model).unwrap();
        run.note("nobody hears");
        run.progress(0, 0.0, 1);
        assert_eq!(names(folder.path()), [HISTORY, FIELDS, WORK]);
    }
}
