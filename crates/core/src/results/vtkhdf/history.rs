//! `/history`: the columns of `history.csv` and the reactions, one row per increment.
//!
//! Rows are kept in memory until a frame is written, and then each series grows by all of them at once. About thirty
//! writes per increment would cost more than the increments of a small model.

use hdf5_metno as hdf5;
use hdf5_metno::types::FixedAscii;
use ndarray::ArrayView2;
use serde_json::{Map, Value};

use super::series::{SERIES_CHUNK, count, counts, cut, mark_unit, push, reals};
use crate::model::Model;
use crate::state::HistoryRow;

/// Group of the history in the file.
pub const HISTORY: &str = "history";
/// Increment of each frame. `[frame]`
pub const FRAME_INCREMENT: &str = "frame_increment";

/// Text of a fixed length that suffices for the name of a procedure.
type Word = FixedAscii<32>;

/// Writer of the rows of increments.
#[derive(Debug)]
pub struct History {
    columns: Vec<(String, Kind, hdf5::Dataset)>,
    /// Series of the probes, `[probe]`, each `[increment]`.
    probes: Vec<hdf5::Dataset>,
    /// Forces of beams, supports and loads, `[beam, support, load]`, each `[increment][xyz]`.
    reactions: Vec<hdf5::Dataset>,
    /// Increment of each frame. `[frame]`
    frame_increment: hdf5::Dataset,
    /// Number of rows written.
    rows: usize,
    waiting: Vec<HistoryRow>,
}

/// Type of the values of a column.
#[derive(Clone, Copy, Debug)]
enum Kind {
    Whole,
    Real,
    Word,
}

/// Columns of every history, in the order of the fields of [`HistoryRow`].
fn columns() -> impl Iterator<Item = (String, Kind)> {
    let kind = |value: &Value| match value {
        Value::Number(number) if !number.is_f64() => Kind::Whole,
        Value::String(_) => Kind::Word,
        _ => Kind::Real,
    };
    as_map(&HistoryRow::default())
        .into_iter()
        .map(move |(name, value)| (name, kind(&value)))
}

/// Converts a row to a map from names to values.
fn as_map(row: &HistoryRow) -> Map<String, Value> {
    match serde_json::to_value(row) {
        Ok(Value::Object(map)) => map,
        _ => Map::new(),
    }
}

/// Unit of a column, from the suffix of its name.
fn unit_of(column: &str) -> &'static str {
    const ENDS: [(&str, &str); 8] = [
        ("_mm_per_s", "mm/s"),
        ("_N_per_mm", "N/mm"),
        ("_mm2", "mm2"),
        ("_MPa", "MPa"),
        ("_mm", "mm"),
        ("_kNm", "kN m"),
        ("_kN", "kN"),
        ("_J", "J"),
    ];
    match ENDS.iter().find(|(end, _)| column.ends_with(end)) {
        Some((_, unit)) => unit,
        None if column == "time" => "s",
        None => "1",
    }
}

/// Unique paths of the reactions in the group. Characters with a meaning in HDF5 paths are replaced.
fn reaction_names(model: &Model) -> Vec<String> {
    let beams = model.beams.iter().map(|b| ("beams", &b.name));
    let supports = model.supports.iter().map(|s| ("supports", &s.name));
    let loads = model.loads.iter().map(|l| ("loads", &l.name));
    let mut names: Vec<String> = Vec::new();
    for (group, name) in beams.chain(supports).chain(loads) {
        let plain = name.replace(['/', '\0'], "_");
        let plain = if plain.trim_matches('.').is_empty() {
            "_"
        } else {
            &plain
        };
        let mut path = format!("{group}/{plain}");
        let mut number = 2;
        while names.contains(&path) {
            path = format!("{group}/{plain} ({number})");
            number += 1;
        }
        names.push(path);
    }
    names
}

