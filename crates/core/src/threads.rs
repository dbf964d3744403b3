//! Rows over threads, where there are enough of them. Whoever computes a row computes the same
//! bits.

use std::ops::Range;

/// Least number of particles of a thread: with fewer, waking it costs more than it saves
/// (docs/performance.md).
const GRAIN: usize = 2048;

/// Number of threads for so many particles. None is started for a system that has too few for two.
pub(crate) fn threads(particles: usize) -> usize {
    match particles / GRAIN {
        0 | 1 => 1,
        most => most.min(rayon::current_num_threads()),
    }
}

/// Columns of a matrix whose rows are split among threads.
pub(crate) type Columns<'a, const N: usize> = [&'a mut [f64]; N];

/// Splits off what comes before an index in each of the columns.
pub(crate) fn split_off<'a, const N: usize>(
    columns: &mut Columns<'a, N>,
    at: usize,
) -> Columns<'a, N> {
    columns
        .each_mut()
        .map(|column| column.split_off_mut(..at).unwrap_or_default())
}

/// Runs over rows of so many particles in bands, each with its part of the columns.
pub(crate) fn fork<const N: usize>(
    bands: usize,
    rows: Range<usize>,
    cols: usize,
    mut columns: Columns<N>,
    run: &(impl Fn(Range<usize>, Columns<N>) + Sync),
) {
    if bands < 2 || rows.len() < 2 {
        run(rows, columns);
        return;
    }
    let above = bands / 2;
    let middle = rows.start + rows.len() * above / bands;
    let firsts = split_off(&mut columns, (middle - rows.start) * cols);
    rayon::join(
        || fork(above, rows.start..middle, cols, firsts, run),
        || fork(bands - above, middle..rows.end, cols, columns, run),
    );
}
