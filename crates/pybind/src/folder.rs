//! The folder of a run: history, summary, comparison, pictures, report and exports.

use std::path::{Path, PathBuf};

use numpy::Element;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use wythe_core::files::write_whole;
use wythe_core::results;
use wythe_core::results::animation::{self, Animation};
use wythe_core::results::answers::Backbone;
use wythe_core::results::comparison::points_of;
use wythe_core::results::export::{frame_name, table, vtu};
use wythe_core::results::mcap::salvage::salvage as rescue;
use wythe_core::results::plotting::columns::{self, columns};
use wythe_core::results::plotting::deflection::{Along, Deflection, deflections, main_axis};
use wythe_core::results::plotting::{self, Line, load_displacements};
use wythe_core::results::snapshot::Snapshots;
use wythe_core::results::wall_picture::{Look, View, wall_picture};
use wythe_core::results::{
    Experiment, FrameChoice, ReadError, ReadHistory, Report, RunFolder, Snapshot,
};
use wythe_core::state::HistoryRow;

use crate::arrays::{flat, rows};
use crate::errors;

type Columns<'py> = Bound<'py, PyDict>;

/// Columns of the history, and the names of its probes.
#[pyfunction]
pub fn history(py: Python<'_>, folder: PathBuf) -> PyResult<(Columns<'_>, Vec<String>)> {
    let read = py.detach(|| RunFolder::open(&folder)?.history());
    let read = read.map_err(|error| errors::of_reading(py, &error))?;
    let columns = PyDict::new(py);
    let (all, driven) = (&read.rows, read.driven());
    macro_rules! columns {
        ($($name:ident: $kind:ty),* $(,)?) => {$(
            columns.set_item(stringify!($name), column(py, all, |r| r.$name as $kind)?)?;
        )*};
    }
    columns!(
        increment: i64, step: i64, time: f64, displacement_mm: f64, force_kN: f64, reaction_kN: f64,
        iterations: i64, cutbacks: i64, external_work_J: f64, elastic_energy_J: f64,
        plastic_damage_dissipation_J: f64, interface_dissipation_J: f64, viscous_dissipation_J: f64,
        open_points: i64, sliding_points: i64, max_interface_damage: f64, max_tensile_damage: f64,
        max_compressive_damage: f64, out_of_balance: f64, residual: f64, kinetic_energy_J: f64,
        damping_dissipation_J: f64, numerical_dissipation_J: f64, contact_area_mm2: f64,
        load_factor: f64,
    );
    let procedures: Vec<String> = all.iter().map(|r| r.procedure.name().to_owned()).collect();
    columns.set_item("procedure", procedures)?;
    for (i, name) in read.probes.iter().enumerate() {
        columns.set_item(name, column(py, all, |r| r.probes[i])?)?;
    }
    columns.set_item("driven", flat(py, driven)?)?;
    Ok((columns, read.probes))
}

/// The answers of a run as JSON, and in lines: heading and text.
#[pyfunction]
pub fn answers(py: Python<'_>, folder: PathBuf) -> PyResult<(String, Vec<(String, String)>)> {
    let read = py.detach(|| RunFolder::open(&folder)?.answers());
    let answers = read.map_err(|error| errors::of_reading(py, &error))?;
    let lines = answers.lines().into_iter();
    let lines = lines.map(|line| (line.head.to_owned(), line.text));
    let text = serde_json::to_string(&answers);
    let text = text.map_err(|error| errors::bug(&format!("answers as JSON: {error}")))?;
    Ok((text, lines.collect()))
}

