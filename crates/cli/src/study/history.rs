//! History of a run as columns of numbers.

use std::collections::BTreeMap;

use serde_json::Value;

use wythe_core::state::HistoryRow;

/// Columns of `history.csv` that hold numbers.
#[derive(Clone, Debug, Default)]
pub struct History {
    /// Values of each column by its name. `[row]`
    columns: BTreeMap<String, Vec<f64>>,
    /// Step of each row. `[row]`
    steps: Vec<usize>,
}

impl History {
    /// Columns of these rows, followed by those of the probes. A number that is not finite becomes NaN.
    pub fn new(rows: &[HistoryRow], probes: &[String]) -> Self {
        let mut history = Self::default();
        for row in rows {
            history.steps.push(row.step);
            let probes = probes.iter().cloned().zip(row.probes.iter().copied());
            for (name, value) in numbers(row).chain(probes) {
                history.columns.entry(name).or_default().push(value);
            }
        }
        history
    }

    /// A table of other numbers, all of one step. `[row][column]`
    pub fn of_columns(names: &[String], rows: &[Vec<f64>]) -> Self {
        let column = |i: usize| rows.iter().filter_map(|row| row.get(i).copied()).collect();
        let columns = names.iter().enumerate();
        Self {
            columns: columns.map(|(i, name)| (name.clone(), column(i))).collect(),
            steps: vec![0; rows.len()],
        }
    }

    /// Names of the columns that hold numbers, without the probes.
    pub fn names() -> Vec<String> {
        numbers(&HistoryRow::default())
            .map(|(name, _)| name)
            .collect()
    }

    /// Values of a column; empty if there are no rows.
    pub fn column(&self, name: &str) -> &[f64] {
        self.columns.get(name).map_or(&[], Vec::as_slice)
    }

    /// Indices of the rows of these steps, in order; all rows if `steps` is none.
    pub fn rows(&self, steps: Option<&[usize]>) -> Vec<usize> {
        let chosen = |i: &usize| steps.is_none_or(|s| s.contains(&self.steps[*i]));
        (0..self.steps.len()).filter(chosen).collect()
    }

    /// Value in the row before row `i`; zero before the first row, where the model is at rest.
    pub fn before(&self, name: &str, i: usize) -> f64 {
        i.checked_sub(1).map_or(0.0, |k| self.column(name)[k])
    }

    /// Row and column of the first number that is not finite.
    pub fn not_finite(&self) -> Option<(usize, &str)> {
        let bad = |values: &Vec<f64>| values.iter().position(|v| !v.is_finite());
        self.columns
            .iter()
            .filter_map(|(name, values)| bad(values).map(|i| (i, name.as_str())))
            .min()
    }
}

/// Fields of a row that hold numbers. JSON has neither NaN nor infinity: they appear as null.
fn numbers(row: &HistoryRow) -> impl Iterator<Item = (String, f64)> {
    let fields = match serde_json::to_value(row) {
        Ok(Value::Object(fields)) => fields,
        // A structure of numbers and texts always becomes an object.
        _ => serde_json::Map::new(),
    };
    fields.into_iter().filter_map(|(name, value)| match value {
        Value::Number(number) => Some((name, number.as_f64().unwrap_or(f64::NAN))),
        Value::Null => Some((name, f64::NAN)),
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_those_of_the_history_and_nan_is_found() {
        let names = History::names();
        for name in ["time", "displacement_mm", "force_kN", "residual"] {
            assert!(names.iter().any(|n| n == name), "{name}");
        }
        let mut rows = vec![HistoryRow::default(); 3];
        rows[1].step = 1;
        rows[2].step = 1;
        assert_eq!(History::new(&rows, &[]).not_finite(), None);
        assert_eq!(History::new(&rows, &[]).rows(Some(&[1])), [1, 2]);
        for bad in [f64::NAN, f64::INFINITY] {
            rows[2].reaction_kN = bad;
            let history = History::new(&rows, &[]);
            assert_eq!(history.not_finite(), Some((2, "reaction_kN")));
        }
        rows[2].reaction_kN = 0.0;
        for (i, row) in rows.iter_mut().enumerate() {
            row.probes = vec![i as f64];
        }
        let history = History::new(&rows, &["way_mm".to_owned()]);
        assert_eq!(history.column("way_mm"), [0.0, 1.0, 2.0]);
    }
}
