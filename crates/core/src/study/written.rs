//! `case.toml` as written, and what is checked of it.

use std::path::Path;

use serde::Deserialize;

use super::case::{Case, CaseMethod, ENERGY, End, Short, StudyError};
use super::curve;
use super::expect::{Expectation, Measure, Wanted};
use super::history::History;
use crate::error::ModelError;
use crate::model::Deck;
use crate::model::source::Source;

/// The serde mirror of `case.toml`.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CaseFile {
    number: u32,
    title: String,
    mechanics: String,
    source: String,
    #[serde(default = "deck")]
    deck: String,
    steps: Option<Vec<usize>>,
    short: Option<ShortFile>,
    energy: Option<f64>,
    #[serde(default)]
    why: String,
    #[serde(default)]
    status: End,
    #[serde(default)]
    methods: Vec<MethodFile>,
    #[serde(default)]
    expect: Vec<ExpectFile>,
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "expected `short = false` or `short = { set = [\"KEY=VALUE\"] }`"
)]
enum ShortFile {
    Is(bool),
    Table(SetFile),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SetFile {
    set: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MethodFile {
    name: String,
    set: Vec<String>,
}

#[derive(Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Of {
    Peak,
    Trough,
    Final,
    At,
    When,
    Area,
    Curve,
    Ratio,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AtFile {
    column: String,
    value: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ExpectFile {
    name: String,
    of: Of,
    column: Option<String>,
    at: Option<AtFile>,
    reaches: Option<f64>,
    over: Option<String>,
    file: Option<String>,
    x: Option<String>,
    y: Option<String>,
    value: Option<f64>,
    tolerance: Option<f64>,
    absolute: Option<f64>,
    min: Option<f64>,
    max: Option<f64>,
    steps: Option<Vec<usize>>,
    #[serde(default)]
    only_short: bool,
    #[serde(default)]
    only_full: bool,
    #[serde(default)]
    why: String,
}

fn deck() -> String {
    "deck.toml".to_owned()
}

/// Examples of the keys of a case.
const EXAMPLES: [(&str, &str); 17] = [
    ("number", "number = 1"),
    ("title", "title = \"Snap-back bar\""),
    (
        "mechanics",
        "mechanics = \"What happens and why methods fail here.\"",
    ),
    ("source", "source = \"Where the reference comes from.\""),
    ("steps", "steps = [1]  # of the deck, counted from 0"),
    (
        "short",
        "short = { set = [\"steps.1.displacement=1 mm\"] }  # or false",
    ),
    ("set", "set = [\"interfaces.joint.penalty_factor=5\"]"),
    ("status", "status = \"completed\"  # or \"not_converged\""),
    ("name", "name = \"peak force\""),
    (
        "of",
        "of = \"peak\"  # or \"trough\", \"final\", \"at\", \"when\", \"area\", \"curve\", \"ratio\"",
    ),
    (
        "column",
        "column = \"force_kN\"  # any column of history.csv",
    ),
    ("at", "at = { column = \"displacement_mm\", value = 0.5 }"),
    ("reaches", "reaches = 0.0"),
    ("file", "file = \"reference.csv\""),
    ("value", "value = 1.23"),
    ("tolerance", "tolerance = 0.01  # relative"),
    ("energy", "energy = 0.02  # with a why"),
];

/// Advice for the key at `path`.
pub fn advice(path: &str) -> String {
    let name = path.rsplit('.').find(|part| part.parse::<usize>().is_err());
    match EXAMPLES.iter().find(|(key, _)| Some(*key) == name) {
        Some((_, line)) => format!("write it like this: {line}"),
        None => "tests/stability/README.md lists the keys of a case".to_owned(),
    }
}

impl CaseFile {
    /// The case, if all of it makes sense.
    pub fn checked(self, source: &Source, folder: &Path) -> Result<Case, StudyError> {
        let error = |path: &str, message: &str| source.error(path, message, &advice(path));
        if self.energy.is_some_and(|e| e > ENERGY) && self.why.is_empty() {
            return Err(source
                .error(
                    "energy",
                    "a larger energy imbalance wants a reason",
                    "say why beside it: why = \"…\"",
                )
                .into());
        }
        if self.energy.is_some_and(|e| e.is_nan() || e <= 0.0) {
            return Err(error("energy", "must be above 0").into());
        }
        if self.expect.is_empty() {
            return Err(source
                .error(
                    "",
                    "the case expects nothing: a wrong answer would pass",
                    "write one [[expect]] or more",
                )
                .into());
        }
        let short = match &self.short {
            None | Some(ShortFile::Is(true)) => Short::Whole,
            Some(ShortFile::Is(false)) => Short::None,
            Some(ShortFile::Table(SetFile { set })) => Short::Set(pairs(source, "short.set", set)?),
        };
        let mut methods: Vec<CaseMethod> = Vec::new();
        for (i, method) in self.methods.iter().enumerate() {
            let path = format!("methods.{i}");
            if methods.iter().any(|m| m.name == method.name) {
                return Err(error(&format!("{path}.name"), "two methods have this name").into());
            }
            methods.push(CaseMethod {
                name: method.name.clone(),
                set: pairs(source, &format!("{path}.set"), &method.set)?,
            });
        }
        let deck = Deck::load(folder.join(&self.deck), &[])?;
        let own = deck.columns();
        let columns: Vec<String> = History::names().into_iter().chain(own).collect();
        let mut expect = Vec::new();
        for (i, written) in self.expect.into_iter().enumerate() {
            let checker = Checker {
                source,
                path: format!("expect.{i}"),
                columns: &columns,
                folder,
            };
            expect.push(checker.expectation(written)?);
        }
        Ok(Case {
            number: self.number,
            part: String::new(),
            title: self.title,
            mechanics: self.mechanics,
            source: self.source,
            deck: folder.join(self.deck),
            steps: self.steps,
            short,
            energy: self.energy.unwrap_or(ENERGY),
            why: self.why,
            status: self.status,
            methods,
            expect,
        })
    }
}

/// `KEY=VALUE` each.
fn pairs(source: &Source, path: &str, set: &[String]) -> Result<Vec<(String, String)>, ModelError> {
    set.iter()
        .enumerate()
        .map(|(i, text)| match text.split_once('=') {
            Some((key, value)) if !key.trim().is_empty() && !value.trim().is_empty() => {
                Ok((key.trim().to_owned(), value.trim().to_owned()))
            }
            _ => Err(source.error(
                &format!("{path}.{i}"),
                format!("`{text}` is not KEY=VALUE"),
                &advice("set"),
            )),
        })
        .collect()
}

/// Checks one `[[expect]]`.
struct Checker<'a> {
    source: &'a Source,
    path: String,
    columns: &'a [String],
    folder: &'a Path,
}

impl Checker<'_> {
    fn error(&self, key: &str, message: impl Into<String>) -> ModelError {
        let path = format!("{}.{key}", self.path);
        self.source.error(&path, message, &advice(&path))
    }

    /// A column of the history.
    fn column(&self, key: &str, name: Option<String>) -> Result<String, ModelError> {
        let Some(name) = name else {
            return Err(self.error(key, format!("the key `{key}` is missing")));
        };
        if self.columns.contains(&name) {
            return Ok(name);
        }
        let path = format!("{}.{key}", self.path);
        let known = self.columns.join(", ");
        Err(self.source.error(
            &path,
            format!("history.csv has no column of numbers `{name}`"),
            &format!("there are {known}"),
        ))
    }

    fn expectation(&self, written: ExpectFile) -> Result<Expectation, StudyError> {
        let wanted = self.wanted(&written)?;
        self.unused(&written)?;
        if written.only_short && written.only_full {
            return Err(self
                .error("only_full", "not both only_short and only_full")
                .into());
        }
        Ok(Expectation {
            name: written.name.clone(),
            wanted,
            steps: written.steps.clone(),
            of_short: !written.only_full,
            of_full: !written.only_short,
            why: written.why.clone(),
            measure: self.measure(written)?,
        })
    }

    fn measure(&self, written: ExpectFile) -> Result<Measure, StudyError> {
        let missing = |key: &str| self.error(key, format!("the key `{key}` is missing"));
        let column = |name| self.column("column", name);
        Ok(match written.of {
            Of::Peak => Measure::Peak(column(written.column)?),
            Of::Trough => Measure::Trough(column(written.column)?),
            Of::Final => Measure::Final(column(written.column)?),
            Of::At => {
                let at = written.at.ok_or_else(|| missing("at"))?;
                Measure::At {
                    column: column(written.column)?,
                    of: self.column("at.column", Some(at.column))?,
                    value: at.value,
                }
            }
            Of::When => Measure::When {
                column: column(written.column)?,
                reaches: written.reaches.ok_or_else(|| missing("reaches"))?,
            },
            Of::Area => {
                let x = written.x.unwrap_or_else(|| "displacement_mm".to_owned());
                Measure::Area {
                    column: column(written.column)?,
                    x: self.column("x", Some(x))?,
                }
            }
            Of::Ratio => Measure::Ratio {
                column: column(written.column)?,
                over: match written.over {
                    Some(over) => Some(self.column("over", Some(over))?),
                    None => None,
                },
            },
            Of::Curve => {
                let (x, y) = (self.column("x", written.x)?, self.column("y", written.y)?);
                let file = written.file.ok_or_else(|| missing("file"))?;
                let reference = curve::read(&self.folder.join(file), &x, &y)?;
                Measure::Curve { x, y, reference }
            }
        })
    }

    fn wanted(&self, written: &ExpectFile) -> Result<Wanted, ModelError> {
        let ExpectFile {
            value,
            tolerance,
            absolute,
            min,
            max,
            ..
        } = *written;
        let positive = |key: &str, number: f64| {
            if number > 0.0 {
                Ok(number)
            } else {
                Err(self.error(key, "must be above 0"))
            }
        };
        if written.of == Of::Curve {
            return match (value, tolerance, absolute, min, max) {
                (None, Some(tolerance), None, None, None) => {
                    Ok(Wanted::Within(positive("tolerance", tolerance)?))
                }
                _ => Err(self.error("tolerance", "a curve takes a tolerance and nothing else")),
            };
        }
        match (value, tolerance, absolute, min, max) {
            (Some(0.0), Some(_), ..) => Err(self.error(
                "value",
                "nothing is within a part of 0: give `absolute` in the place of `tolerance`",
            )),
            (Some(value), Some(tolerance), None, None, None) => {
                Ok(Wanted::Relative(value, positive("tolerance", tolerance)?))
            }
            (Some(value), None, Some(absolute), None, None) => {
                Ok(Wanted::Absolute(value, positive("absolute", absolute)?))
            }
            (None, None, None, min, max) if min.is_some() || max.is_some() => Ok(Wanted::Between(
                min.unwrap_or(f64::NEG_INFINITY),
                max.unwrap_or(f64::INFINITY),
            )),
            _ => Err(self.error(
                "value",
                "give `value` with `tolerance` or with `absolute`, or else `min`, `max` or both",
            )),
        }
    }

    /// Keys that another `of` would read.
    fn unused(&self, written: &ExpectFile) -> Result<(), ModelError> {
        let is = |of: &[Of]| of.contains(&written.of);
        for (key, there, read) in [
            ("column", written.column.is_some(), !is(&[Of::Curve])),
            ("at", written.at.is_some(), is(&[Of::At])),
            ("reaches", written.reaches.is_some(), is(&[Of::When])),
            ("over", written.over.is_some(), is(&[Of::Ratio])),
            ("file", written.file.is_some(), is(&[Of::Curve])),
            ("x", written.x.is_some(), is(&[Of::Curve, Of::Area])),
            ("y", written.y.is_some(), is(&[Of::Curve])),
        ] {
            if there && !read {
                return Err(self.error(key, format!("this `of` does not read `{key}`")));
            }
        }
        Ok(())
    }
}