/// Points of the curve at drifts [-] over a height [mm], by default that of the answers, as JSON.
#[pyfunction]
#[pyo3(signature = (folder, drifts, height))]
pub fn at_drifts(
    py: Python<'_>,
    folder: PathBuf,
    drifts: Vec<f64>,
    height: Option<f64>,
) -> PyResult<String> {
    let read = py.detach(|| {
        let folder = RunFolder::open(&folder)?;
        let curve = folder.history()?.curve();
        Ok((curve, folder.answers()?.height_mm))
    });
    let (curve, own) = read.map_err(|error: ReadError| errors::of_reading(py, &error))?;
    let side = Backbone::of(&curve, false)
        .ok_or_else(|| PyValueError::new_err("drifts: nothing was driven"))?;
    let height = height.or(own).ok_or_else(|| {
        PyValueError::new_err("height: the model has no clear height: give one [mm]")
    })?;
    let points = results::answers::at_drifts(&side, height, &drifts);
    serde_json::to_string(&points).map_err(|error| errors::bug(&format!("as JSON: {error}")))
}

/// Lines of the estimated error of a run; none if it has no estimate.
#[pyfunction]
pub fn error_lines(py: Python<'_>, folder: PathBuf) -> PyResult<Vec<String>> {
    let read = py.detach(|| RunFolder::open(&folder)?.summary());
    let summary = read.map_err(|error| errors::of_reading(py, &error))?;
    let estimate = summary.and_then(|summary| summary.error_estimate);
    Ok(estimate.map_or_else(Vec::new, |estimate| estimate.lines()))
}

fn column<'py, T: Element>(
    py: Python<'py>,
    rows: &[HistoryRow],
    of: impl Fn(&HistoryRow) -> T,
) -> PyResult<Bound<'py, PyAny>> {
    flat(py, rows.iter().map(of).collect())
}

/// Step time of the largest force [s], or None if nothing was driven.
#[pyfunction]
pub fn time_of_peak(py: Python<'_>, folder: PathBuf) -> PyResult<Option<f64>> {
    let read = py.detach(|| Ok(RunFolder::open(&folder)?.history()?.time_of_peak()));
    read.map_err(|error| errors::of_reading(py, &error))
}

/// Key figures from the history alone, with the names of `summary.json`: largest force [kN] and its displacement
/// [mm], displacement at 0.8 of it [mm], initial stiffness [kN/mm].
#[pyfunction]
pub fn figures(py: Python<'_>, folder: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let read = py.detach(|| Ok(RunFolder::open(&folder)?.history()?.curve()));
    let curve = read.map_err(|error: ReadError| errors::of_reading(py, &error))?;
    let peak = curve.peak();
    let figures = PyDict::new(py);
    figures.set_item("peak_force_kN", peak.as_ref().map(|p| p.force))?;
    figures.set_item(
        "displacement_at_peak_mm",
        peak.as_ref().map(|p| p.displacement),
    )?;
    figures.set_item(
        "displacement_at_80_percent_mm",
        curve.displacement_at_80_percent(),
    )?;
    figures.set_item("initial_stiffness_kN_per_mm", curve.initial_stiffness())?;
    Ok(figures)
}

/// Text of `summary.json`, or None if the run has not ended or was killed.
#[pyfunction]
pub fn summary(py: Python<'_>, folder: PathBuf) -> PyResult<Option<String>> {
    let read = py.detach(|| RunFolder::open(&folder)?.summary());
    let read = read.map_err(|error| errors::of_reading(py, &error))?;
    read.map(|summary| serde_json::to_string(&summary))
        .transpose()
        .map_err(|error| errors::bug(&format!("a summary as JSON: {error}")))
}

fn measured(py: Python<'_>, path: &Path) -> PyResult<Experiment> {
    py.detach(|| Experiment::read(path))
        .map_err(|error| errors::of_experiment(py, &error))
}

/// Name and points (n, 2) [mm, kN] of a measured curve.
#[pyfunction]
pub fn experiment(py: Python<'_>, path: PathBuf) -> PyResult<(String, Bound<'_, PyAny>)> {
    let Experiment { name, points } = measured(py, &path)?;
    let points: Vec<[f64; 2]> = points.into_iter().map(<[f64; 2]>::from).collect();
    Ok((name, rows(py, points)?))
}

