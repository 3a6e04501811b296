//! The history in the form used by the charts of the page.

use std::collections::BTreeMap;

use serde::Serialize;

use super::packed;
use crate::results::ReadHistory;
use crate::state::HistoryRow;

/// Largest number of rows on the page, more than the columns of a screen.
pub(super) const ROWS: usize = 2000;
/// Largest number of probes on the page.
const PROBES: usize = 6;

/// Name of a column and its value in a row.
type Column = (&'static str, fn(&HistoryRow) -> f64);

/// Columns shown on the page, with their names in the history.
const COLUMNS: [Column; 19] = [
    ("increment", |r| r.increment as f64),
    ("step", |r| r.step as f64),
    ("time", |r| r.time),
    ("displacement_mm", |r| r.displacement_mm),
    ("force_kN", |r| r.force_kN),
    ("iterations", |r| r.iterations as f64),
    ("cutbacks", |r| r.cutbacks as f64),
    ("external_work_J", |r| r.external_work_J),
    ("elastic_energy_J", |r| r.elastic_energy_J),
    ("plastic_damage_dissipation_J", |r| {
        r.plastic_damage_dissipation_J
    }),
    ("interface_dissipation_J", |r| r.interface_dissipation_J),
    ("viscous_dissipation_J", |r| r.viscous_dissipation_J),
    ("kinetic_energy_J", |r| r.kinetic_energy_J),
    ("damping_dissipation_J", |r| r.damping_dissipation_J),
    ("numerical_dissipation_J", |r| r.numerical_dissipation_J),
    ("residual", |r| r.residual),
    ("out_of_balance", |r| r.out_of_balance),
    ("max_tensile_damage", |r| r.max_tensile_damage),
    ("max_compressive_damage", |r| r.max_compressive_damage),
];

/// Columns of the history. Arrays are little-endian in base64.
#[derive(Debug, Serialize)]
pub(super) struct Series {
    /// Number of rows on the page.
    pub rows: usize,
    /// Columns by name. `[row]` f32
    pub columns: BTreeMap<&'static str, String>,
    /// Procedure of each row, an index into `methods`. `[row]` u8
    pub method: String,
    /// Names of the procedures used.
    pub methods: Vec<&'static str>,
    /// Whether the row belongs to a driven step. `[row]` u8
    pub driven: String,
    /// Row of the largest force.
    pub peak: Option<usize>,
    /// Word for the largest force on the page.
    pub largest: &'static str,
    /// Start of the drive: displacement [mm], force [kN].
    pub start: (f64, f64),
    /// Names and columns of the probes. `[row]` f32
    pub probes: Vec<(String, String)>,
}

/// Rows of the history for the page: all, or [`ROWS`] at even distances together with the required ones.
pub(super) fn chosen(rows: usize, must: impl IntoIterator<Item = usize>) -> Vec<usize> {
    if rows <= ROWS {
        return (0..rows).collect();
    }
    let mut chosen: Vec<usize> = (0..ROWS).map(|i| i * rows / ROWS).collect();
    chosen.extend(must.into_iter().filter(|r| *r < rows));
    chosen.push(rows - 1);
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

/// Row of the peak of the driven steps.
pub(super) fn peak_row(history: &ReadHistory, driven: &[bool]) -> Option<usize> {
    let peak = history.curve().peak()?;
    let rows = driven.iter().enumerate().filter(|(_, driven)| **driven);
    rows.map(|(row, _)| row).nth(peak.index)
}

impl Series {
    /// Series of these rows of the history.
    pub fn of(
        history: &ReadHistory,
        driven: &[bool],
        peak: Option<usize>,
        chosen: &[usize],
    ) -> Self {
        let rows = || chosen.iter().filter_map(|&r| history.rows.get(r));
        let column = |(name, of): Column| (name, packed::floats(rows().map(of)));
        let mut methods = Vec::new();
        let method: Vec<u8> = rows()
            .map(|row| {
                let name = row.procedure.name();
                let known = methods.iter().position(|m| *m == name);
                known.unwrap_or_else(|| {
                    methods.push(name);
                    methods.len() - 1
                }) as u8
            })
            .collect();
        let driven: Vec<u8> = chosen
            .iter()
            .map(|&r| driven.get(r).copied().unwrap_or(false).into())
            .collect();
        let probe = |(i, name): (usize, &String)| {
            let values = rows().map(|r| r.probes.get(i).copied().unwrap_or(f64::NAN));
            (name.clone(), packed::floats(values))
        };
        Self {
            rows: chosen.len(),
            columns: COLUMNS.into_iter().map(column).collect(),
            method: packed::encode(&method),
            methods,
            driven: packed::encode(&driven),
            peak: peak.and_then(|peak| chosen.binary_search(&peak).ok()),
            largest: history.curve().word_of_largest(),
            start: history.curve().start(),
            probes: history
                .probes
                .iter()
                .enumerate()
                .take(PROBES)
                .map(probe)
                .collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::fake;

    #[test]
    fn thinned_histories_keep_the_required_rows() {
        assert_eq!(chosen(3, [1]), [0, 1, 2]);
        let kept = chosen(100_003, [77_777, 100_002, 200_000]);
        assert!(kept.len() <= ROWS + 2 && kept.is_sorted());
        for row in [0, 77_777, 100_002] {
            assert!(kept.contains(&row), "{row}");
        }
    }

    #[test]
    fn the_columns_are_decoded_unchanged() {
        let rows = vec![
            fake::row(1, 0, 0.0, 5.0),
            fake::row(2, 1, 1.0, 20.0),
            fake::row(3, 1, 2.0, 10.0),
        ];
        let history = ReadHistory {
            rows,
            probes: vec!["top_mm".to_owned()],
            steps: None,
        };
        let driven = history.driven();
        assert_eq!(driven, [false, true, true]);
        let peak = peak_row(&history, &driven);
        assert_eq!(peak, Some(1));
        let series = Series::of(&history, &driven, peak, &[0, 1, 2]);
        let bytes = packed::decode(&series.columns["force_kN"]);
        let forces: Vec<f32> = bytes
            .as_chunks::<4>()
            .0
            .iter()
            .map(|b| f32::from_le_bytes(*b))
            .collect();
        assert_eq!(forces, [5.0, 20.0, 10.0]);
        assert_eq!(
            (series.peak, series.start, series.rows),
            (Some(1), (0.0, 5.0), 3)
        );
        assert_eq!(series.methods, ["static"]);
        assert_eq!(packed::decode(&series.driven), [0, 1, 1]);
        // A value missing in a row becomes NaN.
        assert_eq!(packed::decode(&series.probes[0].1).len(), 12);
    }
}
