//! The columns of an n x 3 matrix in column-major order.

use std::ops::Range;

/// The numbers of some particles in each column of an n x 3 matrix.
pub(crate) fn columns<'a>(a: &'a [f64], particles: &Range<usize>) -> [&'a [f64]; 3] {
    let n = a.len() / 3;
    [0, n, 2 * n].map(|column| &a[column + particles.start..column + particles.end])
}

/// The three columns of an n x 3 matrix.
pub(crate) fn columns_mut(a: &mut [f64]) -> [&mut [f64]; 3] {
    let (x, rest) = a.split_at_mut(a.len() / 3);
    let (y, z) = rest.split_at_mut(x.len());
    [x, y, z]
}