/// Output of `wythe compare --json`.
#[pyfunction]
#[pyo3(signature = (folder, experiment, height))]
pub fn compare(
    py: Python<'_>,
    folder: PathBuf,
    experiment: PathBuf,
    height: Option<f64>,
) -> PyResult<String> {
    let experiment = measured(py, &experiment)?;
    let found = py.detach(|| {
        let folder = RunFolder::open(&folder)?;
        let curve = folder.history()?.curve();
        let height = height.or_else(|| folder.clear_height());
        Ok(results::compare(&curve, &experiment, height))
    });
    let found = found.map_err(|error: ReadError| errors::of_reading(py, &error))?;
    serde_json::to_string(&found).map_err(|error| errors::bug(&format!("as JSON: {error}")))
}

/// Writes the report and returns its notes.
#[pyfunction]
#[pyo3(signature = (folder, out, experiment))]
pub fn report(
    py: Python<'_>,
    folder: PathBuf,
    out: PathBuf,
    experiment: Option<PathBuf>,
) -> PyResult<Vec<String>> {
    let experiment = experiment.map(|path| measured(py, &path)).transpose()?;
    let page = py.detach(|| Report::of(&RunFolder::open(&folder)?, experiment.as_ref()));
    let page = page.map_err(|error| errors::of_reading(py, &error))?;
    py.detach(|| page.write(&out))
        .map_err(|why| errors::of_path(py, &out, why))?;
    Ok(page.notes)
}

/// A frame by its number, or `peak` or `last`.
fn choice(frame: &str) -> PyResult<FrameChoice> {
    frame
        .parse()
        .map_err(|why: String| PyValueError::new_err(format!("frame = {frame}: {why}")))
}

/// A view by its word, or a section as `y=125`.
fn look(view: &str, scale: Option<f64>) -> PyResult<Look> {
    let read = if view.contains('=') {
        View::section(view)
    } else {
        view.parse()
    };
    Ok(Look {
        view: read.map_err(PyValueError::new_err)?,
        scale,
        window: None,
    })
}

/// Draws the wall at a frame as SVG. `view`: a face, a direction, or a section as `y=125`.
#[pyfunction]
#[pyo3(signature = (folder, frame, view, scale))]
pub fn wall(
    py: Python<'_>,
    folder: PathBuf,
    frame: &str,
    view: &str,
    scale: Option<f64>,
) -> PyResult<String> {
    let (frame, look) = (choice(frame)?, look(view, scale)?);
    let drawn = py.detach(|| {
        let folder = RunFolder::open(&folder)?;
        let snapshot = Snapshots::open(&folder)?.at(frame)?;
        wall_picture(&snapshot, folder.model().as_ref(), &look)
    });
    drawn.map_err(|error| errors::of_reading(py, &error))
}

/// Draws columns of the history of runs as SVG.
#[pyfunction]
#[pyo3(signature = (runs, x, y))]
pub fn columns_picture(
    py: Python<'_>,
    runs: Vec<(String, PathBuf)>,
    x: Option<String>,
    y: Vec<String>,
) -> PyResult<String> {
    let of = columns::Columns { x, y };
    let drawn = py.detach(|| histories(&runs).and_then(|all| of_columns(&runs, &all, &of)));
    drawn.map_err(|error| errors::of_reading(py, &error))
}

/// Columns of a run that are drawn by default: that of x, and those of y.
#[pyfunction]
pub fn default_columns(py: Python<'_>, folder: PathBuf) -> PyResult<(String, Vec<String>)> {
    let read = py.detach(|| RunFolder::open(&folder)?.history());
    let read = read.map_err(|error| errors::of_reading(py, &error))?;
    let of = columns::Columns::default().or_default(&read);
    Ok((of.x.unwrap_or_default(), of.y))
}

