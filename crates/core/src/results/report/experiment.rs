//! A measured curve to lay over the computed one.

use std::path::Path;

use super::ReportError;

/// Column of the displacement, by the end of its name.
const DISPLACEMENT: &str = "displacement_mm";
/// Column of the force, by the end of its name.
const FORCE: &str = "force_kN";

/// A measured load-displacement curve.
#[derive(Clone, Debug, PartialEq)]
pub struct Experiment {
    /// How the page calls it: the name of the file.
    pub name: String,
    /// (displacement [mm], force [kN]), in the order of the file.
    pub points: Vec<(f64, f64)>,
}

impl Experiment {
    /// Reads a CSV file: a line of names, among them `displacement_mm` and `force_kN` or names that end
    /// so (`top_displacement_mm`); `#` begins a comment. Other columns are passed over.
    ///
    /// # Errors
    /// [`ReportError::Experiment`]: the file cannot be read, lacks a column, or a field is no number.
    pub fn read(path: &Path) -> Result<Self, ReportError> {
        let wrong = |line: Option<u64>, why: String| ReportError::Experiment {
            path: path.to_owned(),
            line,
            why,
        };
        let text = std::fs::read_to_string(path).map_err(|why| ReportError::Unreadable {
            path: path.to_owned(),
            why,
        })?;
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .flexible(true)
            .from_reader(text.as_bytes());
        let header = reader
            .headers()
            .map_err(|e| wrong(None, e.to_string()))?
            .clone();
        let column = |name: &str| {
            let whole = header.iter().position(|h| h == name);
            let end = || header.iter().position(|h| h.ends_with(name));
            whole.or_else(end).ok_or_else(|| {
                let found = header.iter().collect::<Vec<_>>().join(", ");
                wrong(None, format!("there is no column {name}, only {found}"))
            })
        };
        let columns = [column(DISPLACEMENT)?, column(FORCE)?];
        let mut points = Vec::new();
        for record in reader.records() {
            let record = record.map_err(|e| {
                wrong(
                    e.position().map(csv::Position::line),
                    "this is no row of numbers".to_owned(),
                )
            })?;
            let line = record.position().map(csv::Position::line);
            let number = |column: usize| {
                let field = record.get(column).unwrap_or_default();
                let value = field.parse().ok().filter(|v: &f64| v.is_finite());
                value.ok_or_else(|| wrong(line, format!("`{field}` is no number")))
            };
            points.push((number(columns[0])?, number(columns[1])?));
        }
        if points.is_empty() {
            return Err(wrong(None, "there are no rows".to_owned()));
        }
        let name = path.file_stem().unwrap_or_default();
        Ok(Self {
            name: name.to_string_lossy().into_owned(),
            points,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Experiment, ReportError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("SW301.csv");
        std::fs::write(&path, text).unwrap();
        Experiment::read(&path)
    }

    #[test]
    fn columns_are_found_by_name_and_comments_passed_over() {
        let plain = read("# measured\ndisplacement_mm, force_kN\n0, 0\n# again\n1.5,20\n").unwrap();
        assert_eq!(plain.points, [(0.0, 0.0), (1.5, 20.0)]);
        assert_eq!(plain.name, "SW301");
        let other = read("drift,horizontal_force_kN,top_displacement_mm\n1,2,3\n").unwrap();
        assert_eq!(other.points, [(3.0, 2.0)]);
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        for (text, said) in [
            ("u,force_kN\n0,0\n", "no column displacement_mm"),
            ("displacement_mm,force_kN\n", "no rows"),
            ("", "no column"),
            ("#\ndisplacement_mm,force_kN\n0,0\n1,x\n", "csv:4: `x`"),
            ("displacement_mm,force_kN\n0,inf\n", "csv:2: `inf`"),
            ("displacement_mm,force_kN\n0\n", "csv:2: ``"),
        ] {
            let error = read(text).unwrap_err().to_string();
            assert!(error.contains(said), "{text:?}: {error}");
        }
        assert!(Experiment::read(Path::new("not/there.csv")).is_err());
    }
}
