//! Readers of the files in a run folder: history, summary, deck, fields.

use std::io;
use std::path::{Path, PathBuf};

use miette::Diagnostic;

use super::checkpoint::CheckpointFile;
use super::comparison::clear_height;
use super::output::{CHECKPOINT, DECK, FIELDS, HISTORY, SUMMARY};
use super::vtkhdf::read::FieldsFile;
use super::{Answers, Curve, StepOfCurve, SummaryFile};
use crate::deck::Deck;
use crate::files;
use crate::model::Model;
use crate::model::columns::FIXED;
use crate::state::{ForceBy, HistoryRow, Method};

/// Largest size of a text file that is read [byte]. Ten million rows of a history take less.
const MOST_TEXT: u64 = 1 << 32;

/// Errors of reading results.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum ReadError {
    /// The path is not a run folder.
    #[error("{}: no results of a run: there is no {HISTORY}", .0.display())]
    #[diagnostic(help(
        "name the folder that a run wrote, MODEL.out beside the model unless --out said otherwise"
    ))]
    NoRun(PathBuf),
    /// A file cannot be read.
    #[error("{}: cannot be read: {why}", path.display())]
    #[diagnostic(help("check that the file is there and whole, and that you may read it"))]
    Read {
        /// The file.
        path: PathBuf,
        /// Message of the system or of HDF5.
        why: io::Error,
    },
    /// A requested frame does not exist.
    #[error("{}: there is no frame {asked}: {}", path.display(), frames(*count))]
    #[diagnostic(help("frames count from 0, as in ParaView; or say `peak` or `last`"))]
    NoFrame {
        /// The file.
        path: PathBuf,
        /// The requested frame.
        asked: String,
        /// Number of frames in the file.
        count: usize,
    },
    /// The history has no such column of numbers.
    #[error("the history has no column `{name}` of numbers")]
    #[diagnostic(help("{advice}"))]
    NoColumn {
        /// The requested name.
        name: String,
        /// The nearest name, or all names.
        advice: String,
    },
    /// A section does not meet the model.
    #[error("no part of the model lies at {axis} = {at} mm")]
    #[diagnostic(help("the model reaches from {axis} = {low} to {high} mm"))]
    NoSection {
        /// `x`, `y` or `z`.
        axis: &'static str,
        /// The requested position [mm].
        at: f64,
        /// Smallest coordinate [mm].
        low: f64,
        /// Largest coordinate [mm].
        high: f64,
    },
    /// A picture cannot be drawn.
    #[error("the picture cannot be drawn: {0}")]
    #[diagnostic(help("look for values in history.csv that are not finite"))]
    Undrawn(String),
    /// A file has unexpected content.
    #[error("{}{}: {why}", path.display(), line.map_or(String::new(), |l| format!(":{l}")))]
    #[diagnostic(help("the file was changed, or written by another version of wythe"))]
    Content {
        /// The file.
        path: PathBuf,
        /// Line from 1, if one is at fault.
        line: Option<u64>,
        /// Description of the fault.
        why: String,
    },
}

/// Message on the available frames.
fn frames(count: usize) -> String {
    match count.checked_sub(1) {
        None => "the run has written none yet".to_owned(),
        Some(last) => format!("the file has 0 to {last}"),
    }
}

/// Content of `history.csv`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadHistory {
    /// Rows, one per increment.
    pub rows: Vec<HistoryRow>,
    /// Names of the probe columns.
    pub probes: Vec<String>,
    /// Use of each step in the load-displacement curve; `None` if the folder has no deck. `[step]`
    pub steps: Option<Vec<StepOfCurve>>,
}

impl ReadHistory {
    /// Whether each row belongs to a driven step. Without a deck, a step counts as driven if its displacement
    /// changes. `[row]`
    pub fn driven(&self) -> Vec<bool> {
        if let Some(steps) = &self.steps {
            let of = |row: &HistoryRow| steps.get(row.step).is_some_and(|of| of.driven);
            return self.rows.iter().map(of).collect();
        }
        let mut driven = Vec::with_capacity(self.rows.len());
        let mut before = 0.0;
        for step in self.rows.chunk_by(|a, b| a.step == b.step) {
            let moves = step.iter().any(|r| r.displacement_mm != before);
            driven.extend(step.iter().map(|_| moves));
            before = step.last().map_or(before, |r| r.displacement_mm);
        }
        driven
    }

