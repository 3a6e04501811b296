//! Natural modes of a model or of a frame of a run.

use std::path::PathBuf;

use pyo3::prelude::*;
use wythe_core::results::{FoundModes, FrameChoice, ModesError};

use crate::arrays::shaped;
use crate::errors;

/// Modes that were found.
#[pyclass(frozen, module = "wythe._wythe")]
pub struct FoundShapes {
    found: FoundModes,
}

impl FoundShapes {
    /// Wraps modes, or raises the exception of the error.
    pub fn of(py: Python<'_>, found: Result<FoundModes, ModesError>) -> PyResult<Self> {
        match found {
            Ok(found) => Ok(Self { found }),
            Err(error) => Err(errors::of_modes(py, &error)),
        }
    }
}

#[pymethods]
impl FoundShapes {
    /// All figures, the content of `modes.json`.
    fn table(&self) -> PyResult<String> {
        serde_json::to_string(&self.found.table())
            .map_err(|error| errors::bug(&format!("modes as JSON: {error}")))
    }

    /// All figures as text.
    fn text(&self) -> String {
        self.found.text()
    }

    /// Shapes, (modes, nodes, 3).
    fn shapes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let modes = &self.found.found.modes;
        let values: Vec<f64> = modes
            .iter()
            .flat_map(|m| m.shape.as_flattened())
            .copied()
            .collect();
        let nodes = self.found.model.mesh.nodes.len();
        shaped(py, values, vec![Some(modes.len()), Some(nodes), Some(3)])
    }

    /// Positions of the nodes at rest [mm], (nodes, 3).
    fn nodes<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        crate::arrays::rows(py, self.found.model.mesh.nodes.clone())
    }

    /// Picture of a mode, from 0, as SVG.
    fn picture(&self, mode: usize) -> String {
        self.found.picture(mode)
    }

    /// Writes the files of `wythe modes` and returns their paths.
    fn write(&self, py: Python<'_>, out: PathBuf) -> PyResult<Vec<PathBuf>> {
        let written = py.detach(|| self.found.write(&out));
        written.map_err(|error| errors::of_io(py, &error))
    }
}

/// Modes at a frame of a run.
#[pyfunction]
pub fn modes_of_run(
    py: Python<'_>,
    folder: PathBuf,
    frame: &str,
    count: usize,
) -> PyResult<FoundShapes> {
    let choice: FrameChoice = frame.parse().map_err(|why: String| errors::bug(&why))?;
    let found = py.detach(|| FoundModes::of_run(&folder, choice, count));
    FoundShapes::of(py, found)
}
