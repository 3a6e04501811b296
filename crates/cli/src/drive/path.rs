//! Prescribed path of a point: a CSV file with `#` comments and a header, with columns in any order.

use miette::{Diagnostic, NamedSource, SourceSpan};
use wythe_core::point::{Layout, Row, Target};

/// Column of the time [s].
const TIME: &str = "time";

/// A path that was read and checked.
#[derive(Clone, Debug)]
pub struct Path<const N: usize> {
    /// Names of all columns, in the file's order.
    pub header: Vec<String>,
    /// All cells as written. `[row][column]`
    pub cells: Vec<Vec<String>>,
    /// Times and targets of the rows.
    pub rows: Vec<Row<N>>,
    /// Line of each row in the file, counted from 1. `[row]`
    pub lines: Vec<u64>,
    /// Whether a component is driven by stress. `[component]`
    pub by_stress: [bool; N],
}

/// An error in a path, with its place.
#[derive(Debug, thiserror::Error, Diagnostic)]
#[error("{}:{line}{}: {what}", source_code.name(), in_column(column.as_deref()))]
pub struct PathError {
    line: u64,
    column: Option<String>,
    what: String,
    #[help]
    help: String,
    #[source_code]
    source_code: NamedSource<String>,
    #[label("here")]
    span: Option<SourceSpan>,
}

fn in_column(column: Option<&str>) -> String {
    column.map_or_else(String::new, |name| format!(", column {name}"))
}

/// Text of a path and name of its file, for error messages.
struct Source<'a> {
    file: &'a str,
    text: &'a str,
}

impl Source<'_> {
    /// Creates an error about cell `cell` of `line`, or about the whole line.
    fn error(
        &self,
        line: u64,
        cell: Option<(usize, &str)>,
        what: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<PathError> {
        Box::new(PathError {
            line,
            column: cell.map(|(_, name)| name.to_owned()),
            what: what.into(),
            help: help.into(),
            source_code: NamedSource::new(self.file, self.text.to_owned()),
            span: self.span(line, cell.map(|(index, _)| index)),
        })
    }

    /// Line of the record at `position`. The reader counts from the comments and empty lines before the record.
    fn line(&self, position: &csv::Position) -> u64 {
        let start = usize::try_from(position.byte()).unwrap_or(usize::MAX);
        let rest = self.text.get(start..).unwrap_or_default().lines();
        position.line()
            + rest
                .take_while(|l| l.is_empty() || l.starts_with('#'))
                .count() as u64
    }

    /// Bytes of a cell, or of the line. Cells in quotes with commas are ignored, because numbers have none.
    fn span(&self, line: u64, cell: Option<usize>) -> Option<SourceSpan> {
        let index = usize::try_from(line).ok()?.checked_sub(1)?;
        let start: usize = self
            .text
            .split_inclusive('\n')
            .take(index)
            .map(str::len)
            .sum();
        let content = self.text.get(start..)?.lines().next()?;
        let Some(cell) = cell else {
            return Some((start, content.len()).into());
        };
        let before: usize = content.split(',').take(cell).map(|c| c.len() + 1).sum();
        let width = content.split(',').nth(cell)?.len();
        Some((start + before, width).into())
    }
}

/// Column indices of the components and of the time.
struct Columns<const N: usize> {
    targets: [usize; N],
    time: Option<usize>,
}

impl<const N: usize> Path<N> {
    /// Reads a path from the text of `file`. `stress` names the components that are driven by their stress column;
    /// the others need their strain column. Further columns are kept.
    ///
    /// # Errors
    /// [`PathError`]: an unknown component, a missing column, a row of another length, a value that is not a finite
    /// number, a time that decreases, no rows.
    pub fn read(
        file: &str,
        text: &str,
        layout: &Layout<N>,
        stress: &[String],
    ) -> Result<Self, Box<PathError>> {
        // Spreadsheets write a byte order mark before the first name.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let source = Source { file, text };
        let by_stress = chosen(&source, layout, stress)?;
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let header = reader
            .headers()
            .map_err(|error| source.csv(&error))?
            .clone();
        let head_line = header.position().map_or(1, |p| source.line(p));
        let columns = columns(&source, layout, by_stress, &header, head_line)?;
        let (mut rows, mut lines, mut cells) = (Vec::new(), Vec::new(), Vec::new());
        let mut last_time = 0.0;
        for record in reader.records() {
            let record = record.map_err(|error| source.csv(&error))?;
            let line = record.position().map_or(0, |p| source.line(p));
            let number = |index: usize| number(&source, &header, &record, line, index);
            let mut targets = [Target::Strain(0.0); N];
            for i in 0..N {
                let value = number(columns.targets[i])?;
                targets[i] = if by_stress[i] {
                    Target::Stress(value)
                } else {
                    Target::Strain(value)
                };
            }
            let time = match columns.time {
                Some(index) => number(index)?,
                None => rows.len() as f64 + 1.0,
            };
            if time < last_time {
                return Err(source.error(
                    line,
                    columns.time.map(|index| (index, TIME)),
                    format!("time runs backwards, from {last_time} to {time}"),
                    "time begins at 0 before the first row and does not decrease",
                ));
            }
            last_time = time;
            rows.push(Row { time, targets });
            lines.push(line);
            cells.push(record.iter().map(str::to_owned).collect());
        }
        if rows.is_empty() {
            let help = "below the header one row a step, e.g. 0.0001,0,0,0,0,0";
            return Err(source.error(head_line, None, "the path has no rows", help));
        }
        Ok(Self {
            header: header.iter().map(str::to_owned).collect(),
            cells,
            rows,
            lines,
            by_stress,
        })
    }
}

