//! Sums over many numbers, in the processor's vectors and on threads. They are the same to the last
//! bit for any length of these and any number of those.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::array;
use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

use crate::threads::{Columns, split_off};

/// Calls `run` on blocks of at most `block` rows, on `bands` threads, with what it reads and with the
/// part of the columns that belongs to the block, and adds up the numbers that it returns for each.
/// A function that is always inlined is compiled for the processor's vectors; a closure may not be.
pub(crate) fn add_up<const N: usize, const M: usize, C: Sync>(
    bands: usize,
    rows: Range<usize>,
    block: usize,
    mut columns: Columns<N>,
    read: &C,
    run: impl Fn(&C, Range<usize>, Columns<N>) -> [f64; M] + Copy + Send + Sync,
) -> [f64; M] {
    let blocks = rows.len().div_ceil(block);
    if blocks < 2 {
        return Arch::new().dispatch(OnBlock {
            run,
            read,
            rows,
            columns,
        });
    }
    // The order of the sum follows from the number of blocks alone.
    let above = blocks.next_power_of_two() / 2 * block;
    let middle = rows.start + above;
    let firsts = split_off(&mut columns, above);
    let first = move |bands| add_up(bands, rows.start..middle, block, firsts, read, run);
    let second = move |bands| add_up(bands, middle..rows.end, block, columns, read, run);
    let (a, b) = if bands < 2 {
        (first(1), second(1))
    } else {
        let half = bands.div_ceil(2);
        rayon::join(|| first(half), || second(half))
    };
    array::from_fn(|k| a[k] + b[k])
}

/// A call of `run` on a block.
struct OnBlock<'a, 'b, const N: usize, C, R> {
    run: R,
    read: &'a C,
    rows: Range<usize>,
    columns: Columns<'b, N>,
}

impl<const N: usize, const M: usize, C, R> WithSimd for OnBlock<'_, '_, N, C, R>
where
    R: Fn(&C, Range<usize>, Columns<N>) -> [f64; M],
{
    type Output = [f64; M];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> [f64; M] {
        (self.run)(self.read, self.rows, self.columns)
    }
}

/// The scalar product, in sixteen sums that do not wait for one another.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_do_not_depend_on_threads() {
        let numbers: Vec<_> = (0..10_007).map(|k| f64::from(k).sin()).collect();
        let sum = |bands| {
            let mut twice = vec![0.0; numbers.len()];
            let [sum] = add_up(
                bands,
                0..numbers.len(),
                64,
                [&mut twice],
                &numbers,
                |numbers, block, [twice]| {
                    let own = &numbers[block];
                    twice
                        .iter_mut()
                        .zip(own)
                        .for_each(|(twice, own)| *twice = 2.0 * own);
                    [dot(own, own)]
                },
            );
            assert!(twice.iter().zip(&numbers).all(|(a, b)| *a == 2.0 * b));
            sum
        };
        let one = sum(1);
        let expected: f64 = numbers.iter().map(|a| a * a).sum();
        assert!(
            (one - expected).abs() < 1e-12 * expected,
            "{one} {expected}"
        );
        for bands in [2, 3, 8] {
            assert_eq!(sum(bands).to_bits(), one.to_bits(), "{bands} bands");
        }
    }
}
