//! `report.html`: a run on one self-contained page that needs neither a network nor another program.
//!
//! ```text
//! history.csv ──▶ series ───────────────────────┐
//! results.vtkhdf ──▶ boundary facets ──▶ view ──┤ base64 in JSON
//! summary.json ──▶ figures ─────────────────────┼──▶ page.html + style.css + view.js, charts.js, page.js
//! model.toml, log, warnings ──▶ escaped text ───┘      ──▶ report.html
//! ```
//!
//! The page has only the boundary facets of the solids, with displacements in 16 bits and damage in 8 bits. Frames
//! are omitted, with a note, if the page would exceed [`LIMIT`], of large scenes [`LARGEST`]. An incomplete folder (without a summary, fields or a
//! drive) gives a page with the available parts.

mod figures;
mod marks;
mod packed;
mod page;
mod series;
mod skin;
mod view;

use std::io;
use std::path::Path;

use serde::Serialize;

use super::colours::Table;
use super::estimate::ErrorEstimate;
use super::{Answers, Experiment, ReadError, ReadHistory, RunFolder, SummaryFile};
use crate::files::write_whole;
use crate::model::Model;
use crate::state::{HistoryRow, Status};
use marks::Mark;
use page::{escape, escape_json, fill};
use series::Series;
use view::{Scene, View};

/// Size of the page up to which frames are added [byte].
pub const LIMIT: usize = 2_000_000;
/// The same for scenes of which fewer than twelve frames would fit [byte]. Browsers open such a page within seconds.
pub const LARGEST: usize = 16_000_000;
/// Number of frames that show how a wall moves.
const FRAMES: usize = 12;

const PAGE: &str = include_str!("assets/page.html");
const STYLE: &str = include_str!("assets/style.css");
const SCRIPTS: [&str; 3] = [
    include_str!("assets/view.js"),
    include_str!("assets/charts.js"),
    include_str!("assets/page.js"),
];

/// Page that lists the errors of a deck.
const FAILED: &str = include_str!("assets/failed.html");
/// Script of a page that is served while the run goes on.
const LIVE: &str = include_str!("assets/live.js");

/// A run on one page.
#[derive(Clone, Debug)]
pub struct Report {
    /// The page.
    pub html: String,
    /// Number of frames on the page.
    pub frames: usize,
    /// Number of frames of the run.
    pub frames_of_run: usize,
    /// Notes on the page about missing or omitted parts.
    pub notes: Vec<String>,
}

/// Data of the page.
#[derive(Serialize)]
struct Data<'a> {
    colours: Table,
    series: Series,
    experiment: Option<Measured<'a>>,
    view: Option<View>,
}

#[derive(Serialize)]
struct Measured<'a> {
    name: &'a str,
    points: &'a [(f64, f64)],
}

impl<'a> Measured<'a> {
    fn of(experiment: &'a Experiment) -> Self {
        let Experiment { name, points, .. } = experiment;
        Self { name, points }
    }
}

impl Report {
    /// Creates the page of a folder, whose run may have ended, be in progress or have been killed.
    ///
    /// # Errors
    /// The history cannot be read. Other missing or damaged files are noted on the page.
    pub fn of(folder: &RunFolder, experiment: Option<&Experiment>) -> Result<Self, ReadError> {
        Self::between(folder, experiment, [LIMIT, LARGEST], &[])
    }

    /// The page of a folder without increments, with supports, drives and loads of its model below the pointer.
    ///
    /// # Errors
    /// As for [`Report::of`].
    pub fn at_rest(folder: &RunFolder, model: &Model) -> Result<Self, ReadError> {
        Self::between(folder, None, [LIMIT, LARGEST], &Mark::all(model))
    }

    /// [`Report::of`] with another limit for the size of the page [byte].
    ///
    /// # Errors
    /// As for [`Report::of`].
    pub fn within(
        folder: &RunFolder,
        experiment: Option<&Experiment>,
        limit: usize,
    ) -> Result<Self, ReadError> {
        Self::between(folder, experiment, [limit, limit], &[])
    }

