//! Tolerances, and the norm in which the error of a step is measured against them.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::ops::Range;

use crate::error::{Error, positive};
use crate::sums::{OnBlock, add_up, dot};
use crate::threads::{Columns, threads};

/// Error that a step may make.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Relative to the state, without unit.
    pub relative: f64,
    /// Absolute (m and m/s).
    pub absolute: f64,
}

impl Tolerance {
    /// A relative tolerance (without unit), and a thousandth of it as the absolute one (m and m/s).
    ///
    /// # Errors
    /// It is not a finite number above 0.
    pub fn new(relative: f64) -> Result<Self, Error> {
        positive("the tolerance", relative)?;
        Ok(Self {
            relative,
            absolute: 1e-3 * relative,
        })
    }
}

/// Norm of an error: the root mean square of a block of numbers, over absolute tolerance + relative
/// tolerance x the root mean square of the block of the state.
///
/// Positions are one block and velocities another, so that neither units nor the directions of the
/// axes matter, and a number that happens to be near zero asks for no more digits than others.
pub(super) struct ErrorNorm {
    /// Tolerated error.
    pub tolerance: Tolerance,
    /// Length of a block.
    pub block: usize,
}

/// Numbers whose squares are added up together, and few enough for all that they are computed from
/// to stay in the cache.
pub(super) const BLOCK: usize = 2048;

impl ErrorNorm {
    /// The error over the tolerated one, in the block in which that is largest.
    pub fn of(&self, y0: &[f64], y1: &[f64], error: &[f64]) -> f64 {
        let (bands, task) = (threads(y0.len() / 6), Squares([y0, y1, error]));
        let [error, _] = self.of_sums(y0.len(), |numbers| add_up(bands, numbers, BLOCK, [], &task));
        error
    }

    /// The same of two errors of a state of this dimension, by the sums of squares over the numbers
    /// of a block: of y0, of y1 and of both errors.
    pub fn of_sums(&self, dim: usize, mut sums: impl FnMut(Range<usize>) -> [f64; 4]) -> [f64; 2] {
        let Tolerance { relative, absolute } = self.tolerance;
        let mut largest = [0.0; 2];
        for start in (0..dim).step_by(self.block) {
            let numbers = start..dim.min(start + self.block);
            let length = numbers.len() as f64;
            let [y0, y1, errors @ ..] = sums(numbers).map(|sum| (sum / length).sqrt());
            let tolerated = absolute + relative * y0.max(y1);
            for (largest, error) in largest.iter_mut().zip(errors) {
                let ratio = error / tolerated;
                // NaN has to come out as such.
                if ratio > *largest || ratio.is_nan() {
                    *largest = ratio;
                }
            }
        }
        largest
    }
}

/// Sums of squares.
struct Squares<'a>([&'a [f64]; 3]);

impl OnBlock<0, 4> for Squares<'_> {
    #[inline(always)]
    fn run(&self, numbers: Range<usize>, []: Columns<0>) -> [f64; 4] {
        let [y0, y1, error] = self.0.map(|a| {
            let own = &a[numbers.clone()];
            dot(own, own)
        });
        [y0, y1, error, 0.0]
    }
}
