//! Rows of n x 3 matrices, and how they are copied and added.

use super::blocks::Numbers;

/// Size of a cache line (bytes).
const LINE: usize = 64;

/// Three columns of numbers, aligned for SIMD vectors.
#[derive(Debug, Default)]
pub(super) struct Columns(Vec<f64>);

impl Columns {
    fn start(&self) -> usize {
        self.0.as_ptr().align_offset(LINE)
    }

    /// Resizes each column to a length, and returns the columns.
    pub fn of_length(&mut self, len: usize) -> &mut [f64] {
        self.0.resize(3 * len + LINE / size_of::<f64>(), 0.0);
        let start = self.start();
        &mut self.0[start..start + 3 * len]
    }

    pub fn get(&self) -> &[f64] {
        let start = self.start().min(self.0.len());
        &self.0[start..]
    }

    pub fn get_mut(&mut self) -> &mut [f64] {
        let start = self.start();
        &mut self.0[start..]
    }
}

/// Rows of an n x 3 matrix.
#[derive(Clone, Copy)]
pub(super) enum Places<'a> {
    /// Consecutive rows, from this one on.
    From(usize),
    /// Rows in ascending order.
    Each(&'a [u32]),
}

/// Adds numbers to rows of a column, which begins at the row `start`.
pub(super) fn add(
    column: &mut [f64],
    start: usize,
    places: Places,
    sums: impl Iterator<Item = f64>,
) {
    match places {
        Places::From(first) => {
            for (f, sum) in column[first - start..].iter_mut().zip(sums) {
                *f += sum;
            }
        }
        Places::Each(places) => {
            for (i, sum) in places.iter().zip(sums) {
                column[*i as usize - start] += sum;
            }
        }
    }
}

/// Copies rows of a column of an n x 3 matrix.
pub(super) fn copy(from: &[f64], axis: usize, places: Places, to: &mut [f64]) {
    let n = from.len() / 3;
    let from = &from[axis * n..][..n];
    match places {
        Places::From(first) => to.copy_from_slice(&from[first..][..to.len()]),
        Places::Each(places) => {
            for (to, i) in to.iter_mut().zip(places) {
                *to = from[*i as usize];
            }
        }
    }
}

/// Copies rows of an n x 3 matrix.
pub(super) fn copy_rows(from: &[f64], places: Places, to: &mut [Numbers]) {
    let [x, y, z] = [0, 1, 2].map(|axis| &from[axis * (from.len() / 3)..][..from.len() / 3]);
    match places {
        Places::From(first) => {
            let [x, y, z] = [x, y, z].map(|column| &column[first..][..to.len()]);
            for (i, to) in to.iter_mut().enumerate() {
                *to = Numbers([x[i], y[i], z[i], 0.0]);
            }
        }
        Places::Each(places) => {
            for (to, i) in to.iter_mut().zip(places) {
                let i = *i as usize;
                *to = Numbers([x[i], y[i], z[i], 0.0]);
            }
        }
    }
}