/// Components that `--stress` names.
fn chosen<const N: usize>(
    source: &Source<'_>,
    layout: &Layout<N>,
    stress: &[String],
) -> Result<[bool; N], Box<PathError>> {
    let mut by_stress = [false; N];
    for name in stress {
        let Some(i) = layout.components.iter().position(|c| c == name) else {
            return Err(source.error(
                1,
                None,
                format!("--stress {name}: there is no such component"),
                format!("the components are {}", layout.components.join(", ")),
            ));
        };
        by_stress[i] = true;
    }
    Ok(by_stress)
}

fn columns<const N: usize>(
    source: &Source<'_>,
    layout: &Layout<N>,
    by_stress: [bool; N],
    header: &csv::StringRecord,
    line: u64,
) -> Result<Columns<N>, Box<PathError>> {
    let find = |name: &str| -> Result<Option<usize>, Box<PathError>> {
        let mut places = header
            .iter()
            .enumerate()
            .filter(|(_, h)| *h == name)
            .map(|(i, _)| i);
        let first = places.next();
        match places.next() {
            Some(second) => Err(source.error(
                line,
                Some((second, name)),
                "this column is there twice",
                "rename or remove one of them",
            )),
            None => Ok(first),
        }
    };
    let mut targets = [0; N];
    for i in 0..N {
        let (strain, stress, component) =
            (layout.strains[i], layout.stresses[i], layout.components[i]);
        let name = if by_stress[i] { stress } else { strain };
        targets[i] = find(name)?.ok_or_else(|| {
            let help = if header.len() == 1 && header[0].contains([';', '\t']) {
                "separate the cells by commas".to_owned()
            } else if by_stress[i] {
                format!("--stress {component} takes its values from a column {stress}")
            } else {
                format!("add the column {strain}, or --stress {component} and a column {stress}")
            };
            source.error(line, None, format!("the column {name} is missing"), help)
        })?;
    }
    Ok(Columns {
        targets,
        time: find(TIME)?,
    })
}

fn number(
    source: &Source<'_>,
    header: &csv::StringRecord,
    record: &csv::StringRecord,
    line: u64,
    index: usize,
) -> Result<f64, Box<PathError>> {
    let text = &record[index];
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        other => Err(source.error(
            line,
            Some((index, &header[index])),
            match other {
                Ok(value) => format!("{value} is not a finite number"),
                Err(_) if text.is_empty() => "a number is missing".to_owned(),
                Err(_) => format!("{text:?} is not a number"),
            },
            "write a plain number such as -1.5e-4",
        )),
    }
}

