//! Arrays of Python: matrices n x 3, whose rows are particles, from the columns of a state.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

/// Creates an array n x 3 of numbers that are given column by column.
pub fn rows<'py>(py: Python<'py>, columns: &[f64]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let n = columns.len() / 3;
    let array = PyArray2::zeros(py, [n, 3], false);
    let mut writable = array.readwrite();
    let rows = writable.as_slice_mut()?.as_chunks_mut::<3>().0;
    for (i, row) in rows.iter_mut().enumerate() {
        *row = [columns[i], columns[n + i], columns[2 * n + i]];
    }
    drop(writable);
    Ok(array)
}

/// Creates an array of rows of N whole numbers.
pub fn indices<'py, const N: usize>(
    py: Python<'py>,
    rows: &[[i64; N]],
) -> PyResult<Bound<'py, PyArray2<i64>>> {
    let flat = PyArray1::from_slice(py, rows.as_flattened());
    flat.reshape([rows.len(), N])
}

/// Creates an array of numbers.
pub fn numbers<'py>(py: Python<'py>, values: &[f64]) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_slice(py, values)
}
