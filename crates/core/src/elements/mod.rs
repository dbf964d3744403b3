//! One file a force. Each adds to the forces f (N), the sheet, which is the first, sets them; positions x, velocities v and f are n x 3, column-major.

pub(crate) mod air;
pub(crate) mod buckling;
pub(crate) mod drag;
pub(crate) mod ending;
pub(crate) mod flow;
pub(crate) mod gravity;
mod inverse_root;
pub(crate) mod sheet;
pub(crate) mod springs;
pub(crate) mod wind;

pub use air::Air;
pub use buckling::Buckling;
pub use sheet::Sheet;
pub use wind::Wind;

use std::ops::Range;

/// The numbers of some particles in each column of an n x 3 matrix.
pub(crate) fn columns<'a>(a: &'a [f64], particles: &Range<usize>) -> [&'a [f64]; 3] {
    let n = a.len() / 3;
    [0, n, 2 * n].map(|column| &a[column + particles.start..column + particles.end])
}

/// Its three columns.
pub(crate) fn columns_mut(a: &mut [f64]) -> [&mut [f64]; 3] {
    let (x, rest) = a.split_at_mut(a.len() / 3);
    let (y, z) = rest.split_at_mut(x.len());
    [x, y, z]
}
