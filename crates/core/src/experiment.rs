//! Measured load-displacement curves from CSV files.
//!
//! ```text
//! # Wall SW1001, monotonic                         comment
//! top_displacement_mm,horizontal_force_kN,drift    a header names the columns
//! 0.23,3.2,0.023                                   a row a point, in the order of the test
//! ```

use std::io;
use std::path::{Path, PathBuf};

use miette::Diagnostic;

use crate::input;

/// A point of a curve: displacement [mm], force [kN].
pub type Point = (f64, f64);

/// Error of a file with a measured curve.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum ExperimentError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {why}", path.display())]
    #[diagnostic(help(
        "check the path, relative to the current folder; the file is text in UTF-8"
    ))]
    Read {
        /// The file.
        path: PathBuf,
        /// Error of the system.
        why: io::Error,
    },
    /// The content of the file is not a curve.
    #[error("{}{}: {why}", path.display(), line.map_or(String::new(), |l| format!(":{l}")))]
    #[diagnostic(help("{help}"))]
    Content {
        /// The file.
        path: PathBuf,
        /// Line, from 1, if the error is in one line.
        line: Option<u64>,
        /// Reason.
        why: String,
        /// Remedy.
        help: String,
    },
}

/// A measured curve.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Experiment {
    /// Name of the file, without its extension.
    pub name: String,
    /// Points in the order of the test.
    pub points: Vec<Point>,
}

/// Names and units of a column of displacements or forces.
struct Wanted {
    what: &'static str,
    words: [&'static str; 2],
    /// Column name of wythe's own history, which takes precedence.
    own: &'static str,
    units: &'static [(&'static str, f64)],
    /// Units of other scales and quantities, in lower case and with blanks between them. Words that name places or
    /// directions as well, such as `n` or `foot`, are left out.
    others: &'static str,
}

impl Wanted {
    /// Factor of a unit, in any case if none has this one.
    fn factor(&self, word: &str) -> Option<f64> {
        // The Greek letter stands for the sign of the same look.
        let word = word.replace('μ', "µ");
        let exact = self.units.iter().find(|(unit, _)| *unit == word);
        let lower = word.to_lowercase();
        let any_case = || {
            self.units
                .iter()
                .find(|(unit, _)| unit.to_lowercase() == lower)
        };
        exact.or_else(any_case).map(|(_, factor)| *factor)
    }

    /// Whether a word is a unit, of these or others.
    fn is_unit(&self, word: &str) -> bool {
        let lower = word.to_lowercase();
        self.factor(word).is_some() || self.others.split(' ').any(|other| other == lower)
    }
}

const DISPLACEMENT: Wanted = Wanted {
    what: "displacement",
    words: ["displacement", "deflection"],
    own: "displacement_mm",
    units: &[
        ("mm", 1.0),
        ("cm", 10.0),
        ("m", 1000.0),
        ("um", 1e-3),
        ("µm", 1e-3),
    ],
    others: "nm micron microns dm km millimetre millimetres millimeter millimeters metre metres meter meters \
             in inch inches ft feet yd mil mils thou rad mrad deg % kn",
};

const FORCE: Wanted = Wanted {
    what: "force",
    words: ["force", "load"],
    own: "force_kn",
    // Without regard to case `mn` is MN, the first of both.
    units: &[("kN", 1.0), ("N", 1e-3), ("MN", 1e3), ("mN", 1e-6)],
    others: "dan gn newton newtons kilonewton kilonewtons dyn kp kgf kg t tf ton tons tonf tonne tonnes \
             kip kips klb klbf lb lbs lbf pounds ozf kpa mpa gpa psi ksi nm knm knmm mm cm %",
};

const HEADER: &str =
    "begin with a line of names such as displacement_mm,force_kN; # begins a comment";

