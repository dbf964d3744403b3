//! Tolerances, and the norm in which the error of a step is measured against them.

use crate::error::{Error, positive};

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

impl ErrorNorm {
    /// The error over the tolerated one, in the block in which that is largest.
    pub fn of(&self, y0: &[f64], y1: &[f64], error: &[f64]) -> f64 {
        let blocks = |a: &'_ [f64]| -> [f64; 2] {
            let mut chunks = a.chunks(self.block).map(root_mean_square);
            [chunks.next().unwrap_or(0.0), chunks.next().unwrap_or(0.0)]
        };
        let (y0, y1, error) = (blocks(y0), blocks(y1), blocks(error));
        let Tolerance { relative, absolute } = self.tolerance;
        let ratio = |b: usize| error[b] / (absolute + relative * y0[b].max(y1[b]));
        let (a, b) = (ratio(0), ratio(1));
        // NaN has to come out as such.
        if a >= b || a.is_nan() { a } else { b }
    }
}

fn root_mean_square(a: &[f64]) -> f64 {
    (a.iter().map(|a| a * a).sum::<f64>() / a.len() as f64).sqrt()
}
