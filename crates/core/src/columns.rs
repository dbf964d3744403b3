//! Columns and rows of n x 3 matrices in column-major order.

use std::ops::Range;

use nalgebra::Vector3;

/// Returns the part of each column of an n x 3 matrix that belongs to some particles.
pub(crate) fn columns<'a>(a: &'a [f64], particles: &Range<usize>) -> [&'a [f64]; 3] {
    let n = a.len() / 3;
    [0, n, 2 * n].map(|column| &a[column + particles.start..column + particles.end])
}

/// Returns row i of an n x 3 matrix.
pub(crate) fn row(a: &[f64], n: usize, i: usize) -> Vector3<f64> {
    Vector3::new(a[i], a[n + i], a[2 * n + i])
}

/// Sets row i of an n x 3 matrix.
pub(crate) fn set_row(a: &mut [f64], n: usize, i: usize, to: Vector3<f64>) {
    for axis in 0..3 {
        a[axis * n + i] = to[axis];
    }
}

/// Returns the columns of an n x N matrix.
pub(crate) fn columns_mut<const N: usize>(a: &mut [f64]) -> [&mut [f64]; N] {
    let n = a.len() / N;
    let mut rest = a;
    std::array::from_fn(|_| rest.split_off_mut(..n).unwrap_or_default())
}
