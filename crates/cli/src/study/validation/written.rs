//! The file `case.toml` of a validation case, and its checks.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::case::{Axis, Case, Chart, Content, Run};
use super::point::{self, PointTest};
use crate::study::case::ENERGY;
use crate::study::curve;
use crate::study::expect_written::{Checker, ExpectFile};
use crate::study::written::{ShortFile, pairs, short};
use crate::study::{End, Expectation, History, StudyError};
use wythe_core::deck::Deck;
use wythe_core::deck::source::Source;
use wythe_core::error::ModelError;
use wythe_core::results::plotting::Line;
use wythe_core::results::snapshot::FrameChoice;

/// Keys of `case.toml` for serde.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseFile {
    number: u32,
    title: String,
    what: String,
    data: String,
    agrees: String,
    differs: String,
    runs: Vec<RunFile>,
    #[serde(default)]
    charts: Vec<ChartFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RunFile {
    name: String,
    #[serde(default)]
    about: String,
    deck: String,
    point: Option<PointTest>,
    #[serde(default)]
    set: Vec<String>,
    short: Option<ShortFile>,
    status: Option<End>,
    energy: Option<f64>,
    cracks: Option<CracksFile>,
    drawing: Option<bool>,
    #[serde(default)]
    expect: Vec<ExpectFile>,
}

/// Whether cracks are drawn, or of which frame.
#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "expected `cracks = true` (at the end) or `cracks = \"peak\"`"
)]
enum CracksFile {
    Is(bool),
    At(AtFrame),
}