impl Experiment {
    /// Reads a CSV file, separated by commas, semicolons (also with decimal commas) or tabs.
    ///
    /// The header names the columns. The name of the displacement column contains `displacement` or `deflection`,
    /// that of the force column `force` or `load`. A history of wythe has both. The ending of a name gives the unit
    /// (`_kN`, `[kN]`): mm, cm, m, um and kN, N, MN, mN. Another unit is an error. Without an ending the units are mm
    /// and kN. A monotonic curve may also be given from its end to its start.
    ///
    /// # Errors
    /// [`ExperimentError`], with file and line.
    pub fn read(path: &Path) -> Result<Self, ExperimentError> {
        let text =
            input::text(path, input::MOST_OF_TABLE).map_err(|why| ExperimentError::Read {
                path: path.to_owned(),
                why,
            })?;
        Self::of_text(path, &text)
    }

    /// The same from the text of the file `path`.
    ///
    /// # Errors
    /// [`ExperimentError::Content`].
    pub fn of_text(path: &Path, text: &str) -> Result<Self, ExperimentError> {
        let stem = path.file_stem().unwrap_or(path.as_os_str());
        let points = parse(text).map_err(|(line, why, help)| ExperimentError::Content {
            path: path.to_owned(),
            line,
            why,
            help,
        })?;
        Ok(Self {
            name: stem.to_string_lossy().into_owned(),
            points,
        })
    }
}

/// Line, reason, remedy.
type Wrong = (Option<u64>, String, String);

fn parse(text: &str) -> Result<Vec<Point>, Wrong> {
    let text = text.trim_start_matches('\u{feff}');
    let first = |line: &&str| !line.trim().is_empty() && !line.starts_with('#');
    let header = text.lines().find(first).unwrap_or_default();
    let line = text.lines().position(|l| first(&l)).unwrap_or(0) as u64 + 1;
    let separator = [b';', b'\t']
        .into_iter()
        .find(|s| header.as_bytes().contains(s));
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(separator.unwrap_or(b','))
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(text.as_bytes());
    let of_csv = |error: &csv::Error| {
        let line = error.position().map(csv::Position::line);
        (line, error.to_string(), HEADER.to_owned())
    };
    let names = reader.headers().map_err(|e| of_csv(&e))?.clone();
    let columns = [&DISPLACEMENT, &FORCE].map(|wanted| column(&names, wanted));
    let [displacement, force] = columns;
    let of_header = |(why, help): (String, String)| (Some(line), why, help);
    let columns = [displacement.map_err(of_header)?, force.map_err(of_header)?];
    let mut points = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|e| of_csv(&e))?;
        // The position of csv precedes skipped blank lines and comments.
        let from = record.position().map_or(1, csv::Position::line) - 1;
        let skipped = text.lines().skip(from as usize).position(|l| first(&l));
        let line = Some(from + skipped.unwrap_or(0) as u64 + 1);
        require_width(&record, names.len()).map_err(|(why, help)| (line, why, help))?;
        let mut point = [0.0; 2];
        for (value, (column, unit)) in point.iter_mut().zip(columns) {
            let field = record.get(column).unwrap_or_default();
            // With semicolons as separators, commas are decimal.
            let number = field
                .replace(',', ".")
                .parse()
                .ok()
                .filter(|v: &f64| v.is_finite());
            let Some(number) = number else {
                let why = format!("`{field}` in the column `{}` is no number", &names[column]);
                let help = "a row has a number in both columns; put # before lines that are none";
                return Err((line, why, help.to_owned()));
            };
            *value = unit * number;
        }
        points.push((point[0], point[1]));
    }
    if points.len() < 2 {
        let why = "a curve takes two rows or more".to_owned();
        return Err((None, why, HEADER.to_owned()));
    }
    if points.iter().all(|p| p.0 == points[0].0) {
        let why = format!("the displacement is {} mm in every row", points[0].0);
        return Err((None, why, "name the column that moves".to_owned()));
    }
    if runs_backwards(&points) {
        points.reverse();
    }
    Ok(points)
}

