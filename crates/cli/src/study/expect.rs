//! Expected results of a run, and their differences from the computed ones.

use super::curve::{self, Point};
use super::history::History;

/// Quantity of a run that is compared: a number or a curve. Columns are those of `history.csv`.
#[derive(Clone, Debug, PartialEq)]
pub enum Measure {
    /// Largest value of a column.
    Peak(String),
    /// Smallest value of a column.
    Trough(String),
    /// Last value of a column.
    Final(String),
    /// Value of `column` where `of` first crosses `value`, linear between rows.
    At {
        /// Column that is read.
        column: String,
        /// Column that crosses the value.
        of: String,
        /// Value to cross.
        value: f64,
    },
    /// Time at which `column` first crosses `reaches`, linear between rows [s].
    When {
        /// Column that crosses the value.
        column: String,
        /// Value to cross.
        reaches: f64,
    },
    /// ∫ `column` d`x` by the trapezoidal rule; kN over mm gives J.
    Area {
        /// Ordinate.
        column: String,
        /// Abscissa.
        x: String,
    },
    /// Last value of `column` over the last value of `over`; without `over`, over the largest magnitude of
    /// `column`.
    Ratio {
        /// Numerator.
        column: String,
        /// Denominator.
        over: Option<String>,
    },
    /// Difference from a reference curve, see [`Expectation::measure`].
    Curve {
        /// Abscissa.
        x: String,
        /// Ordinate.
        y: String,
        /// Points of the reference. `[point][x, y]`
        reference: Vec<Point>,
    },
}

impl Measure {
    /// Columns read by this measure.
    pub fn columns(&self) -> impl Iterator<Item = &str> {
        let (one, other) = match self {
            Self::Peak(column)
            | Self::Trough(column)
            | Self::Final(column)
            | Self::When { column, .. } => (column, None),
            Self::At { column, of, .. } => (column, Some(of)),
            Self::Area { column, x } => (column, Some(x)),
            Self::Ratio { column, over } => (column, over.as_ref()),
            Self::Curve { x, y, .. } => (x, Some(y)),
        };
        std::iter::once(one).chain(other).map(String::as_str)
    }
}

/// Required value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Wanted {
    /// |value/reference − 1| must not exceed the tolerance: (reference, tolerance [-]).
    Relative(f64, f64),
    /// |value − reference| must not exceed the tolerance, in the unit of the value: (reference, tolerance).
    Absolute(f64, f64),
    /// The value must lie within these bounds, in its unit.
    Between(f64, f64),
    /// The difference from a curve must not exceed this [-].
    Within(f64),
    /// No requirement: the value is only reported. It must be finite.
    Reported,
}

/// One expectation of a case.
#[derive(Clone, Debug, PartialEq)]
pub struct Expectation {
    /// Name of the expectation in its case.
    pub name: String,
    /// Measured quantity.
    pub measure: Measure,
    /// Required value.
    pub wanted: Wanted,
    /// Steps whose rows are read, from 0; all if none are given.
    pub steps: Option<Vec<usize>>,
    /// Whether the expectation applies to the short form.
    pub of_short: bool,
    /// Whether the expectation applies to the full form.
    pub of_full: bool,
    /// Reason for the size of the tolerance.
    pub why: String,
}

/// Comparison of a run with one expectation.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Value of the run; NaN if the run has none.
    pub value: f64,
    /// Relative error, or difference from the curve [-]; none for absolute tolerances and bounds.
    pub error: Option<f64>,
    /// Whether the expectation holds.
    pub holds: bool,
    /// Name, value and error in words.
    pub text: String,
}

impl Expectation {
    /// Whether the expectation applies to the short form (`short`) or the full form.
    pub fn holds_of(&self, short: bool) -> bool {
        if short { self.of_short } else { self.of_full }
    }

