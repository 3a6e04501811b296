//! Columns of the history over each other. A run without a drive has its probes over time.

use super::axes::{Axes, Label};
use super::chart::{Line, Pen, run_pen};
use crate::deck::keys::nearest;
use crate::experiment::Point;
use crate::results::curve::brief;
use crate::results::{ReadError, ReadHistory};

/// Width and height of the picture [px].
const SIZE: (f64, f64) = (900.0, 600.0);
/// Units at the ends of names of columns, the longer ones first, and as they are written.
const UNITS: [(&str, &str); 10] = [
    ("_kN_per_mm", "kN/mm"),
    ("_mm_per_s", "mm/s"),
    ("_mm2", "mm²"),
    ("_mm", "mm"),
    ("_kN", "kN"),
    ("_MPa", "MPa"),
    ("_deg", "°"),
    ("_rad", "rad"),
    ("_J", "J"),
    ("_N", "N"),
];

/// Columns of a picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Columns {
    /// Abscissa; `None`: the displacement of the drive, or the time of a run without one.
    pub x: Option<String>,
    /// Ordinates; empty: the force of the drive, or the probes of a run without one.
    pub y: Vec<String>,
}

impl Columns {
    /// The columns with the default ones of a run.
    #[must_use]
    pub fn or_default(&self, history: &ReadHistory) -> Self {
        let driven = history.driven().contains(&true);
        let x = if driven { "displacement_mm" } else { "time" };
        let y = if driven {
            vec!["force_kN".to_owned()]
        } else if history.probes.is_empty() {
            vec!["elastic_energy_J".to_owned(), "external_work_J".to_owned()]
        } else {
            history.probes.clone()
        };
        Self {
            x: Some(self.x.clone().unwrap_or_else(|| x.to_owned())),
            y: if self.y.is_empty() { y } else { self.y.clone() },
        }
    }

    /// Name of a file for the picture, without its ending: `force_kN_over_time`.
    pub fn file_name(&self) -> String {
        let x = self.x.as_deref().unwrap_or("time");
        match &self.y[..] {
            [one] => format!("{one}_over_{x}"),
            [first, ..] => format!("{first}_and_more_over_{x}"),
            [] => "curves".to_owned(),
        }
    }
}

impl ReadHistory {
    /// Values of a column, with a number each row.
    ///
    /// # Errors
    /// [`ReadError::NoColumn`]: there is no such column, or it holds words.
    pub fn column(&self, name: &str) -> Result<Vec<f64>, ReadError> {
        if let Some(i) = self.probes.iter().position(|probe| probe == name) {
            return Ok(self.rows.iter().map(|row| row.probes[i]).collect());
        }
        let value = |row| -> Option<f64> {
            match serde_json::to_value(row).ok()?.get(name)? {
                serde_json::Value::Number(number) => number.as_f64(),
                // JSON has no numbers that are none.
                serde_json::Value::Null => Some(f64::NAN),
                _ => None,
            }
        };
        let values: Option<Vec<f64>> = self.rows.iter().map(value).collect();
        let known = self.columns();
        match values {
            Some(values) if known.contains(&name) => Ok(values),
            _ => Err(ReadError::NoColumn {
                name: name.to_owned(),
                advice: match nearest(name, known.iter().copied()) {
                    Some(near) => format!("do you mean `{near}`?"),
                    None => format!("the history has {}", known.join(", ")),
                },
            }),
        }
    }

    /// Names of all columns of numbers.
    pub fn columns(&self) -> Vec<&str> {
        let fixed = crate::model::columns::FIXED.into_iter();
        let numbers = fixed.filter(|name| *name != "procedure");
        numbers
            .chain(self.probes.iter().map(String::as_str))
            .collect()
    }
}

/// Columns of runs over each other, as SVG text, with the names of the runs. The first run decides the default
/// columns. The largest value of a force over a displacement is marked.
///
/// # Errors
/// A run lacks a column ([`ReadError::NoColumn`]), or a column has no finite number ([`ReadError::Undrawn`]).
pub fn columns(
    title: &str,
    runs: &[(&str, &ReadHistory)],
    columns: &Columns,
) -> Result<String, ReadError> {
    let Some((_, first)) = runs.first() else {
        return Err(ReadError::Undrawn("there is no run to draw".to_owned()));
    };
    let columns = columns.or_default(first);
    let x = columns.x.as_deref().unwrap_or("time");
    let mut lines: Vec<(Line, Pen)> = Vec::new();
    let mut labels = Vec::new();
    for (run, history) in runs {
        let along = history.column(x)?;
        for name in &columns.y {
            let values = history.column(name)?;
            let points: Vec<Point> = along.iter().copied().zip(values).collect();
            let pen = run_pen(lines.len());
            let marks: Vec<Point> = extreme(&points).into_iter().collect();
            labels.extend(marks.iter().map(|at| Label {
                at: *at,
                text: format!("{} at {}", with_unit(at.1, name), with_unit(at.0, x)),
                colour: pen.colour,
            }));
            let named = match (runs.len(), columns.y.len()) {
                (1, 1) => String::new(),
                (1, _) => axis(name),
                (_, 1) => (*run).to_owned(),
                _ => format!("{run}: {}", axis(name)),
            };
            let line = Line {
                name: named,
                points,
                marks,
            };
            lines.push((line, pen));
        }
    }
    let names = [axis(x), axis_of_all(&columns.y)];
    Axes {
        size: SIZE,
        title,
        names: [&names[0], &names[1]],
        band: (&[], ""),
        lines: &lines,
        labels: if lines.len() <= MOST_LABELS {
            &labels
        } else {
            &[]
        },
    }
    .svg()
    .map_err(ReadError::Undrawn)
}