/// Values of a column of numbers, with the name of its axis.
#[pyfunction]
pub fn history_column(py: Python<'_>, folder: PathBuf, name: &str) -> PyResult<String> {
    let read = py.detach(|| RunFolder::open(&folder)?.history()?.column(name));
    read.map_err(|error| errors::of_reading(py, &error))?;
    Ok(columns::axis(name))
}

/// Writes an animation as GIF. `drawn`: width [px], time of a frame [s], with the curve or without, largest number of
/// frames.
#[pyfunction]
#[pyo3(signature = (folder, out, view, scale, drawn))]
pub fn animate(
    py: Python<'_>,
    folder: PathBuf,
    out: PathBuf,
    view: &str,
    scale: Option<f64>,
    drawn: (u32, f64, bool, usize),
) -> PyResult<()> {
    let (width, delay, curve, most) = drawn;
    let of = Animation {
        look: look(view, scale)?,
        width,
        delay,
        curve,
        most,
    };
    let bytes = py.detach(|| {
        let folder = RunFolder::open(&folder)?;
        animation::gif(&Snapshots::open(&folder)?, folder.model().as_ref(), &of)
    });
    let bytes = bytes.map_err(|error| errors::of_reading(py, &error))?;
    py.detach(|| write_whole(&out, &bytes))
        .map_err(|why| errors::of_path(py, &out, why))
}

fn histories(runs: &[(String, PathBuf)]) -> Result<Vec<ReadHistory>, ReadError> {
    let read = |(_, path): &(String, PathBuf)| RunFolder::open(path)?.history();
    runs.iter().map(read).collect()
}

fn of_columns(
    runs: &[(String, PathBuf)],
    histories: &[ReadHistory],
    of: &columns::Columns,
) -> Result<String, ReadError> {
    let names = runs.iter().map(|(name, _)| name.as_str());
    let named: Vec<(&str, &ReadHistory)> = names.zip(histories).collect();
    columns(&title(runs)?, &named, of)
}

/// Title of the first run; empty if it has no fields yet.
fn title(runs: &[(String, PathBuf)]) -> Result<String, ReadError> {
    let Some((_, first)) = runs.first() else {
        return Ok(String::new());
    };
    let fields = RunFolder::open(first)?.fields().ok();
    let title = fields.and_then(|f| f.title_and_version().ok());
    Ok(title.map_or_else(String::new, |(title, _)| title))
}

/// Draws `curves`, `deflection_height` or `deflection_length` of runs as SVG; the first run decides the
/// view.
#[pyfunction]
pub fn picture(
    py: Python<'_>,
    kind: &str,
    runs: Vec<(String, PathBuf)>,
    experiments: Vec<PathBuf>,
    frame: &str,
) -> PyResult<String> {
    let frame = choice(frame)?;
    let experiments: Vec<Experiment> = experiments
        .iter()
        .map(|path| measured(py, path))
        .collect::<PyResult<_>>()?;
    let drawn = py.detach(|| draw(kind, &runs, &experiments, frame));
    match drawn {
        Ok(Ok(svg)) => Ok(svg),
        Ok(Err(why)) => Err(PyValueError::new_err(why)),
        Err(error) => Err(errors::of_reading(py, &error)),
    }
}

