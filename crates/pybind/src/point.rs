//! Drives single points along many paths, for calibration and for the study of a law.

use std::num::NonZeroUsize;

use numpy::PyReadonlyArray1;
use pyo3::prelude::*;
use rayon::prelude::*;
use wythe_contact::JointLaw;
use wythe_core::deck::Deck;
use wythe_core::material::{Material, MaterialHistory};
use wythe_core::point::{
    INTERFACE, Layout, MATERIAL, Record, Row, RowFailure, State, Target, follow_interface,
    follow_material, interface_state, material_state,
};

use crate::arrays::shaped;
use crate::errors::{self, Text};

/// Number of rows above which starting threads pays off.
const MANY: usize = 5_000;

/// Strains, stresses, states and tangents of all paths, and the first failure: path, row, reason.
pub type Driven<'py> = ([Bound<'py, PyAny>; 4], Option<(usize, usize, String)>);

/// Input of the paths: flat numbers of shape (paths, rows, N), times (rows,), and the stress-controlled components.
pub struct Paths<'a, const N: usize> {
    values: &'a [f64],
    times: &'a [f64],
    by_stress: [bool; N],
}

impl<'a, const N: usize> Paths<'a, N> {
    /// The paths in these arrays.
    pub fn new(
        values: &'a PyReadonlyArray1<'_, f64>,
        times: &'a PyReadonlyArray1<'_, f64>,
        by_stress: [bool; N],
    ) -> PyResult<Self> {
        Ok(Self {
            values: values.as_slice()?,
            times: times.as_slice()?,
            by_stress,
        })
    }

    /// Rows of one path.
    fn rows(&self, path: usize) -> Vec<Row<N>> {
        let (values, _) = self.values.as_chunks::<N>();
        let values = values.iter().skip(path * self.times.len());
        let target = |i: usize, value: f64| {
            if self.by_stress[i] {
                Target::Stress(value)
            } else {
                Target::Strain(value)
            }
        };
        let row = |(values, &time): (&[f64; N], &f64)| Row {
            time,
            targets: std::array::from_fn(|i| target(i, values[i])),
        };
        values.zip(self.times).map(row).collect()
    }
}

/// Results of one path; rows without a result are NaN. `[row]`
struct Answers<'a, const N: usize, const M: usize> {
    strains: &'a mut [[f64; N]],
    stresses: &'a mut [[f64; N]],
    states: &'a mut [[f64; M]],
    /// `[row][of][by]`
    tangents: &'a mut [[[f64; N]; N]],
}

impl<const N: usize, const M: usize> Answers<'_, N, M> {
    fn take<H>(&mut self, row: usize, record: &Record<N, H>, state: [f64; M]) {
        self.strains[row] = record.state.strain.into();
        self.stresses[row] = record.state.stress.into();
        self.states[row] = state;
        for (i, line) in self.tangents[row].iter_mut().enumerate() {
            for (j, entry) in line.iter_mut().enumerate() {
                *entry = record.tangent[(i, j)];
            }
        }
    }
}

/// Drives the material `materials.N` of the deck along path N; a single material is used for all paths.
#[pyfunction]
#[pyo3(signature = (deck, names, length, values, times, by_stress, substeps))]
#[expect(clippy::too_many_arguments, reason = "its keywords in Python")]
pub fn drive_material<'py>(
    py: Python<'py>,
    deck: &str,
    names: Vec<String>,
    length: Option<f64>,
    values: PyReadonlyArray1<'py, f64>,
    times: PyReadonlyArray1<'py, f64>,
    by_stress: [bool; 6],
    substeps: NonZeroUsize,
) -> PyResult<Driven<'py>> {
    let deck = read(py, deck)?;
    let laws = names.iter().map(|name| deck.law(name, length));
    let laws = laws
        .map(|law| law.map(|(law, _)| law))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| errors::of_model(py, &error, Text::Made))?;
    let paths = Paths::new(&values, &times, by_stress)?;
    drive_solids(py, &paths, substeps, &laws)
}

/// Drives law N along path N; a single law is used for all paths.
pub fn drive_solids<'py>(
    py: Python<'py>,
    paths: &Paths<'_, 6>,
    substeps: NonZeroUsize,
    laws: &[Material],
) -> PyResult<Driven<'py>> {
    drive(py, &MATERIAL, paths, |path, rows, out| {
        let law = &laws[path % laws.len()];
        let from = State::at_rest(MaterialHistory::default());
        let take = |row, record: &Record<6, _>| {
            out.take(row, record, material_state(&record.state.history));
        };
        follow_material(law, from, rows, substeps, take).err()
    })
}