    /// A page of at most `limit`, or of at most `largest` with at most [`FRAMES`] frames [byte].
    fn between(
        folder: &RunFolder,
        experiment: Option<&Experiment>,
        [limit, largest]: [usize; 2],
        marks: &[Mark],
    ) -> Result<Self, ReadError> {
        let history = folder.history()?;
        let mut notes = Vec::new();
        let summary = or_note(folder.summary(), &mut notes).flatten();
        let deck = or_note(folder.deck(), &mut notes).flatten();
        let fields = or_note(folder.fields(), &mut notes);
        let scene = fields.as_ref().and_then(|file| {
            let scene = Scene::open(file, marks, &mut notes);
            or_note(
                scene.map_err(|why| fields_unread(file.path(), why)),
                &mut notes,
            )
        });
        let driven = history.driven();
        let peak = series::peak_row(&history, &driven);
        let times = fields.as_ref().map_or(&[][..], |file| file.times());
        let row_of_frame: Vec<usize> = times.iter().map(|t| nearest(&history.rows, *t)).collect();
        let mut rows = series::chosen(history.rows.len(), row_of_frame.iter().copied().chain(peak));
        rows.dedup();
        notes.extend(some_of(rows.len(), history.rows.len(), |some, all| {
            format!("The charts show {some} of {all} increments.")
        }));
        let title = title(folder, deck.as_deref(), fields.as_ref());
        let mut data = Data {
            colours: Table::new(),
            series: Series::of(&history, &driven, peak, &rows),
            experiment: experiment.map(Measured::of),
            view: None,
        };
        let text = Text {
            title: &title,
            history: &history,
            summary: summary.as_ref(),
            answers: folder.answers().ok(),
            deck: deck.as_deref(),
            experiment,
        };
        let mut frames = 0;
        if let Some(scene) = scene {
            let (still, each) = scene.sizes();
            let around = text.page(&data, &notes).len() + still;
            let (room, limit) = room([limit, largest], around, each);
            let chosen = chosen_frames(&row_of_frame, &rows, peak, room);
            notes.extend(some_of(chosen.len(), times.len(), |some, all| {
                let megabytes = (limit as f64 / 1e6).ceil();
                format!(
                    "The wall is shown at {some} of {all} frames, so that the page stays below {megabytes} MB; \
                     results.vtkhdf has all."
                )
            }));
            let view = scene.with_frames(&chosen, &mut notes);
            frames = view.frames.len();
            data.view = Some(view);
        }
        let html = text.page(&data, &notes);
        Ok(Self {
            html,
            frames,
            frames_of_run: times.len(),
            notes,
        })
    }

    /// A page that lists errors, for a folder or a deck without a report.
    pub fn failed(errors: &str) -> Self {
        let errors = escape(errors);
        let html = fill(FAILED, &[("STYLE", STYLE), ("ERRORS", &errors)]);
        Self {
            html,
            frames: 0,
            frames_of_run: 0,
            notes: Vec::new(),
        }
    }

    /// The page that `wythe view` serves. It requests the path `stamp` and reloads when the answer differs from
    /// `stamp`; frame, colour, magnification and point of view are kept.
    pub fn live(&self, stamp: &str) -> String {
        let page = self.html.replacen(
            "default-src 'none';",
            "default-src 'none'; connect-src 'self';",
            1,
        );
        // In the last script of the page, so that nothing is drawn between them.
        let (head, foot) = page.rsplit_once("</script>").unwrap_or((&page, ""));
        let script = fill(LIVE, &[("STAMP", &escape(stamp))]);
        format!("{head}\n{script}</script>{foot}")
    }

    /// Writes the whole page or nothing.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, path: &Path) -> io::Result<()> {
        write_whole(path, self.html.as_bytes())
    }
}

/// Number of frames for which the page has room, and its size then, at most `limit`, or at most `largest` with at most
/// [`FRAMES`] frames [byte]. `around`: size of the rest; `each`: of a frame.
fn room([limit, largest]: [usize; 2], around: usize, each: usize) -> (usize, usize) {
    let below = |limit: usize| limit.saturating_sub(around) / each;
    let room = below(limit).max(FRAMES.min(below(largest)));
    (room, limit.max((around + room * each).min(largest)))
}

/// A note if some are shown and not all.
fn some_of(some: usize, all: usize, note: impl Fn(usize, usize) -> String) -> Option<String> {
    (some < all).then(|| note(some, all))
}

/// Frames for which the page has room, each with its place among the `rows` of the charts.
fn chosen_frames(
    row_of_frame: &[usize],
    rows: &[usize],
    peak: Option<usize>,
    room: usize,
) -> Vec<(usize, usize)> {
    let count = row_of_frame.len();
    let at_peak = peak.and_then(|peak| (0..count).min_by_key(|&f| row_of_frame[f].abs_diff(peak)));
    let place = |frame: usize| {
        rows.binary_search(&row_of_frame[frame])
            .unwrap_or_else(|near| near)
    };
    let kept = view::choose(count, at_peak, room).into_iter();
    kept.map(|f| (f, place(f))).collect()
}

/// The result of reading a file; a failure is added to the notes.
fn or_note<T>(read: Result<T, ReadError>, notes: &mut Vec<String>) -> Option<T> {
    read.map_err(|error| {
        notes.push(match &error {
            ReadError::Read { path, why } if why.kind() == io::ErrorKind::NotFound => {
                format!("The folder has no {}.", name(path))
            }
            // The page may be passed on, so it has names of files without their folders.
            ReadError::Read { path, why } => format!("{} cannot be read: {why}", name(path)),
            ReadError::Content { path, why, .. } => {
                format!("{} cannot be read: {why}", name(path))
            }
            error => error.to_string(),
        });
    })
    .ok()
}

fn fields_unread(path: &Path, why: io::Error) -> ReadError {
    ReadError::Read {
        path: path.to_owned(),
        why,
    }
}

fn name(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str());
    name.to_string_lossy().into_owned()
}