impl History {
    /// Creates the series in a new group of the file.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn create(file: &hdf5::File, model: &Model) -> hdf5::Result<Self> {
        let group = file.create_group(HISTORY)?;
        for name in ["beams", "supports"] {
            group.create_group(name)?;
        }
        if !model.loads.is_empty() {
            group.create_group("loads")?;
        }
        let mut history = Self {
            columns: Vec::new(),
            probes: Vec::new(),
            reactions: Vec::new(),
            frame_increment: counts(&group, FRAME_INCREMENT)?,
            rows: 0,
            waiting: Vec::new(),
        };
        mark_unit(&history.frame_increment, "1")?;
        for (name, kind) in columns() {
            let series = match kind {
                Kind::Whole => counts(&group, &name)?,
                Kind::Real => reals(&group, &name)?,
                Kind::Word => group
                    .new_dataset::<Word>()
                    .chunk(SERIES_CHUNK)
                    .shape(0..)
                    .create(name.as_str())?,
            };
            mark_unit(&series, unit_of(&name))?;
            history.columns.push((name, kind, series));
        }
        for column in model.columns() {
            let series = reals(&group, &column)?;
            mark_unit(&series, unit_of(&column))?;
            history.probes.push(series);
        }
        for name in reaction_names(model) {
            let series = group
                .new_dataset::<f64>()
                .chunk((SERIES_CHUNK, 3))
                .shape((0.., 3))
                .create(name.as_str())?;
            mark_unit(&series, "N")?;
            history.reactions.push(series);
        }
        Ok(history)
    }

    /// Opens the series of a run of this model and drops everything after an increment and a number of frames.
    ///
    /// # Errors
    /// The file cannot be read or written, or it has another history.
    pub fn open(
        file: &hdf5::File,
        model: &Model,
        (increment, frames): (usize, usize),
    ) -> hdf5::Result<Self> {
        let group = file.group(HISTORY)?;
        let rows = until(&group.dataset("increment")?, increment)?;
        let series = |name: &str, length: usize| {
            let series = group.dataset(name)?;
            cut(&series, length).map(|()| series)
        };
        Ok(Self {
            columns: columns()
                .map(|(name, kind)| series(&name, rows).map(|s| (name, kind, s)))
                .collect::<hdf5::Result<_>>()?,
            probes: model
                .columns()
                .iter()
                .map(|column| series(column, rows))
                .collect::<hdf5::Result<_>>()?,
            reactions: reaction_names(model)
                .iter()
                .map(|name| series(name, rows))
                .collect::<hdf5::Result<_>>()?,
            frame_increment: series(FRAME_INCREMENT, frames)?,
            rows,
            waiting: Vec::new(),
        })
    }

    /// Adds a row; it is written with the next frame.
    pub fn push(&mut self, row: &HistoryRow) {
        self.waiting.push(row.clone());
    }

    /// Stores the increment of a frame.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn frame(&self, frame: usize, increment: usize) -> hdf5::Result<()> {
        push(&self.frame_increment, frame, count(increment))
    }

    /// Writes the pending rows. Missing values become NaN.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&mut self) -> hdf5::Result<()> {
        let (from, to) = (self.rows, self.rows + self.waiting.len());
        if from == to {
            return Ok(());
        }
        let maps: Vec<_> = self.waiting.iter().map(as_map).collect();
        for (name, kind, series) in &self.columns {
            series.resize(to)?;
            let values = maps.iter().map(|map| map.get(name));
            match kind {
                Kind::Whole => {
                    let whole = values.map(|v| v.and_then(Value::as_i64).unwrap_or(i64::MAX));
                    series.write_slice(&whole.collect::<Vec<_>>(), from..to)?;
                }
                Kind::Real => {
                    let real = values.map(|v| v.and_then(Value::as_f64).unwrap_or(f64::NAN));
                    series.write_slice(&real.collect::<Vec<_>>(), from..to)?;
                }
                Kind::Word => {
                    let word = |v: Option<&Value>| {
                        let text = v.and_then(Value::as_str).unwrap_or_default();
                        Word::from_ascii(text.as_bytes())
                            .map_err(|error| format!("cannot store {text:?}: {error}").into())
                    };
                    let words = values.map(word).collect::<hdf5::Result<Vec<_>>>()?;
                    series.write_slice(&words, from..to)?;
                }
            }
        }
        for (p, series) in self.probes.iter().enumerate() {
            let of = |row: &HistoryRow| row.probes.get(p).copied().unwrap_or(f64::NAN);
            series.resize(to)?;
            series.write_slice(&self.waiting.iter().map(of).collect::<Vec<_>>(), from..to)?;
        }
        for (r, series) in self.reactions.iter().enumerate() {
            let of = |row: &HistoryRow| row.reactions.get(r).copied().unwrap_or([f64::NAN; 3]);
            let forces: Vec<[f64; 3]> = self.waiting.iter().map(of).collect();
            series.resize((to, 3))?;
            series.write_slice(ArrayView2::from(forces.as_slice()), (from..to, ..))?;
        }
        self.rows = to;
        self.waiting.clear();
        Ok(())
    }
}