/// Whether every row lies nearer to rest than the one before: digitised from the end of a monotonic test to its start.
fn runs_backwards(points: &[Point]) -> bool {
    let nearer = |pair: &[Point]| pair[1].0.abs() < pair[0].0.abs();
    points.windows(2).all(nearer)
}

/// Rejects a row with more fields than the header: a decimal comma would shift its columns.
fn require_width(record: &csv::StringRecord, header: usize) -> Result<(), (String, String)> {
    let fields = record.iter().collect::<Vec<_>>();
    let empty = fields.iter().rev().take_while(|field| field.is_empty());
    let count = fields.len() - empty.count();
    if count <= header {
        return Ok(());
    }
    let why = format!("the row has {count} fields, and the header {header}");
    let help = "with decimal commas, separate the columns by semicolons or tabs";
    Err((why, help.to_owned()))
}

/// Index of a column, and its unit in mm or kN.
fn column(names: &csv::StringRecord, wanted: &Wanted) -> Result<(usize, f64), (String, String)> {
    let lower: Vec<String> = names.iter().map(str::to_lowercase).collect();
    let holds = |name: &String| wanted.words.iter().any(|word| name.contains(word));
    let factor = |name: &String| name.contains("factor");
    let places: Vec<usize> = match lower.iter().position(|name| name == wanted.own) {
        Some(own) => vec![own],
        None => (0..lower.len())
            .filter(|&i| holds(&lower[i]) && !factor(&lower[i]))
            .collect(),
    };
    let listed = |of: &mut dyn Iterator<Item = &str>| of.collect::<Vec<_>>().join(", ");
    let what = wanted.what;
    match places[..] {
        [place] => unit(&names[place], wanted).map(|unit| (place, unit)),
        [] => Err((
            format!(
                "no column of {what}: there are {}",
                listed(&mut names.iter())
            ),
            HEADER.to_owned(),
        )),
        _ => Err((
            format!(
                "several columns of {what}: {}",
                listed(&mut places.iter().map(|&i| &names[i]))
            ),
            format!(
                "rename the column to be read: {}",
                wanted.own.replace("kn", "kN")
            ),
        )),
    }
}

