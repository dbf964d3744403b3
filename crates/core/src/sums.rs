//! Sums over many numbers, in SIMD vectors and on threads. They are the same to the last bit for
//! any length of the vectors and any number of threads.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::array;
use std::ops::Range;

use pulp::{Simd, WithSimd};

use crate::threads::{Columns, split_off};
use crate::vectors::Arch;

/// Task on a block of rows, with N columns of them, that returns M numbers.
pub(crate) trait OnBlock<const N: usize, const M: usize>: Sync {
    /// Runs the task. It has to be inlined always, as no closure can be, to be compiled for SIMD
    /// vectors.
    fn run(&self, rows: Range<usize>, columns: Columns<N>) -> [f64; M];
}

/// Runs a task on blocks of at most `block` rows, on `bands` threads, each with its part of the
/// columns, and adds up the numbers that the task returns.
pub(crate) fn add_up<const N: usize, const M: usize>(
    bands: usize,
    rows: Range<usize>,
    block: usize,
    mut columns: Columns<N>,
    task: &impl OnBlock<N, M>,
) -> [f64; M] {
    let blocks = rows.len().div_ceil(block);
    if blocks < 2 {
        return Arch::new().dispatch(Dispatched::<N, M, _> { task, rows, columns });
    }
    // The order of the sum follows from the number of blocks alone.
    let above = blocks.next_power_of_two() / 2 * block;
    let middle = rows.start + above;
    let firsts = split_off(&mut columns, above);
    let first = move |bands| add_up(bands, rows.start..middle, block, firsts, task);
    let second = move |bands| add_up(bands, middle..rows.end, block, columns, task);
    let (a, b) = if bands < 2 {
        (first(1), second(1))
    } else {
        let half = bands.div_ceil(2);
        rayon::join(|| first(half), || second(half))
    };
    array::from_fn(|k| a[k] + b[k])
}

struct Dispatched<'a, 'b, const N: usize, const M: usize, T> {
    task: &'a T,
    rows: Range<usize>,
    columns: Columns<'b, N>,
}

impl<const N: usize, const M: usize, T: OnBlock<N, M>> WithSimd for Dispatched<'_, '_, N, M, T> {
    type Output = [f64; M];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> [f64; M] {
        self.task.run(self.rows, self.columns)
    }
}

/// Returns the scalar product, in sixteen independent sums.
#[inline(always)]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 16];
    let (blocks, rest) = a.as_chunks::<16>();
    let (others, other_rest) = b.as_chunks::<16>();
    for (a, b) in blocks.iter().zip(others) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    let rest = rest.iter().zip(other_rest).map(|(a, b)| a * b);
    sums.into_iter().chain(rest).sum()
}

/// Returns the sum of numbers, in sixteen independent sums.
#[inline(always)]
pub(crate) fn total(a: &[f64]) -> f64 {
    let mut sums = [0.0; 16];
    let (blocks, rest) = a.as_chunks::<16>();
    for a in blocks {
        for (sum, a) in sums.iter_mut().zip(a) {
            *sum += a;
        }
    }
    sums.into_iter().chain(rest.iter().copied()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Twice<'a>(&'a [f64]);

    impl OnBlock<1, 1> for Twice<'_> {
        fn run(&self, block: Range<usize>, [twice]: Columns<1>) -> [f64; 1] {
            let own = &self.0[block];
            for (twice, own) in twice.iter_mut().zip(own) {
                *twice = 2.0 * own;
            }
            [dot(own, own)]
        }
    }

    #[test]
    fn sums_do_not_depend_on_threads() {
        let numbers: Vec<_> = (0..10_007).map(|k| f64::from(k).sin()).collect();
        let sum = |bands| {
            let mut twice = vec![0.0; numbers.len()];
            let all = 0..numbers.len();
            let [sum] = add_up(bands, all, 64, [&mut twice], &Twice(&numbers));
            assert!(twice.iter().zip(&numbers).all(|(a, b)| *a == 2.0 * b));
            sum
        };
        let one = sum(1);
        let expected: f64 = numbers.iter().map(|a| a * a).sum();
        assert!((one - expected).abs() < 1e-12 * expected, "{one} {expected}");
        for bands in [2, 3, 8] {
            assert_eq!(sum(bands).to_bits(), one.to_bits(), "{bands} bands");
        }
    }
}
