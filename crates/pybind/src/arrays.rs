//! Read-only arrays that NumPy takes over without a copy.

use numpy::{Element, PyArray1, PyArrayMethods};
use pyo3::prelude::*;

/// One-dimensional array.
pub fn flat<T: Element>(py: Python<'_>, values: Vec<T>) -> PyResult<Bound<'_, PyAny>> {
    sealed(PyArray1::from_vec(py, values).into_any())
}

/// Rows of N: shape (n, N).
pub fn rows<T: Element, const N: usize>(
    py: Python<'_>,
    values: Vec<[T; N]>,
) -> PyResult<Bound<'_, PyAny>> {
    shaped(py, values.into_flattened(), vec![None, Some(N)])
}

/// Array of any shape; one `None` is replaced by the length that follows from the others.
pub fn shaped<T: Element>(
    py: Python<'_>,
    values: Vec<T>,
    shape: Vec<Option<usize>>,
) -> PyResult<Bound<'_, PyAny>> {
    let known: usize = shape.iter().flatten().product();
    let rest = values.len().checked_div(known).unwrap_or(0);
    let shape: Vec<usize> = shape.into_iter().map(|n| n.unwrap_or(rest)).collect();
    let array = PyArray1::from_vec(py, values).reshape(shape)?;
    sealed(array.into_any())
}

fn sealed(array: Bound<'_, PyAny>) -> PyResult<Bound<'_, PyAny>> {
    array.getattr("flags")?.setattr("writeable", false)?;
    Ok(array)
}