/// The row of the history nearest in time to a frame.
fn nearest(rows: &[HistoryRow], time: f64) -> usize {
    // Times never decrease; a frame is written after its row.
    let after = rows.partition_point(|r| r.time < time);
    let closer = |row: &usize| {
        rows.get(*row)
            .map_or(f64::INFINITY, |r| (r.time - time).abs())
    };
    let before = after.saturating_sub(1);
    if closer(&before) < closer(&after) {
        before
    } else {
        after.min(rows.len().saturating_sub(1))
    }
}

/// Title of the deck or of the fields, otherwise the name of the folder.
fn title(folder: &RunFolder, deck: Option<&str>, fields: Option<&super::FieldsFile>) -> String {
    let of_deck = || {
        let table: toml::Table = deck?.parse().ok()?;
        Some(table.get("title")?.as_str()?.to_owned())
    };
    let of_fields = || fields?.title_and_version().ok().map(|(title, _)| title);
    let title = of_deck()
        .or_else(of_fields)
        .filter(|t| !t.trim().is_empty());
    title.unwrap_or_else(|| name(folder.path()))
}

/// Text of the page.
struct Text<'a> {
    title: &'a str,
    history: &'a ReadHistory,
    summary: Option<&'a SummaryFile>,
    /// None if a file cannot be read, which is noted already.
    answers: Option<Answers>,
    deck: Option<&'a str>,
    experiment: Option<&'a Experiment>,
}

impl Text<'_> {
    fn page(&self, data: &Data, notes: &[String]) -> String {
        let (class, status) = match self.summary.map(|s| s.status) {
            Some(Status::Completed) => ("good", "completed"),
            Some(Status::Collapsed) => ("warn", "collapsed"),
            Some(Status::NotConverged) => ("bad", "not converged"),
            Some(Status::Interrupted) => ("warn", "interrupted"),
            Some(Status::Stopped) => ("warn", "stopped by a callback"),
            None if self.history.rows.is_empty() => ("warn", "no increment yet"),
            None => ("warn", "no summary: going on, or killed"),
        };
        let message = self.summary.map_or("", |s| s.message.as_str());
        let verdict = self.summary.map_or("", |s| s.verdict.as_str());
        let version = self.summary.map_or("", |s| s.version.as_str());
        let warnings = self.summary.map_or(&[][..], |s| &s.warnings[..]);
        let log = self.summary.map_or(&[][..], |s| &s.log[..]);
        // Numbers and text that serde_json can always write.
        let json = serde_json::to_string(data);
        debug_assert!(json.is_ok());
        let deck = self.deck.map_or_else(
            || "<p class=\"empty\">The folder holds no copy of the deck.</p>".to_owned(),
            |deck| format!("<pre tabindex=\"0\"><code>{}</code></pre>", escape(deck)),
        );
        let figures = figures::tiles(
            self.history,
            (self.summary, self.answers.as_ref()),
            self.experiment,
        );
        // In a collapse the message equals the verdict.
        let message = if message == verdict { "" } else { message };
        let estimate = self.summary.and_then(|s| s.error_estimate.as_ref());
        let errors: String = estimate
            .map_or_else(Vec::new, ErrorEstimate::lines)
            .iter()
            .map(|line| paragraph("error", line))
            .collect();
        let message = paragraph("verdict", verdict) + &errors + &paragraph("message", message);
        let (notes, warnings) = (list("notes", notes), list("warnings", warnings));
        let log = log_list(log);
        fill(
            PAGE,
            &[
                ("TITLE", &escape(self.title)),
                ("STATUS_CLASS", class),
                ("STATUS", status),
                ("VERSION", &escape(version)),
                ("MESSAGE", &message),
                ("FIGURES", &figures),
                ("NOTES", &notes),
                ("WARNINGS", &warnings),
                ("LOG", &log),
                ("DECK", &deck),
                ("STYLE", STYLE),
                ("DATA", &escape_json(&json.unwrap_or_default())),
                ("SCRIPT", &SCRIPTS.concat()),
            ],
        )
    }
}

fn paragraph(class: &str, text: &str) -> String {
    if text.is_empty() {
        String::new()
    } else {
        format!("<p class=\"{class}\">{}</p>", escape(text))
    }
}

fn list(class: &str, lines: &[String]) -> String {
    if lines.is_empty() {
        return String::new();
    }
    let items: String = lines
        .iter()
        .map(|l| format!("<li>{}</li>\n", escape(l)))
        .collect();
    format!("<ul class=\"{class}\">{items}</ul>")
}

/// The log; the middle of a long one is omitted because it is repetitive.
fn log_list(lines: &[String]) -> String {
    const ENDS: usize = 100;
    if lines.is_empty() {
        return "<p class=\"empty\">The procedure was never changed, or the run left no log.</p>"
            .to_owned();
    }
    if lines.len() <= 2 * ENDS {
        return list("log", lines);
    }
    let skipped = format!("… {} more …", lines.len() - 2 * ENDS);
    let (first, last) = (&lines[..ENDS], &lines[lines.len() - ENDS..]);
    list("log", &[first, &[skipped], last].concat())
}

#[cfg(test)]
mod tests;