    /// Measures the quantity in a run and compares it. A curve is compared as in `curve::difference`: by the
    /// root mean square of the difference over the largest |y| of the reference if the reference advances in x,
    /// and by the largest distance from the reference polyline, both axes over their ranges, if it turns back.
    pub fn measure(&self, history: &History) -> Measured {
        let name = &self.name;
        let value = match self.value(history) {
            Ok(value) => value,
            Err(why) => {
                return Measured {
                    value: f64::NAN,
                    error: None,
                    holds: false,
                    text: format!("{name}: {why}"),
                };
            }
        };
        // A NaN fulfils no requirement.
        let (error, holds, text) = match self.wanted {
            Wanted::Relative(reference, tolerance) => {
                let error = value / reference - 1.0;
                let text = format!(
                    "{name} {value:.5}, {} of {reference:.5} (± {})",
                    percent(error),
                    percent(tolerance).trim_start_matches('+')
                );
                (Some(error), error.abs() <= tolerance, text)
            }
            Wanted::Absolute(reference, tolerance) => {
                let holds = (value - reference).abs() <= tolerance;
                let not = if holds { "" } else { "not " };
                let text = format!("{name} {value:.4e}, {not}{reference:.4e} ± {tolerance:.1e}");
                (None, holds, text)
            }
            Wanted::Between(low, high) => {
                let holds = low <= value && value <= high;
                let not = if holds { "" } else { "not " };
                let text = format!("{name} {value:.5}, {not}in {}", bounds(low, high));
                (None, holds, text)
            }
            Wanted::Reported => (None, value.is_finite(), format!("{name} {value:.5}")),
            Wanted::Within(tolerance) => {
                let text = format!(
                    "{name} {} off (at most {})",
                    percent(value).trim_start_matches('+'),
                    percent(tolerance).trim_start_matches('+')
                );
                (Some(value), value <= tolerance, text)
            }
        };
        Measured {
            value,
            error,
            holds,
            text,
        }
    }

    fn value(&self, history: &History) -> Result<f64, String> {
        let rows = history.rows(self.steps.as_deref());
        let (Some(&first), Some(&last)) = (rows.first(), rows.last()) else {
            return Err("no increment of its steps".to_owned());
        };
        let all = |name: &str| {
            let column = history.column(name);
            rows.iter().map(move |&i| column[i])
        };
        match &self.measure {
            Measure::Peak(column) => Ok(all(column).fold(f64::NEG_INFINITY, larger)),
            Measure::Trough(column) => Ok(-all(column).map(|v| -v).fold(f64::NEG_INFINITY, larger)),
            Measure::Final(column) => Ok(history.column(column)[last]),
            Measure::At { column, of, value } => crossing(history, &rows, of, *value, column),
            Measure::When { column, reaches } => crossing(history, &rows, column, *reaches, "time"),
            Measure::Area { column, x } => {
                let (y, x) = ((history.column(column), column), (history.column(x), x));
                let mean = |i: usize| 0.5 * (history.before(y.1, i) + y.0[i]);
                let width = |i: usize| x.0[i] - history.before(x.1, i);
                Ok(rows.iter().map(|&i| mean(i) * width(i)).sum())
            }
            Measure::Ratio { column, over } => {
                let value = history.column(column)[last];
                Ok(value
                    / match over {
                        Some(over) => history.column(over)[last],
                        None => all(column).map(f64::abs).fold(0.0, larger),
                    })
            }
            Measure::Curve { x, y, reference } => {
                debug_assert!(first <= last);
                let run: Vec<Point> = all(x).zip(all(y)).map(|(x, y)| [x, y]).collect();
                curve::difference(&run, reference)
            }
        }
    }
}