/// First `count` rows without reactions.
///
/// # Errors
/// There are fewer rows, a value is invalid, or the file cannot be read.
pub fn read(file: &hdf5::File, model: &Model, count: usize) -> hdf5::Result<Vec<HistoryRow>> {
    let group = file.group(HISTORY)?;
    let mut maps = vec![Map::new(); count];
    for (name, kind) in columns() {
        let series = group.dataset(&name)?;
        if series.shape() != [series.size()] || series.size() < count {
            return Err(format!("{} has not {count} values", series.name()).into());
        }
        let values: Vec<Value> = match kind {
            Kind::Whole => {
                let whole = series.read_slice_1d::<i64, _>(0..count)?;
                whole.iter().map(|n| Value::from(*n)).collect()
            }
            Kind::Real => {
                let real = series.read_slice_1d::<f64, _>(0..count)?;
                real.iter().map(|x| Value::from(*x)).collect()
            }
            Kind::Word => {
                let words = series.read_slice_1d::<Word, _>(0..count)?;
                words
                    .iter()
                    .map(|word| Value::from(word.as_str()))
                    .collect()
            }
        };
        for (map, value) in maps.iter_mut().zip(values) {
            map.insert(name.clone(), value);
        }
    }
    let of_map = |map| serde_json::from_value(Value::Object(map)).map_err(|e| e.to_string().into());
    let mut rows: Vec<HistoryRow> = maps.into_iter().map(of_map).collect::<hdf5::Result<_>>()?;
    for column in model.columns() {
        let series = group.dataset(&column)?;
        if series.size() < count {
            return Err(format!("{} has not {count} values", series.name()).into());
        }
        let values = series.read_slice_1d::<f64, _>(0..count)?;
        for (row, value) in rows.iter_mut().zip(&values) {
            row.probes.push(*value);
        }
    }
    Ok(rows)
}

/// Number of frames up to an increment.
///
/// # Errors
/// The file cannot be read.
pub fn frames_until(file: &hdf5::File, increment: usize) -> hdf5::Result<usize> {
    until(&file.group(HISTORY)?.dataset(FRAME_INCREMENT)?, increment)
}

/// Number of entries in ascending `increments` that are at most `last`.
fn until(increments: &hdf5::Dataset, last: usize) -> hdf5::Result<usize> {
    let last = count(last);
    Ok(increments
        .read_raw::<i64>()?
        .partition_point(|&increment| increment <= last))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::scene::{Beam, HeldBy, Support};
    use crate::results::fake;

    #[test]
    fn every_column_has_a_unit_and_names_are_plain() {
        let unit = |name| unit_of(name);
        assert_eq!(unit("force_kN"), "kN");
        assert_eq!(unit("external_work_J"), "J");
        assert_eq!(unit("contact_area_mm2"), "mm2");
        assert_eq!(unit("top_mm_per_s"), "mm/s");
        assert_eq!(
            (unit("time"), unit("increment"), unit("load_factor")),
            ("s", "1", "1")
        );
        let mut model = fake::model();
        let held = |name: &str| Support {
            name: name.to_owned(),
            nodes: vec![0],
            fixed: [true; 3],
            by: HeldBy::Ground,
        };
        model.supports = ["a/b", "a_b", "..", "base"].map(held).into();
        model.beams = vec![Beam {
            name: "base".to_owned(),
            nodes: vec![1],
            area: 1.0,
            normal: [0.0, 0.0, 1.0],
            shape: Vec::new(),
            free: Vec::new(),
            depth: 0.0,
        }];
        assert_eq!(
            reaction_names(&model),
            [
                "beams/base",
                "supports/a_b",
                "supports/a_b (2)",
                "supports/_",
                "supports/base"
            ]
        );
    }
}