    /// Load-displacement curve of the driven steps. Without a deck, a step that is not solved with inertia as a whole
    /// seeks equilibria.
    pub fn curve(&self) -> Curve {
        let mut curve = Curve::default();
        let steps = self.steps.as_deref().unwrap_or_default();
        let mut driven = self.driven().into_iter();
        for rows in self.rows.chunk_by(|a, b| a.step == b.step) {
            let seeks = rows.iter().any(|r| r.procedure != Method::QuasiStatic);
            let unknown = StepOfCurve {
                inertia: if seeks {
                    ForceBy::Drive
                } else {
                    ForceBy::Equilibrium
                },
                ..StepOfCurve::default()
            };
            let of = steps.get(rows[0].step).copied().unwrap_or(unknown);
            for (row, driven) in rows.iter().zip(&mut driven) {
                curve.push(row, StepOfCurve { driven, ..of });
            }
        }
        curve
    }

    /// Step time of the largest force of the curve [s]; `None` if nothing was driven.
    pub fn time_of_peak(&self) -> Option<f64> {
        let peak = self.curve().peak()?;
        let here =
            |r: &&HistoryRow| r.displacement_mm == peak.displacement && r.force_kN == peak.force;
        self.rows.iter().find(here).map(|r| r.time)
    }
}

/// Folder of a run that has ended, is still running or was killed.
#[derive(Clone, Debug)]
pub struct RunFolder {
    path: PathBuf,
}

impl RunFolder {
    /// Opens a folder that has a history.
    ///
    /// # Errors
    /// [`ReadError::NoRun`] if it has none.
    pub fn open(path: &Path) -> Result<Self, ReadError> {
        if path.join(HISTORY).is_file() {
            Ok(Self {
                path: path.to_owned(),
            })
        } else {
            Err(ReadError::NoRun(path.to_owned()))
        }
    }

    /// The folder.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// All complete rows of the history.
    ///
    /// # Errors
    /// The file cannot be read or has unexpected content.
    pub fn history(&self) -> Result<ReadHistory, ReadError> {
        let path = self.path.join(HISTORY);
        let text = files::read(&path, MOST_TEXT).map_err(|why| ReadError::Read {
            path: path.clone(),
            why,
        })?;
        Ok(ReadHistory {
            steps: self.deck()?.and_then(|deck| steps_of_curve(&deck)),
            ..read_history(&path, &text)?
        })
    }

    /// The summary; `None` if the run has not ended, was killed or could not write.
    ///
    /// # Errors
    /// The file cannot be read or has unexpected content.
    pub fn summary(&self) -> Result<Option<SummaryFile>, ReadError> {
        let path = self.path.join(SUMMARY);
        let Some(text) = read_if_there(&path)? else {
            return Ok(None);
        };
        serde_json::from_str(&text)
            .map(Some)
            .map_err(|e| ReadError::Content {
                path,
                line: Some(e.line() as u64),
                why: e.to_string(),
            })
    }

    /// The answers of the run. Without a summary that has them they are those of the curve, with the clear height of
    /// the deck in the folder.
    ///
    /// # Errors
    /// The history or the summary cannot be read.
    pub fn answers(&self) -> Result<Answers, ReadError> {
        if let Some(answers) = self.summary()?.and_then(|summary| summary.answers) {
            return Ok(answers);
        }
        Ok(Answers::of_curve(
            &self.history()?.curve(),
            self.clear_height(),
        ))
    }

    /// Clear height of the model of the run [mm]; `None` if it has none, or if its deck cannot be read any more.
    pub fn clear_height(&self) -> Option<f64> {
        clear_height(&self.model()?)
    }

    /// Model of the run; `None` if its deck, or a file that it names, cannot be read any more.
    pub fn model(&self) -> Option<Model> {
        let deck = Deck::load(self.path.join(DECK), &[]).ok()?;
        let (model, _) = Model::from_deck(&self.place(deck)).ok()?;
        Some(model)
    }

    /// The deck of the run with its overrides; `None` if the folder has no copy.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn deck(&self) -> Result<Option<String>, ReadError> {
        read_if_there(&self.path.join(DECK))
    }

    /// Sets the folder in which the files named by a deck are looked up. The checkpoint knows it, and also finds the
    /// files if the whole project was moved. Without a checkpoint it is the run folder.
    pub fn place(&self, deck: Deck) -> Deck {
        match CheckpointFile::read(&self.path.join(CHECKPOINT)) {
            Ok(file) => file.place(&self.path, deck),
            Err(_) => deck.in_folder(self.path.clone()),
        }
    }

    /// The field file; data sets are read on request.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn fields(&self) -> Result<FieldsFile, ReadError> {
        let path = self.path.join(FIELDS);
        FieldsFile::open(&path).map_err(|why| ReadError::Read { path, why })
    }
}