impl Source<'_> {
    fn csv(&self, error: &csv::Error) -> Box<PathError> {
        let line = error.position().map_or(1, |p| self.line(p));
        match error.kind() {
            csv::ErrorKind::UnequalLengths {
                expected_len, len, ..
            } => self.error(
                line,
                None,
                format!("this row has {len} cells, the header has {expected_len}"),
                "give every row a cell for every column",
            ),
            _ => self.error(
                line,
                None,
                error.to_string(),
                "see that the file is plain CSV",
            ),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wythe_core::point::INTERFACE;

    fn read(text: &str, stress: &[&str]) -> Result<Path<3>, Box<PathError>> {
        let stress: Vec<String> = stress.iter().map(|&s| s.to_owned()).collect();
        Path::read("path.csv", text, &INTERFACE, &stress)
    }

    #[test]
    fn columns_come_in_any_order_among_others_and_below_comments() {
        let text = "# a test\nnote, d2_mm,u_mm ,d1_mm\n a,3,1,2\n# half way\nb,6,4,5\n";
        let path = read(text, &[]).unwrap();
        let strains = |a, b, c| [a, b, c].map(Target::Strain);
        assert_eq!(
            path.rows[0],
            Row {
                time: 1.0,
                targets: strains(1.0, 2.0, 3.0)
            }
        );
        assert_eq!(
            path.rows[1],
            Row {
                time: 2.0,
                targets: strains(4.0, 5.0, 6.0)
            }
        );
        assert_eq!(path.lines, [3, 5]);
        assert_eq!(path.cells[1], ["b", "6", "4", "5"]);
    }

    #[test]
    fn strain_columns_rule_unless_stress_is_asked_for() {
        let text = "time,u_mm,d1_mm,d2_mm,sig_MPa\n0.5,1,2,3,-0.5\n";
        assert_eq!(
            read(text, &[]).unwrap().rows[0].targets[0],
            Target::Strain(1.0)
        );
        let path = read(text, &["normal"]).unwrap();
        assert_eq!(path.rows[0].targets[0], Target::Stress(-0.5));
        assert_eq!(path.rows[0].targets[1], Target::Strain(2.0));
        assert_eq!(path.rows[0].time, 0.5);
        // With --stress, the strain column may be missing.
        assert!(read("d1_mm,d2_mm,sig_MPa\n2,3,-0.5\n", &["normal"]).is_ok());
    }

    #[test]
    #[expect(
        clippy::too_many_lines,
        reason = "a table of wrong files and their messages"
    )]
    fn what_is_wrong_is_said_with_file_line_and_column() {
        let cases: [(&str, &[&str], &str); 10] = [
            (
                "u_mm,d1_mm\n1,2\n",
                &[],
                "path.csv:1: the column d2_mm is missing",
            ),
            (
                "u_mm,d1_mm,d2_mm\n1,2,3\n",
                &["normal"],
                "path.csv:1: the column sig_MPa is missing",
            ),
            (
                "u_mm,d1_mm,d2_mm\n1,2,3\n1,NaN,3\n",
                &[],
                "path.csv:3, column d1_mm: NaN is not a",
            ),
            (
                "u_mm,d1_mm,d2_mm\n1,2,inf\n",
                &[],
                "path.csv:2, column d2_mm: inf is not a",
            ),
            (
                "#\nu_mm,d1_mm,d2_mm\nx,2,3\n",
                &[],
                "path.csv:3, column u_mm: \"x\" is not a number",
            ),
            (
                "u_mm,d1_mm,d2_mm\n,2,3\n",
                &[],
                "path.csv:2, column u_mm: a number is missing",
            ),
            (
                "u_mm,d1_mm,d2_mm\n1,2\n",
                &[],
                "path.csv:2: this row has 2 cells, the header has 3",
            ),
            (
                "u_mm,d1_mm,d2_mm,u_mm\n1,2,3,4\n",
                &[],
                "path.csv:1, column u_mm: this column is",
            ),
            (
                "time,u_mm,d1_mm,d2_mm\n1,0,0,0\n0.5,0,0,0\n",
                &[],
                "path.csv:3, column time: time",
            ),
            (
                "u_mm,d1_mm,d2_mm\n",
                &[],
                "path.csv:1: the path has no rows",
            ),
        ];
        for (text, stress, expected) in cases {
            let error = read(text, stress).unwrap_err();
            assert!(
                error.to_string().starts_with(expected),
                "{error} for {text:?}"
            );
            assert!(error.help().is_some());
        }
        assert!(
            read("", &[])
                .unwrap_err()
                .to_string()
                .contains("u_mm is missing")
        );
        let error = read("u_mm,d1_mm,d2_mm\n1,2,3\n", &["yy"]).unwrap_err();
        assert!(error.to_string().contains("--stress yy"), "{error}");
    }

    #[test]
    fn what_spreadsheets_write_is_read_or_named() {
        let path = read("\u{feff}u_mm,d1_mm,d2_mm\r\n1,2,3\r\n", &[]).unwrap();
        assert_eq!(path.rows[0].targets[0], Target::Strain(1.0));
        let error = read("u_mm;d1_mm;d2_mm\n1;2;3\n", &[]).unwrap_err();
        assert!(error.help.contains("commas"), "{}", error.help);
    }

    #[test]
    fn the_label_points_at_the_cell() {
        let text = "u_mm,d1_mm,d2_mm\n1,2,3\n10,bad,3\n";
        let span = read(text, &[]).unwrap_err().span.unwrap();
        assert_eq!(&text[span.offset()..span.offset() + span.len()], "bad");
    }
}
