//! `results.vtkhdf`, read by field and frame on request.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use pyo3::types::PyDict;
use wythe_core::results::FieldsFile;
use wythe_core::results::vtkhdf::field::Values;

use crate::arrays::{flat, rows, shaped};
use crate::errors;

/// An open field file.
#[pyclass(frozen, module = "wythe._wythe")]
pub struct Fields {
    file: FieldsFile,
}

impl Fields {
    fn unread(&self, py: Python<'_>, why: std::io::Error) -> PyErr {
        errors::of_path(py, self.file.path(), why)
    }
}

#[pymethods]
impl Fields {
    /// Opens the file; fields are not read.
    #[staticmethod]
    fn open(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let file = py.detach(|| FieldsFile::open(&path));
        match file {
            Ok(file) => Ok(Self { file }),
            Err(why) => Err(errors::of_path(py, &path, why)),
        }
    }

    #[getter]
    fn path(&self) -> &Path {
        self.file.path()
    }

    /// Step time of each frame [s].
    fn times<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        flat(py, self.file.times().to_vec())
    }

    /// Increment of each frame.
    fn increments<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let increments = self.file.increments().iter().map(|&i| i as i64).collect();
        flat::<i64>(py, increments)
    }

    /// External forces on beams, supports and loads [N], (increments, 3) each, by their paths in the history.
    fn reactions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all = py.detach(|| self.file.reactions());
        let forces = PyDict::new(py);
        for (name, of) in all.map_err(|why| self.unread(py, why))? {
            forces.set_item(name, rows(py, of)?)?;
        }
        Ok(forces)
    }

    /// Title of the model and version of the program.
    fn title_and_version(&self, py: Python<'_>) -> PyResult<(String, String)> {
        py.detach(|| self.file.title_and_version())
            .map_err(|why| self.unread(py, why))
    }

    /// Text of the deck.
    fn deck(&self, py: Python<'_>) -> PyResult<Option<String>> {
        let deck = py.detach(|| self.file.deck());
        Ok(deck
            .map_err(|why| self.unread(py, why))?
            .map(|(text, _)| text))
    }

    /// Names of the materials.
    fn materials(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        py.detach(|| self.file.materials())
            .map_err(|why| self.unread(py, why))
    }

    /// Nodes (n, 3), elements (e, 8), material, unit, course (e,).
    fn mesh<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyAny>; 5]> {
        let mesh = py
            .detach(|| self.file.mesh())
            .map_err(|why| self.unread(py, why))?;
        Ok([
            rows(py, mesh.nodes)?,
            rows(py, mesh.elements)?,
            flat(py, mesh.material)?,
            flat(py, mesh.unit)?,
            flat(py, mesh.course)?,
        ])
    }

    /// Corners (c, 3) and quads (p, 4) of the interfaces.
    fn surface<'py>(&self, py: Python<'py>) -> PyResult<[Bound<'py, PyAny>; 2]> {
        let surface = py
            .detach(|| self.file.surface())
            .map_err(|why| self.unread(py, why))?;
        Ok([rows(py, surface.points)?, rows(py, surface.quads)?])
    }

    /// Names of the fields in the file.
    fn names(&self, py: Python<'_>) -> PyResult<Vec<String>> {
        py.detach(|| self.file.field_names())
            .map_err(|why| self.unread(py, why))
    }

    /// One field of one frame: (rows, width), or (rows,) for a scalar.
    fn field<'py>(&self, py: Python<'py>, name: &str, frame: usize) -> PyResult<Bound<'py, PyAny>> {
        let values = py
            .detach(|| self.file.field(name, frame))
            .map_err(|why| self.unread(py, why))?;
        match values {
            Values::Real { values, width: 1 } => flat(py, values),
            Values::Real { values, width } => shaped(py, values, vec![None, Some(width)]),
            Values::Code(values) => flat(py, values),
        }
    }
}