/// Drives interfaces in the same way.
#[pyfunction]
#[pyo3(signature = (deck, names, values, times, by_stress, substeps))]
#[expect(clippy::too_many_arguments, reason = "its keywords in Python")]
pub fn drive_interface<'py>(
    py: Python<'py>,
    deck: &str,
    names: Vec<String>,
    values: PyReadonlyArray1<'py, f64>,
    times: PyReadonlyArray1<'py, f64>,
    by_stress: [bool; 3],
    substeps: NonZeroUsize,
) -> PyResult<Driven<'py>> {
    let deck = read(py, deck)?;
    let laws = names
        .iter()
        .map(|name| deck.interface(name))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| errors::of_model(py, &error, Text::Made))?;
    let paths = Paths::new(&values, &times, by_stress)?;
    drive_joints(py, &paths, substeps, &laws)
}

/// Drives law N along path N; a single law is used for all paths.
pub fn drive_joints<'py>(
    py: Python<'py>,
    paths: &Paths<'_, 3>,
    substeps: NonZeroUsize,
    laws: &[impl JointLaw],
) -> PyResult<Driven<'py>> {
    drive(py, &INTERFACE, paths, |path, rows, out| {
        let law = &laws[path % laws.len()];
        let from = State::at_rest(law.virgin());
        let take = |row, record: &Record<3, _>| {
            out.take(row, record, interface_state(&record.state.history));
        };
        follow_interface(law, from, rows, substeps, take).err()
    })
}

fn read(py: Python<'_>, deck: &str) -> PyResult<Deck> {
    py.detach(|| Deck::from_str(deck, "point"))
        .map_err(|error| errors::of_model(py, &error, Text::Made))
}

/// Computes every path by `follow(path, rows, answers)`, in parallel if there are many rows.
fn drive<'py, const N: usize, const M: usize>(
    py: Python<'py>,
    layout: &Layout<N>,
    paths: &Paths<'_, N>,
    follow: impl Fn(usize, &[Row<N>], &mut Answers<'_, N, M>) -> Option<RowFailure<N>> + Sync,
) -> PyResult<Driven<'py>> {
    let rows = paths.times.len();
    let all = paths.values.len() / N;
    let count = all.checked_div(rows).unwrap_or(0);
    let mut strains = vec![[f64::NAN; N]; all];
    let mut stresses = vec![[f64::NAN; N]; all];
    let mut states = vec![[f64::NAN; M]; all];
    let mut tangents = vec![[[f64::NAN; N]; N]; all];
    // Chunks cannot be empty.
    let size = rows.max(1);
    let pieces = strains
        .chunks_mut(size)
        .zip(stresses.chunks_mut(size))
        .zip(states.chunks_mut(size))
        .zip(tangents.chunks_mut(size))
        .map(|(((strains, stresses), states), tangents)| Answers {
            strains,
            stresses,
            states,
            tangents,
        });
    let pieces: Vec<_> = pieces.enumerate().collect();
    let one = |(path, mut out): (usize, Answers<'_, N, M>)| {
        let rows = paths.rows(path);
        let failure = follow(path, &rows, &mut out)?;
        let why = failure.why.explain(&rows[failure.row], layout);
        Some((path, failure.row, why))
    };
    let failure = py
        .detach(|| first_failure(pieces, all >= MANY, one))
        .map_err(|error| errors::bug(&format!("no threads: {error}")))?;
    let shape = |last: &[usize]| {
        let lengths = [count, rows].into_iter().chain(last.iter().copied());
        lengths.map(Some).collect::<Vec<_>>()
    };
    let tangents = tangents.into_flattened().into_flattened();
    let arrays = [
        shaped(py, strains.into_flattened(), shape(&[N]))?,
        shaped(py, stresses.into_flattened(), shape(&[N]))?,
        shaped(py, states.into_flattened(), shape(&[M]))?,
        shaped(py, tangents, shape(&[N, N]))?,
    ];
    Ok((arrays, failure))
}

/// Path, row and reason of a failure.
type Failed = (usize, usize, String);

/// Computes all pieces, even after a failure, and returns the failure of the first path that has one.
fn first_failure<T: Send>(
    pieces: Vec<T>,
    are_many: bool,
    one: impl Fn(T) -> Option<Failed> + Sync + Send,
) -> Result<Option<Failed>, rayon::ThreadPoolBuildError> {
    if pieces.len() == 1 || !are_many {
        let failures: Vec<_> = pieces.into_iter().filter_map(one).collect();
        return Ok(failures.into_iter().next());
    }
    // A separate pool, as for runs.
    let pool = rayon::ThreadPoolBuilder::new().build()?;
    Ok(pool.install(|| {
        let failures = pieces.into_par_iter().filter_map(one);
        failures.min_by_key(|(path, _, _)| *path)
    }))
}