/// Largest number of lines whose largest values have a label.
const MOST_LABELS: usize = 4;

/// Point of the largest absolute value, unless that is 0 or lies at the very end.
fn extreme(points: &[Point]) -> Option<Point> {
    let finite = points.iter().filter(|p| p.0.is_finite() && p.1.is_finite());
    let most = finite.fold(None, |best: Option<&Point>, p| match best {
        Some(b) if b.1.abs() >= p.1.abs() => Some(b),
        _ => Some(p),
    })?;
    let last = points.last()?;
    (most.1 != 0.0 && most != last).then_some(*most)
}

/// Name without its unit, and the unit.
fn split(column: &str) -> (String, &'static str) {
    if column == "time" {
        return ("time".to_owned(), "s");
    }
    let unit = UNITS.iter().find(|(end, _)| column.ends_with(end));
    let (name, unit) = match unit {
        Some((end, unit)) => (&column[..column.len() - end.len()], *unit),
        None => (column, ""),
    };
    (name.replace('_', " "), unit)
}

fn with_unit(value: f64, column: &str) -> String {
    match split(column).1 {
        "" => brief(value),
        unit => format!("{} {unit}", brief(value)),
    }
}

/// Name of an axis: `displacement [mm]` for `displacement_mm`.
pub fn axis(column: &str) -> String {
    match split(column) {
        (name, "") => name,
        (name, unit) => format!("{name} [{unit}]"),
    }
}

/// Name of the axis of several columns: their unit, if it is the same for all.
fn axis_of_all(columns: &[String]) -> String {
    let units = |column: &String| split(column).1;
    match columns {
        [one] => axis(one),
        [first, rest @ ..] if rest.iter().all(|c| units(c) == units(first)) => match units(first) {
            "" => String::new(),
            unit => format!("[{unit}]"),
        },
        _ => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::fake;

    fn history() -> ReadHistory {
        let rows = [(0.0, 0.0), (1.0, 10.0), (2.0, 7.0)];
        let rows = rows.iter().enumerate().map(|(i, (d, f))| {
            let mut row = fake::row(i, 0, *d, *f);
            row.probes = vec![0.5 * d];
            row
        });
        ReadHistory {
            rows: rows.collect(),
            probes: vec!["crown_mm".to_owned()],
            steps: None,
        }
    }

    #[test]
    fn every_column_of_numbers_is_drawn() {
        let history = history();
        for x in history.columns() {
            let of = Columns {
                x: Some(x.to_owned()),
                y: vec!["force_kN".to_owned(), "crown_mm".to_owned()],
            };
            let svg = columns("", &[("run", &history)], &of).unwrap();
            assert!(
                svg.contains("crown [mm]") && svg.contains("<polyline"),
                "{x}"
            );
        }
        let of = Columns::default().or_default(&history);
        assert_eq!(of.file_name(), "force_kN_over_displacement_mm");
        let svg = columns("", &[("run", &history)], &of).unwrap();
        assert!(svg.contains("10.00 kN at 1.000 mm"), "{svg}");
    }

    #[test]
    fn an_unknown_column_names_the_nearest() {
        let error = history().column("force_kn").unwrap_err();
        let help = miette::Diagnostic::help(&error).unwrap().to_string();
        assert!(help.contains("`force_kN`"), "{help}");
        assert!(history().column("procedure").is_err());
    }

    #[test]
    fn a_run_without_drive_shows_its_probes_over_time() {
        let mut still = history();
        for row in &mut still.rows {
            row.displacement_mm = 0.0;
        }
        let of = Columns::default().or_default(&still);
        assert_eq!(of.file_name(), "crown_mm_over_time");
        still.probes.clear();
        assert_eq!(Columns::default().or_default(&still).y.len(), 2);
    }

    #[test]
    fn axes_have_units() {
        for (column, text) in [
            ("time", "time [s]"),
            ("displacement_mm", "displacement [mm]"),
            ("contact_area_mm2", "contact area [mm²]"),
            ("open_points", "open points"),
        ] {
            assert_eq!(axis(column), text);
        }
    }
}