/// Parses all complete rows of a history; `path` is used in errors only.
///
/// # Errors
/// The text has unexpected content.
pub(super) fn read_history(path: &Path, text: &[u8]) -> Result<ReadHistory, ReadError> {
    let content = |line: Option<u64>, why: String| ReadError::Content {
        path: path.to_owned(),
        line,
        why,
    };
    // The last row lacks its line break if the disk was full or the run was killed while writing.
    let whole = text
        .iter()
        .rposition(|b| *b == b'\n')
        .map_or(0, |end| end + 1);
    let mut reader = csv::Reader::from_reader(&text[..whole]);
    let header = reader
        .headers()
        .map_err(|e| content(Some(1), e.to_string()))?;
    if header.len() < FIXED.len() || !header.iter().zip(FIXED).all(|(a, b)| a == b) {
        return Err(content(
            Some(1),
            "the columns are not those of a history".to_owned(),
        ));
    }
    let probes = header.iter().skip(FIXED.len()).map(str::to_owned).collect();
    let header = header
        .iter()
        .take(FIXED.len())
        .collect::<csv::StringRecord>();
    let mut history = ReadHistory {
        rows: Vec::new(),
        probes,
        steps: None,
    };
    for record in reader.records() {
        let record =
            record.map_err(|e| content(e.position().map(csv::Position::line), e.to_string()))?;
        let line = record.position().map(csv::Position::line);
        let first: csv::StringRecord = record.iter().take(FIXED.len()).collect();
        let mut row: HistoryRow = first
            .deserialize(Some(&header))
            .map_err(|e| content(line, e.to_string()))?;
        for value in record.iter().skip(FIXED.len()) {
            let value = value
                .parse()
                .map_err(|_| content(line, format!("{value} is no number")))?;
            row.probes.push(value);
        }
        history.rows.push(row);
    }
    Ok(history)
}

/// Use of each step of a deck in the load-displacement curve, as [`Model::parts_in_curve`](crate::model::Model) has it.
/// `[step]`
fn steps_of_curve(deck: &str) -> Option<Vec<StepOfCurve>> {
    let deck: toml::Table = deck.parse().ok()?;
    let steps = deck.get("steps")?.as_array()?;
    let text = |step: &toml::Value, key: &str| step.get(key).map(ToString::to_string);
    let drives =
        |step: &toml::Value| step.get("kind").and_then(toml::Value::as_str) == Some("drive");
    // The same face, beam or spring along the same line.
    let drive = |step: &toml::Value| {
        let line = text(step, "direction").map(|direction| direction.replace('-', ""));
        drives(step).then(|| (["face", "beam", "spring"].map(|key| text(step, key)), line))
    };
    let loads = |step: &toml::Value| -> Vec<String> {
        let loads = step.get("loads").and_then(toml::Value::as_array);
        let names = loads.into_iter().flatten();
        names.filter_map(|load| text(load, "name")).collect()
    };
    let is_path = |step: &toml::Value| {
        let procedure = step.get("procedure").and_then(toml::Value::as_str);
        step.get("control").is_some()
            || procedure.is_some_and(|name| ["arc_length", "dissipation"].contains(&name))
    };
    let any = steps.iter().any(drives);
    let last = steps.iter().rev().find_map(drive);
    let first_load = |step: &toml::Value| loads(step).into_iter().next();
    let steered = steps
        .iter()
        .rev()
        .filter(|step| is_path(step))
        .find_map(first_load);
    let live = steered.or_else(|| steps.iter().rev().find_map(first_load));
    // The increments of a preload before the drive of a spring show the face that it presses.
    let by_spring = last
        .as_ref()
        .is_some_and(|([.., spring], _)| spring.is_some());
    let presses = |step: &toml::Value| {
        let kind = step.get("kind").and_then(toml::Value::as_str);
        by_spring && kind == Some("preload")
    };
    let is_other = |step: &toml::Value| {
        if drives(step) {
            drive(step) != last
        } else {
            presses(step)
        }
    };
    let another = steps.iter().any(is_other);
    let of = |step: &toml::Value| StepOfCurve {
        driven: if any {
            drives(step) && drive(step) == last
        } else {
            live.as_ref().is_some_and(|live| loads(step).contains(live))
        },
        other: another && drive(step) != last,
        inertia: force_by(step, drives(step)),
    };
    Some(steps.iter().map(of).collect())
}