/// Unit at the end of a name: `force_kN`, `force [kN]`, `force (kN)`, `force/kN`.
fn unit(name: &str, wanted: &Wanted) -> Result<f64, (String, String)> {
    let is_bracketed = name.ends_with([']', ')']);
    let is_gap = |c: char| c == '_' || c.is_whitespace() || "[](),;:".contains(c);
    let last = name.split(is_gap).rfind(|part| !part.is_empty());
    let last = last.unwrap_or_default().trim_end_matches('.');
    // `force/kN` is a force in kN, and `mm/m` is a unit.
    let last = match last.split_once('/') {
        Some((before, after)) if !is_bracketed && !wanted.is_unit(before) => after,
        _ => last,
    };
    if let Some(factor) = wanted.factor(last) {
        return Ok(factor);
    }
    if !is_bracketed && !last.split('/').any(|word| wanted.is_unit(word)) {
        return Ok(1.0);
    }
    let known = wanted.units.iter().map(|(unit, _)| *unit);
    let known = known.collect::<Vec<_>>().join(", ");
    Err((
        format!("the unit of `{name}` is not known: `{last}` is none of {known}"),
        format!(
            "convert the column to one of {known}; if `{last}` is no unit, let the name end with one, as {} does",
            wanted.own.replace("kn", "kN")
        ),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_found_by_their_names_and_units() {
        let points = |text| parse(text).unwrap();
        let rows = [(0.0, 0.0), (0.5, 12.0)];
        for text in [
            "# from a test\ntop_displacement_mm,horizontal_force_kN,drift_pct\n0,0,0\n0.5,12,1\n",
            "\u{feff}Force [N];Displacement [cm]\n0;0\n12000;0,05\n",
            "time,displacement_mm,load_factor,force_kN\n0,0,0,0\n1,0.5,1,12\n",
            "displacement\tload\n0\t0\n# a pause\n0.5\t12\n",
            "displacement_mm,force_kN\n0.5,12\n0,0\n",
            "displacement_um,force_mN\n0,0\n500,12e6\n",
            "Displacement [µm];Load/N\n0;0\n500;12000\n",
            "displacement_MM,force_mn\n0,0\n0.5,0.012\n",
        ] {
            assert_eq!(points(text), rows, "{text}");
        }
    }

    /// Words at the end of a name that are no units are read as before, in mm and kN.
    #[test]
    fn names_without_a_unit_are_in_mm_and_kilonewtons() {
        for (displacement, force) in [
            ("top_displacement", "force_total"),
            ("displacement_north", "load_cell_1"),
            ("displacement_N", "applied load"),
            ("deflection.1", "load-max"),
        ] {
            let text = format!("{displacement},{force}\n0,0\n0.5,12\n");
            assert_eq!(parse(&text).unwrap(), [(0.0, 0.0), (0.5, 12.0)], "{text}");
        }
    }

    #[test]
    fn other_units_are_rejected() {
        for (header, unit) in [
            ("displacement_nm,force_kN", "nm"),
            ("displacement_in,force_kN", "in"),
            ("displacement in.,force_kN", "in"),
            ("displacement_mm/m,force_kN", "mm/m"),
            ("displacement [mm/m],force_kN", "mm/m"),
            ("displacement_mm,force_kip", "kip"),
            ("displacement_mm,force_kgf", "kgf"),
            ("displacement_mm,load_lbf", "lbf"),
            ("displacement_mm,Force_Tons", "Tons"),
            ("displacement_mm,load/kg", "kg"),
            ("displacement_mm,load_t", "t"),
            ("displacement_mm,force_kN/m", "kN/m"),
            ("displacement_mm,force_mm", "mm"),
        ] {
            let (line, why, help) = parse(&format!("{header}\n0,0\n1,2\n")).unwrap_err();
            assert_eq!(line, Some(1), "{header}");
            assert!(why.contains(&format!("`{unit}` is none of")), "{why}");
            assert!(help.contains("convert the column to one of"), "{help}");
        }
    }

    #[test]
    fn errors_are_reported_with_their_line() {
        for (text, line, said) in [
            ("a,b\n0,0\n1,1\n", Some(1), "no column of displacement"),
            ("displacement,b\n0,0\n1,1\n", Some(1), "no column of force"),
            (
                "#\ndisplacement,force_a,force_b\n0,0,0\n",
                Some(2),
                "several columns of force",
            ),
            (
                "displacement_mm,force_kN\n0,0\n\n1,x\n",
                Some(4),
                "`x` in the column",
            ),
            (
                "displacement_mm,force_kN\n0,0\n1\n",
                Some(3),
                "`` in the column",
            ),
            ("displacement_mm,force_kN\n0,0\n1,NaN\n", Some(3), "`NaN`"),
            (
                "displacement_mm,force_kN\n0,0\n0,5,12\n",
                Some(3),
                "3 fields",
            ),
            (
                "displacement [in],force [lbf]\n0,0\n1,2\n",
                Some(1),
                "unit of `displacement [in]`",
            ),
            ("displacement_mm,force_kN\n0,0\n", None, "two rows"),
            (
                "displacement_mm,force_kN\n1,0\n1,2\n",
                None,
                "is 1 mm in every row",
            ),
            ("", Some(1), "no column"),
        ] {
            let (at, why, help) = parse(text).unwrap_err();
            assert!(why.contains(said), "{text}: {why}");
            assert_eq!(at, line, "{text}: {why}");
            assert!(!help.is_empty());
        }
    }

    #[test]
    fn the_file_is_named() {
        let missing = Experiment::read(Path::new("no/such.csv")).unwrap_err();
        assert!(
            missing
                .to_string()
                .starts_with("no/such.csv: cannot be read"),
            "{missing}"
        );
    }
}
