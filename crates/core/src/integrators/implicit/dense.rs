//! Implicit stages of a small system without masses, by Newton's method with the Jacobian J from
//! central differences.

use super::{CLOSE, MOST, Newton, norm};
use crate::error::Error;
use crate::integrators::{Work, check_dim};
use crate::system::ParticleSystem;

/// Largest dimension; the Jacobian of a larger system takes too long.
pub(super) const LARGEST: usize = 1024;

/// Solver of the implicit stages of a small system, with its scratch.
pub(super) struct Dense {
    dim: usize,
    /// Matrix 1 - a J, row by row, or its factors L and U in place.
    matrix: Vec<f64>,
    /// Row that was exchanged with each row in turn.
    pivots: Vec<usize>,
    change: Vec<f64>,
    at: Vec<f64>,
    above: Vec<f64>,
    below: Vec<f64>,
}

impl Dense {
    pub fn new(dim: usize) -> Self {
        let room = if dim <= LARGEST { dim } else { 0 };
        Self {
            dim,
            matrix: vec![0.0; room * room],
            pivots: vec![0; room],
            change: vec![0.0; room],
            at: vec![0.0; room],
            above: vec![0.0; room],
            below: vec![0.0; room],
        }
    }

    /// Takes y from a guess to the solution of y = base + a f(t, y).
    pub fn solve(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        a: f64,
        base: &[f64],
        y: &mut [f64],
        newton: Newton,
    ) -> Result<Work, Error> {
        check_dim(self.dim, y)?;
        let mut work = Work::default();
        let (mut first, mut last) = (f64::NAN, f64::INFINITY);
        for iteration in 0..MOST {
            let (formed, of_use) = self.keep(system, t, a, y);
            work += formed;
            if !of_use {
                break;
            }
            work += self.correct(system, t, a, base, y);
            let size = norm(&self.change);
            if iteration == 0 {
                first = size;
            }
            let settled = size <= CLOSE * norm(y) || (size >= 0.5 * last && size < 1e-9 * norm(y));
            if newton == Newton::Once || settled {
                return Ok(work);
            }
            last = size;
            if !size.is_finite() {
                break;
            }
        }
        Err(Error::NoConvergence {
            residual: last / first,
        })
    }

    /// Writes 1 - a J at y into the matrix.
    fn form(&mut self, system: &dyn ParticleSystem, t: f64, a: f64, y: &[f64]) -> Work {
        let dim = self.dim;
        let Self {
            matrix,
            at,
            above,
            below,
            ..
        } = self;
        at.copy_from_slice(y);
        for j in 0..dim {
            let h = 1e-6 * y[j].abs().max(1.0);
            at[j] = y[j] + h;
            system.eval_f(t, at, above);
            at[j] = y[j] - h;
            system.eval_f(t, at, below);
            at[j] = y[j];
            for i in 0..dim {
                let slope = (above[i] - below[i]) / (2.0 * h);
                matrix[i * dim + j] = f64::from(i == j) - a * slope;
            }
        }
        Work::of(2 * dim as u64)
    }

    /// Factorises the matrix by Gaussian elimination with partial pivoting. Returns false if it is
    /// singular or not finite.
    fn factorise(&mut self) -> bool {
        let (n, matrix) = (self.dim, &mut self.matrix);
        for k in 0..n {
            let size = |i: usize, matrix: &[f64]| matrix[i * n + k].abs();
            let pivot = (k..n)
                .max_by(|&i, &j| size(i, matrix).total_cmp(&size(j, matrix)))
                .unwrap_or(k);
            if !(size(pivot, matrix) > 0.0 && size(pivot, matrix).is_finite()) {
                return false;
            }
            self.pivots[k] = pivot;
            for j in 0..n {
                matrix.swap(k * n + j, pivot * n + j);
            }
            for i in k + 1..n {
                let factor = matrix[i * n + k] / matrix[k * n + k];
                matrix[i * n + k] = factor;
                for j in k + 1..n {
                    matrix[i * n + j] -= factor * matrix[k * n + j];
                }
            }
        }
        true
    }

    /// Adds the solution of (1 - a J) change = base + a f(t, y) - y to y, by the factors.
    pub fn correct(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        a: f64,
        base: &[f64],
        y: &mut [f64],
    ) -> Work {
        let (n, matrix, change) = (self.dim, &self.matrix, &mut self.change);
        system.eval_f(t, y, &mut self.above);
        for i in 0..n {
            change[i] = base[i] + a * self.above[i] - y[i];
        }
        for (k, pivot) in self.pivots.iter().enumerate() {
            change.swap(k, *pivot);
        }
        for k in 0..n {
            for i in k + 1..n {
                change[i] -= matrix[i * n + k] * change[k];
            }
        }
        for k in (0..n).rev() {
            let rest: f64 = (k + 1..n).map(|j| matrix[k * n + j] * change[j]).sum();
            change[k] = (change[k] - rest) / matrix[k * n + k];
        }
        super::super::add_scaled(y, 1.0, change);
        Work {
            solves: 1,
            ..Work::of(1)
        }
    }

    /// Change of y by the last correction.
    pub fn change(&self) -> &[f64] {
        &self.change
    }

    /// Forms and factorises 1 - a J at y, to be kept. Returns the cost, and whether J is of use.
    pub fn keep(&mut self, system: &dyn ParticleSystem, t: f64, a: f64, y: &[f64]) -> (Work, bool) {
        let work = Work {
            factorizations: 1,
            ..self.form(system, t, a, y)
        };
        (work, self.factorise())
    }
}
