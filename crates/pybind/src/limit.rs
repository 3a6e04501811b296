//! Limit analysis for Python.

use std::path::PathBuf;

use pyo3::prelude::*;
use wythe_core::limit::LimitError;
use wythe_core::results::FoundLimit;

use crate::errors;

/// Limit analysis of a model.
#[pyclass(frozen, module = "wythe._wythe")]
pub struct LimitOfModel {
    found: FoundLimit,
}

impl LimitOfModel {
    /// Wraps an analysis, or raises the exception of the error.
    pub fn of(py: Python<'_>, found: Result<FoundLimit, LimitError>) -> PyResult<Self> {
        match found {
            Ok(found) => Ok(Self { found }),
            Err(why) => Err(errors::of_limit(py, &why)),
        }
    }
}

#[pymethods]
impl LimitOfModel {
    /// All figures, the content of `limit.json`.
    fn table(&self) -> PyResult<String> {
        serde_json::to_string(&self.found.found)
            .map_err(|error| errors::bug(&format!("limit analysis as JSON: {error}")))
    }

    /// Picture of mechanism and forces, as SVG.
    fn picture(&self, py: Python<'_>) -> String {
        py.detach(|| self.found.picture())
    }

    /// Velocities of the nodes in the mechanism, (nodes, 3).
    fn velocities<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        crate::arrays::rows(py, self.found.velocities())
    }

    /// Writes the files of `wythe limit --out` and returns their paths.
    fn write(&self, py: Python<'_>, out: PathBuf) -> PyResult<Vec<PathBuf>> {
        let written = py.detach(|| self.found.write(&out));
        written.map_err(|error| errors::of_io(py, &error))
    }
}