impl CracksFile {
    fn frame(&self) -> Option<FrameChoice> {
        match self {
            Self::Is(false) => None,
            Self::Is(true) | Self::At(AtFrame::Last) => Some(FrameChoice::Last),
            Self::At(AtFrame::Peak) => Some(FrameChoice::Peak),
        }
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum AtFrame {
    Peak,
    Last,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AxisFile {
    label: String,
    column: Option<String>,
    expect: Option<String>,
    factor: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ChartFile {
    name: String,
    title: String,
    x: AxisFile,
    y: AxisFile,
    runs: Option<Vec<String>>,
    at: Option<BTreeMap<String, f64>>,
    #[serde(default)]
    references: Vec<ReferenceFile>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ReferenceFile {
    name: String,
    file: String,
    x: String,
    y: String,
    #[serde(default = "one")]
    x_factor: f64,
    #[serde(default = "one")]
    y_factor: f64,
}

fn one() -> f64 {
    1.0
}

/// Advice for the key at `path`.
pub fn advice(_path: &str) -> String {
    "docs/reference/studies.md lists the keys of a validation case".to_owned()
}

/// Whether a name is suitable for a file.
fn is_file_name(name: &str) -> bool {
    let good = |c: char| c.is_ascii_alphanumeric() || "-_".contains(c);
    !name.is_empty() && name.chars().all(good)
}

/// Source of a file and its folder, for messages.
struct At<'a> {
    source: &'a Source,
    folder: &'a Path,
}

impl CaseFile {
    /// Builds the case after all checks.
    pub fn checked(self, source: &Source, folder: &Path) -> Result<Case, StudyError> {
        let at = At { source, folder };
        let mut runs: Vec<Run> = Vec::new();
        let mut columns = Vec::new();
        // Files of the folder that the case reads.
        let mut read = vec![folder.join("case.toml")];
        for (i, written) in self.runs.into_iter().enumerate() {
            let path = format!("runs.{i}");
            let of_run = written.expect.iter().filter_map(|e| e.file.as_ref());
            read.extend(of_run.map(|file| folder.join(file)));
            let (run, of_run) = at.run(&path, written, i == 0)?;
            if runs.iter().any(|r| r.name == run.name) {
                return Err(at.error(&format!("{path}.name"), "two runs have this name"));
            }
            runs.push(run);
            columns.push(of_run);
        }
        if runs.is_empty() {
            return Err(at.error("", "the case has no [[runs]]"));
        }
        at.spared(&runs, &self.charts, read)?;
        let charts = self.charts.into_iter().enumerate();
        let charts = charts.map(|(i, c)| at.chart(&format!("charts.{i}"), c, &runs, &columns));
        Ok(Case {
            number: self.number,
            title: self.title,
            what: self.what,
            data: self.data,
            agrees: self.agrees,
            differs: self.differs,
            folder: folder.to_owned(),
            charts: charts.collect::<Result<_, _>>()?,
            runs,
        })
    }
}

impl At<'_> {
    fn error(&self, path: &str, message: impl Into<String>) -> StudyError {
        let error: ModelError = self.source.error(path, message, &advice(path));
        error.into()
    }

    /// Rejects names that would make the study overwrite an input of the case or its own output. A run writes its
    /// history and its deck beside the case, a chart its picture.
    fn spared(
        &self,
        runs: &[Run],
        charts: &[ChartFile],
        mut read: Vec<PathBuf>,
    ) -> Result<(), StudyError> {
        let references = charts.iter().flat_map(|chart| &chart.references);
        read.extend(references.map(|reference| self.folder.join(&reference.file)));
        let mut pictures: Vec<String> = Vec::new();
        for (i, run) in runs.iter().enumerate() {
            let file = |end: &str| self.folder.join(format!("{}{end}", run.name));
            let own = file(".toml");
            // A deck that is already stored under this name is not written.
            let decks = runs.iter().map(|r| &r.deck).filter(|_| run.deck != own);
            let mut spared = read.iter().chain(decks);
            if let Some(over) = spared.find(|read| **read == file(".csv") || **read == own) {
                let over = over.display();
                let what = format!(
                    "what comes out would be written over {over}: give the run another name"
                );
                return Err(self.error(&format!("runs.{i}.name"), what));
            }
            pictures.extend(["scene", "cracks"].map(|of| format!("{}_{of}", run.name)));
        }
        for (i, chart) in charts.iter().enumerate() {
            if pictures.contains(&chart.name) {
                let what = "another picture has this name, and one would be written over the other";
                return Err(self.error(&format!("charts.{i}.name"), what));
            }
            pictures.push(chart.name.clone());
        }
        Ok(())
    }

    /// Rejects keys that are given but not read, if `so`.
    fn unread(
        &self,
        path: &str,
        keys: &[(&str, bool)],
        so: bool,
        what: &str,
    ) -> Result<(), StudyError> {
        match keys.iter().find(|(_, there)| so && *there) {
            Some((key, _)) => Err(self.error(
                &format!("{path}.{key}"),
                format!("{what} does not read `{key}`"),
            )),
            None => Ok(()),
        }
    }

    /// Builds a run and the columns of its history.
    fn run(
        &self,
        path: &str,
        written: RunFile,
        first: bool,
    ) -> Result<(Run, Vec<String>), StudyError> {
        let key = |name: &str| format!("{path}.{name}");
        if !is_file_name(&written.name) {
            let name = written.name;
            let what = format!("`{name}` is no name for a file: letters, digits, - and _");
            return Err(self.error(&key("name"), what));
        }
        let set = pairs(self.source, &key("set"), &written.set)?;
        let file = self.folder.join(&written.deck);
        if !set.is_empty() && written.deck == format!("{}.toml", written.name) {
            let what = "the run's deck would be written over: give the run another name";
            return Err(self.error(&key("name"), what));
        }
        let deck = Deck::load(&file, &set)?;
        let of_scene = || History::names().into_iter().chain(deck.columns()).collect();
        let columns = match &written.point {
            Some(_) => point::columns(),
            None => of_scene(),
        };
        if let Some(name) = written.point.as_ref().and_then(PointTest::unknown) {
            let what = format!("`{name}` is no component: xx, yy, zz, xy, yz or zx");
            return Err(self.error(&key("point.free"), what));
        }
        let expect = self.expect(path, written.expect, &columns)?;
        if written.energy.is_some_and(|e| e.is_nan() || e <= 0.0) {
            return Err(self.error(&key("energy"), "must be above 0"));
        }
        let is_point = written.point.is_some();
        let unread = [
            ("status", written.status.is_some()),
            ("energy", written.energy.is_some()),
            ("cracks", written.cracks.is_some()),
            ("drawing", written.drawing.is_some()),
        ];
        self.unread(path, &unread, is_point, "a run of a `point`")?;
        let run = Run {
            short: short(self.source, &key("short"), written.short.as_ref())?,
            name: written.name,
            about: written.about,
            deck: file,
            point: written.point,
            set,
            status: written.status.unwrap_or_default(),
            energy: written.energy.unwrap_or(ENERGY),
            cracks: written.cracks.and_then(|cracks| cracks.frame()),
            drawing: written.drawing.unwrap_or(first) && !is_point,
            expect,
        };
        Ok((run, columns))
    }

    /// Expectations of a run whose history has these columns.
    fn expect(
        &self,
        path: &str,
        written: Vec<ExpectFile>,
        columns: &[String],
    ) -> Result<Vec<Expectation>, StudyError> {
        let expectation = |(i, written)| {
            let checker = Checker {
                source: self.source,
                path: format!("{path}.expect.{i}"),
                columns,
                folder: self.folder,
                advice,
            };
            checker.expectation(written)
        };
        written.into_iter().enumerate().map(expectation).collect()
    }

    fn chart(
        &self,
        path: &str,
        written: ChartFile,
        runs: &[Run],
        columns: &[Vec<String>],
    ) -> Result<Chart, StudyError> {
        let key = |name: &str| format!("{path}.{name}");
        if !is_file_name(&written.name) {
            return Err(self.error(&key("name"), "no name for a file"));
        }
        let content = self.content(path, &written, runs, columns)?;
        let references = written.references.iter().map(|it| self.reference(it));
        let references = references.collect::<Result<_, _>>()?;
        let axis = |it: AxisFile| Axis {
            label: it.label,
            column: it.column,
            factor: it.factor.unwrap_or(1.0),
        };
        Ok(Chart {
            name: written.name,
            title: written.title,
            x: axis(written.x),
            y: axis(written.y),
            content,
            references,
        })
    }

    /// Content of a chart.
    fn content(
        &self,
        path: &str,
        written: &ChartFile,
        runs: &[Run],
        columns: &[Vec<String>],
    ) -> Result<Content, StudyError> {
        let key = |name: &str| format!("{path}.{name}");
        let of_measures = written.y.expect.is_some() && written.at.is_some();
        let unread = [
            ("runs", written.runs.is_some()),
            ("x.column", written.x.column.is_some()),
            ("x.factor", written.x.factor.is_some()),
            ("y.column", written.y.column.is_some()),
        ];
        self.unread(path, &unread, of_measures, "a chart of measures")?;
        let unread = [("x.expect", written.x.expect.is_some())];
        self.unread(path, &unread, true, "a chart")?;
        match (&written.y.expect, &written.at) {
            (Some(expect), Some(at)) => {
                for name in at.keys() {
                    let run = self.run_named(&key("at"), name, runs)?;
                    if !runs[run].expect.iter().any(|e| e.name == *expect) {
                        let what = format!("the run `{name}` has no [[expect]] `{expect}`");
                        return Err(self.error(&key("y.expect"), what));
                    }
                }
                Ok(Content::Measures {
                    expect: expect.clone(),
                    at: at.iter().map(|(name, x)| (name.clone(), *x)).collect(),
                })
            }
            (None, None) => {
                let all = || runs.iter().map(|r| r.name.clone()).collect();
                let names = written.runs.clone().unwrap_or_else(all);
                for name in &names {
                    let run = self.run_named(&key("runs"), name, runs)?;
                    for (axis, it) in [("x", &written.x), ("y", &written.y)] {
                        let there = |c: &String| columns[run].contains(c);
                        if !it.column.as_ref().is_some_and(there) {
                            let what = format!("the history of `{name}` has no such column");
                            return Err(self.error(&key(&format!("{axis}.column")), what));
                        }
                    }
                }
                Ok(Content::Curves(names))
            }
            _ => {
                let what = "a chart of measures takes `y.expect` and `at`, one of curves neither";
                Err(self.error(&key("at"), what))
            }
        }
    }

    /// Reference curve in the units of the axes.
    fn reference(&self, written: &ReferenceFile) -> Result<Line, StudyError> {
        let file = self.folder.join(&written.file);
        let points = curve::read(&file, &written.x, &written.y)?;
        let scaled = |[x, y]: curve::Point| (x * written.x_factor, y * written.y_factor);
        Ok(Line {
            name: written.name.clone(),
            points: points.into_iter().map(scaled).collect(),
            marks: Vec::new(),
        })
    }

    fn run_named(&self, path: &str, name: &str, runs: &[Run]) -> Result<usize, StudyError> {
        let place = runs.iter().position(|r| r.name == name);
        place.ok_or_else(|| self.error(path, format!("there is no run `{name}`")))
    }
}