fn draw(
    kind: &str,
    runs: &[(String, PathBuf)],
    experiments: &[Experiment],
    frame: FrameChoice,
) -> Result<Result<String, String>, ReadError> {
    let open = |path: &PathBuf| RunFolder::open(path);
    if runs.is_empty() {
        return Ok(Err("there is no run to draw".to_owned()));
    }
    if kind == "curves" {
        let histories = histories(runs)?;
        let still = histories.iter().all(|h| h.curve().points().is_empty());
        if still && experiments.is_empty() {
            return of_columns(runs, &histories, &columns::Columns::default()).map(Ok);
        }
        let mut lines = Vec::new();
        for ((name, _), history) in runs.iter().zip(&histories) {
            let curve = history.curve();
            let peak = curve.peak().map(|p| (p.displacement, p.force));
            lines.push(Line {
                name: name.clone(),
                points: points_of(&curve),
                marks: peak.into_iter().collect(),
            });
        }
        return Ok(load_displacements(&title(runs)?, &lines, experiments));
    }
    let snapshots: Vec<(&str, Snapshot)> = runs
        .iter()
        .map(|(name, path)| Ok((name.as_str(), Snapshots::open(&open(path)?)?.at(frame)?)))
        .collect::<Result<_, ReadError>>()?;
    let leading = &snapshots[0].1;
    let along = match kind {
        "deflection_height" => Along::Height,
        "deflection_length" => Along::Length,
        _ => return Ok(Err(format!("there is no picture `{kind}`"))),
    };
    let axis = main_axis(&leading.frame);
    let bent: Vec<(String, Deflection)> = snapshots
        .iter()
        .map(|(name, Snapshot { mesh, frame, .. })| {
            ((*name).to_owned(), Deflection::of(mesh, frame, along, axis))
        })
        .filter(|(_, deflection)| !deflection.points.is_empty())
        .collect();
    Ok(deflections(&leading.title, along, axis, &bent))
}

/// Converts an SVG to PNG.
#[pyfunction]
pub fn png(py: Python<'_>, svg: &str, zoom: f32) -> PyResult<Vec<u8>> {
    py.detach(|| plotting::png(svg, zoom))
        .map_err(PyValueError::new_err)
}

/// Writes a frame as `vtu` or `csv` into a folder. Returns the files, the solids first, and the time of the frame
/// [s].
#[pyfunction]
pub fn export_frame(
    py: Python<'_>,
    folder: PathBuf,
    format: &str,
    frame: &str,
    out: PathBuf,
) -> PyResult<(Vec<PathBuf>, f64)> {
    let frame = choice(frame)?;
    let snapshot = py.detach(|| Snapshots::open(&RunFolder::open(&folder)?)?.at(frame));
    let snapshot = snapshot.map_err(|error| errors::of_reading(py, &error))?;
    let files = py.detach(|| match format {
        "vtu" => vec![
            (".vtu", vtu::solids(&snapshot)),
            ("_interfaces.vtu", vtu::interfaces(&snapshot)),
        ],
        _ => vec![
            ("_nodes.csv", table::nodes(&snapshot)),
            ("_elements.csv", table::elements(&snapshot)),
            ("_interfaces.csv", table::interfaces(&snapshot)),
        ],
    });
    let joined = !snapshot.surface.quads.is_empty();
    let files = files
        .into_iter()
        .filter(|(rest, _)| joined || !rest.starts_with("_interfaces"));
    let mut written = Vec::new();
    for (rest, text) in files {
        let path = out.join(frame_name(snapshot.number, rest));
        py.detach(|| {
            std::fs::create_dir_all(&out).and_then(|()| write_whole(&path, text.as_bytes()))
        })
        .map_err(|why| errors::of_path(py, &path, why))?;
        written.push(path);
    }
    Ok((written, snapshot.frame.time))
}

/// Text of a collection of exported frames, given time [s] and file of each.
#[pyfunction]
pub fn collection(files: Vec<(f64, String)>) -> String {
    vtu::collection(&files)
}

/// Repairs the message file of an interrupted run. Returns messages, attachments, lost bytes and whether it was
/// complete.
#[pyfunction]
#[pyo3(signature = (file, out))]
pub fn salvage(
    py: Python<'_>,
    file: PathBuf,
    out: Option<PathBuf>,
) -> PyResult<(u64, u64, u64, bool)> {
    let found = py
        .detach(|| rescue(&file, out.as_deref()))
        .map_err(|error| errors::of_salvage(py, &error))?;
    Ok((
        found.messages,
        found.attachments,
        found.lost_bytes,
        found.was_whole,
    ))
}