/// The larger of two numbers; NaN if one of them is NaN.
fn larger(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

/// Value of `column` where `of` first crosses `value` in these rows, by linear interpolation from the row before.
fn crossing(
    history: &History,
    rows: &[usize],
    of: &str,
    value: f64,
    column: &str,
) -> Result<f64, String> {
    for &i in rows {
        let (from, to) = (history.before(of, i), history.column(of)[i]);
        let crosses = (from < value && value <= to) || (to <= value && value < from);
        if crosses {
            let part = (value - from) / (to - from);
            let before = history.before(column, i);
            return Ok(before + part * (history.column(column)[i] - before));
        }
    }
    Err(format!("{of} never reaches {value}"))
}

/// A fraction as a signed percentage with two significant digits.
pub fn percent(fraction: f64) -> String {
    let percent = 100.0 * fraction;
    let size = percent.abs();
    if !percent.is_finite() {
        "none".to_owned()
    } else if size >= 10.0 {
        format!("{percent:+.0} %")
    } else if size >= 0.1 {
        format!("{percent:+.1} %")
    } else if size >= 0.01 || size == 0.0 {
        format!("{percent:+.2} %")
    } else {
        format!("{percent:+.0e} %")
    }
}

fn bounds(low: f64, high: f64) -> String {
    if low == f64::NEG_INFINITY {
        format!("at most {high}")
    } else if high == f64::INFINITY {
        format!("at least {low}")
    } else {
        format!("{low} to {high}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wythe_core::state::HistoryRow;

    /// A triangular curve: 0, 1, 2, 1, 0 kN over 0 … 4 mm, one second per row; the last two rows are step 1.
    fn tent() -> Vec<HistoryRow> {
        [0.0, 1.0, 2.0, 1.0, 0.0]
            .into_iter()
            .enumerate()
            .map(|(i, force)| HistoryRow {
                increment: i + 1,
                step: usize::from(i > 2),
                time: i as f64,
                displacement_mm: i as f64,
                force_kN: force,
                ..HistoryRow::default()
            })
            .collect()
    }

    fn value(measure: Measure, steps: Option<Vec<usize>>) -> f64 {
        expectation(
            measure,
            Wanted::Between(f64::NEG_INFINITY, f64::INFINITY),
            steps,
        )
        .measure(&History::new(&tent(), &[]))
        .value
    }

    fn expectation(measure: Measure, wanted: Wanted, steps: Option<Vec<usize>>) -> Expectation {
        Expectation {
            name: "it".to_owned(),
            measure,
            wanted,
            steps,
            of_short: true,
            of_full: true,
            why: String::new(),
        }
    }

    #[test]
    fn a_tent_is_read_by_hand() {
        let force = || "force_kN".to_owned();
        let way = || "displacement_mm".to_owned();
        let second = || Some(vec![1]);
        assert_eq!(value(Measure::Peak(force()), None), 2.0);
        assert_eq!(value(Measure::Peak(force()), second()), 1.0);
        assert_eq!(value(Measure::Trough(force()), None), 0.0);
        assert_eq!(value(Measure::Final(way()), None), 4.0);
        let at = |value| Measure::At {
            column: force(),
            of: way(),
            value,
        };
        assert_eq!(value(at(1.5), None), 1.5);
        // The second step begins at the last row of the first.
        assert_eq!(value(at(2.25), second()), 1.75);
        let when = |reaches| Measure::When {
            column: force(),
            reaches,
        };
        assert_eq!(value(when(1.25), None), 1.25);
        assert_eq!(value(when(1.25), second()), 2.75);
        assert!(value(when(7.0), None).is_nan());
        let area = Measure::Area {
            column: force(),
            x: way(),
        };
        assert_eq!(value(area.clone(), None), 4.0);
        assert_eq!(value(area, second()), 2.0);
        let ratio = |over| Measure::Ratio {
            column: force(),
            over,
        };
        assert_eq!(value(ratio(None), Some(vec![0])), 1.0);
        assert_eq!(value(ratio(Some(way())), Some(vec![0])), 1.0);
    }

    #[test]
    fn a_wrong_reference_does_not_hold_and_neither_does_nan() {
        let peak = || Measure::Peak("force_kN".to_owned());
        let holds = |wanted, rows: &[HistoryRow]| {
            expectation(peak(), wanted, None)
                .measure(&History::new(rows, &[]))
                .holds
        };
        let mut rows = tent();
        for (wanted, right) in [
            (Wanted::Relative(2.0, 0.01), true),
            (Wanted::Relative(2.03, 0.01), false),
            (Wanted::Relative(-2.0, 0.01), false),
            (Wanted::Absolute(2.05, 0.1), true),
            (Wanted::Absolute(2.15, 0.1), false),
            (Wanted::Between(1.9, 2.1), true),
            (Wanted::Between(2.1, f64::INFINITY), false),
        ] {
            assert_eq!(holds(wanted, &rows), right, "{wanted:?}");
        }
        rows[1].force_kN = f64::NAN;
        for wanted in [
            Wanted::Relative(2.0, 1e9),
            Wanted::Absolute(2.0, 1e9),
            Wanted::Between(f64::NEG_INFINITY, f64::INFINITY),
        ] {
            assert!(!holds(wanted, &rows), "{wanted:?}");
        }
        assert!(!holds(Wanted::Relative(2.0, 1e9), &[]));
    }

    #[test]
    fn what_is_told_names_the_value_and_its_error() {
        let measure = Measure::Peak("force_kN".to_owned());
        let told = expectation(measure, Wanted::Relative(1.9, 0.01), None)
            .measure(&History::new(&tent(), &[]))
            .text;
        assert_eq!(told, "it 2.00000, +5.3 % of 1.90000 (± 1.0 %)");
        assert_eq!(percent(0.0), "+0.00 %");
        assert_eq!(percent(-1.2e-6), "-1e-4 %");
        assert_eq!(percent(1.5), "+150 %");
    }
}
