//! Implicit stages of a small system without masses, by Newton's method with the Jacobian J from
//! central differences.

use super::{CLOSE, MOST, Newton, norm};
use crate::error::Error;
use crate::integrators::{Work, check_dim};
use crate::system::ParticleSystem;

/// Largest dimension; the Jacobian of a larger system takes too long.
const LARGEST: usize = 1024;

/// Solver of the implicit stages of a small system, with its scratch.
pub(super) struct Dense {
    dim: usize,
    /// Matrix 1 - a J, row by row.
    matrix: Vec<f64>,
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
        let dim = self.dim;
        if dim > LARGEST {
            return Err(Error::Invalid(format!(
                "implicit methods serve systems without masses up to a state of {LARGEST} numbers, and this has {dim}: \
                 use an explicit one"
            )));
        }
        check_dim(dim, y)?;
        let Self {
            matrix,
            change,
            at,
            above,
            below,
            ..
        } = self;
        let mut work = Work::default();
        let (mut first, mut last) = (f64::NAN, f64::INFINITY);
        for iteration in 0..MOST {
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
            system.eval_f(t, y, above);
            work += Work {
                solves: 1,
                factorizations: 1,
                ..Work::of(2 * dim as u64 + 1)
            };
            for i in 0..dim {
                change[i] = base[i] + a * above[i] - y[i];
            }
            if !eliminate(matrix, change) {
                break;
            }
            super::super::add_scaled(y, 1.0, change);
            let size = norm(change);
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
}

/// Solves the linear system in place by Gaussian elimination with partial pivoting. Returns false
/// if the matrix is singular or not finite.
fn eliminate(matrix: &mut [f64], b: &mut [f64]) -> bool {
    let n = b.len();
    for k in 0..n {
        let size = |i: usize, matrix: &[f64]| matrix[i * n + k].abs();
        let pivot = (k..n)
            .max_by(|&i, &j| size(i, matrix).total_cmp(&size(j, matrix)))
            .unwrap_or(k);
        if !(size(pivot, matrix) > 0.0 && size(pivot, matrix).is_finite()) {
            return false;
        }
        for j in 0..n {
            matrix.swap(k * n + j, pivot * n + j);
        }
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = matrix[i * n + k] / matrix[k * n + k];
            for j in k..n {
                matrix[i * n + j] -= factor * matrix[k * n + j];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        let rest: f64 = (k + 1..n).map(|j| matrix[k * n + j] * b[j]).sum();
        b[k] = (b[k] - rest) / matrix[k * n + k];
    }
    true
}
