//! Division of rows among threads, where there are enough particles. The result of a row does not
//! depend on the thread that computes it.

use std::ops::Range;

use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};

/// Least number of particles for each thread: with fewer, waking the thread costs more than it
/// saves (docs/performance.md).
const MIN_PARTICLES: usize = 2048;

/// Returns the number of threads for this many particles: 1 where there are too few for two
/// threads.
pub(crate) fn threads(particles: usize) -> usize {
    match particles / MIN_PARTICLES {
        0 | 1 => 1,
        most => most.min(rayon::current_num_threads()),
    }
}

/// Runs `run` inside the thread pool, if a system of that many particles is shared among threads,
/// so that no part of a step has to wake the pool.
pub(crate) fn among_threads<R: Send>(particles: usize, run: impl FnOnce() -> R + Send) -> R {
    if threads(particles) > 1 { rayon::scope(|_| run()) } else { run() }
}

/// Columns of a matrix whose rows are split among threads.
pub(crate) type Columns<'a, const N: usize> = [&'a mut [f64]; N];

/// Splits off the part of each column before the index `at`, and returns these parts.
pub(crate) fn split_off<'a, const N: usize>(
    columns: &mut Columns<'a, N>,
    at: usize,
) -> Columns<'a, N> {
    columns.each_mut().map(|column| column.split_off_mut(..at).unwrap_or_default())
}

/// Calls `run` on bands of the rows, each of `cols` particles, in parallel. Each call gets the part
/// of the columns that belongs to its band.
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

/// Calls `run` on each element with its index, in parallel if there are many.
pub(crate) fn each<T: Send>(things: &mut [T], run: &(impl Fn(usize, &mut T) + Sync)) {
    if threads(things.len()) > 1 {
        let all = things.par_iter_mut().enumerate().with_min_len(MIN_PARTICLES / 2);
        all.for_each(|(k, thing)| run(k, thing));
    } else {
        let all = things.iter_mut().enumerate();
        all.for_each(|(k, thing)| run(k, thing));
    }
}

/// Number of numbers in the unit of copying.
const BLOCK: usize = 2048;

/// Copies `from` to `to`, a state or half of one, on several threads if it is large.
pub(crate) fn copy(from: &[f64], to: &mut [f64]) {
    let (bands, blocks) = (threads(from.len() / 3), from.len().div_ceil(BLOCK));
    fork(bands, 0..blocks, BLOCK, [to], &|blocks, [to]| {
        let first = blocks.start * BLOCK;
        to.copy_from_slice(&from[first..first + to.len()]);
    });
}