/// Origin of the force in increments with inertia of a step of a deck.
fn force_by(step: &toml::Value, drives: bool) -> ForceBy {
    let procedure = step.get("procedure").and_then(toml::Value::as_str);
    match procedure.unwrap_or("auto") {
        "auto" | "displacement_control" if drives || step.get("control").is_some() => {
            ForceBy::Drive
        }
        "auto" | "displacement_control" => ForceBy::Loads,
        _ => ForceBy::Equilibrium,
    }
}

fn read_if_there(path: &Path) -> Result<Option<String>, ReadError> {
    match files::read_text(path, MOST_TEXT) {
        Ok(text) => Ok(Some(text)),
        Err(why) if why.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(why) => Err(ReadError::Read {
            path: path.to_owned(),
            why,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::{RunDirectory, fake};
    use crate::solve::Recorder;
    use crate::state::Status;

    #[test]
    fn a_folder_reads_back_what_was_recorded() {
        let folder = tempfile::tempdir().unwrap();
        let model = fake::model();
        let mut run = RunDirectory::create(folder.path(), &model).unwrap();
        let rows: Vec<HistoryRow> = [(0, 0.0, 0.0), (1, 1.0, 1.0 / 3.0), (1, 2.0, 20.0)]
            .into_iter()
            .enumerate()
            .map(|(i, (step, d, f))| fake::row(i + 1, step, d, f))
            .collect();
        for row in &rows {
            run.take(&model, row, Some(&fake::frame(&model, row.displacement_mm)))
                .unwrap();
        }
        let open = RunFolder::open(folder.path()).unwrap();
        assert!(open.summary().unwrap().is_none());
        let written = run.curve().clone();
        run.finish(&model, &fake::summary(Status::Completed), &[])
            .unwrap();
        let history = open.history().unwrap();
        assert_eq!(history.rows, rows);
        assert_eq!(history.curve(), written);
        assert_eq!(open.summary().unwrap().unwrap().peak_force_kN, Some(20.0));
        assert_eq!(open.fields().unwrap().times().len(), 3);
        assert_eq!(open.deck().unwrap(), None);
    }

    #[test]
    fn without_a_deck_a_force_that_inertia_carries_is_no_peak() {
        let row = |displacement: f64, force: f64, procedure| HistoryRow {
            displacement_mm: displacement,
            force_kN: force,
            procedure,
            kinetic_energy_J: if procedure == Method::Static {
                0.0
            } else {
                5.0
            },
            ..HistoryRow::default()
        };
        let rows = vec![
            row(1.0, 80.0, Method::Static),
            row(1.1, 160.0, Method::QuasiStatic),
            row(1.2, 70.0, Method::Static),
        ];
        let history = ReadHistory {
            rows: rows.clone(),
            ..ReadHistory::default()
        };
        assert_eq!(history.curve().peak().unwrap().force, 80.0);
        // Where the deck names inertia as the procedure, its forces are the result.
        let history = ReadHistory {
            rows: vec![rows[1].clone()],
            ..ReadHistory::default()
        };
        assert_eq!(history.curve().peak().unwrap().force, 160.0);
    }

    #[test]
    fn an_incomplete_row_is_omitted_and_errors_are_reported_with_their_line() {
        let folder = tempfile::tempdir().unwrap();
        assert!(matches!(
            RunFolder::open(folder.path()),
            Err(ReadError::NoRun(_))
        ));
        let model = fake::model();
        let mut run = RunDirectory::create(folder.path(), &model).unwrap();
        run.take(&model, &fake::row(1, 1, 1.0, 1.0), None).unwrap();
        drop(run);
        let path = folder.path().join(HISTORY);
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, format!("{text}2,1,0.5")).unwrap();
        let open = RunFolder::open(folder.path()).unwrap();
        assert_eq!(open.history().unwrap().rows.len(), 1);
        std::fs::write(&path, text.replace("\n1,1,", "\n1,one,")).unwrap();
        let error = open.history().unwrap_err().to_string();
        assert!(error.contains("history.csv:2"), "{error}");
    }
}
