//! The table `[[expect]]` of a file, and its checks.

use std::path::Path;

use serde::Deserialize;

use super::case::StudyError;
use super::curve;
use super::expect::{Expectation, Measure, Wanted};
use wythe_core::deck::source::Source;
use wythe_core::error::ModelError;

#[derive(Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Of {
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
pub struct AtFile {
    column: String,
    value: f64,
}

/// Keys of `[[expect]]` for serde.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
// More than 15 fields: one for each key of the file.
pub struct ExpectFile {
    name: String,
    of: Of,
    column: Option<String>,
    at: Option<AtFile>,
    reaches: Option<f64>,
    over: Option<String>,
    pub(super) file: Option<String>,
    x: Option<String>,
    y: Option<String>,
    value: Option<f64>,
    tolerance: Option<f64>,
    absolute: Option<f64>,
    min: Option<f64>,
    max: Option<f64>,
    /// The value is reported without a requirement.
    #[serde(default)]
    reported: bool,
    steps: Option<Vec<usize>>,
    #[serde(default)]
    only_short: bool,
    #[serde(default)]
    only_full: bool,
    #[serde(default)]
    why: String,
}

/// Checks one table `[[expect]]`.
pub struct Checker<'a> {
    pub source: &'a Source,
    /// Path of the table in its file.
    pub path: String,
    /// Columns of the run's history.
    pub columns: &'a [String],
    /// Folder of the references.
    pub folder: &'a Path,
    /// Advice on the syntax of a key.
    pub advice: fn(&str) -> String,
}

impl Checker<'_> {
    fn error(&self, key: &str, message: impl Into<String>) -> ModelError {
        let path = format!("{}.{key}", self.path);
        self.source.error(&path, message, &(self.advice)(&path))
    }

    /// Checks that the history has this column.
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

    /// Builds the expectation after all checks.
    pub fn expectation(&self, written: ExpectFile) -> Result<Expectation, StudyError> {
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
        if written.reported {
            return match (value, tolerance, absolute, min, max) {
                (None, None, None, None, None) => Ok(Wanted::Reported),
                _ => Err(self.error("reported", "what is only reported takes no value")),
            };
        }
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
                "give `value` with `tolerance` or with `absolute`, or `min`, `max` or both, or `reported = true`",
            )),
        }
    }

    /// Rejects keys that this `of` does not read.
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
