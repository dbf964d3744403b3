//! Implicit stages of a small system without masses, or of rigid bodies, by Newton's method with
//! the Jacobian J from central differences.

use super::changes::Changes;
use super::{MOST, Newton, norm};
use crate::error::Error;
use crate::integrators::{Work, check_dim};
use crate::system::ParticleSystem;

/// Largest number of unknowns; the Jacobian of a larger system takes too long.
pub(super) const LARGEST: usize = 1024;

/// The numbers of the state that the equations are solved for: all, but for those of what rigid
/// bodies carry, which no f reads.
pub(super) fn unknowns(system: &dyn ParticleSystem) -> Vec<usize> {
    let all = 0..system.dim();
    match system.rigid() {
        Some(rigid) => all.filter(|k| !rigid.is_carried(*k)).collect(),
        None => all.collect(),
    }
}

/// Solver of the implicit stages of a small system, with its scratch. What rigid bodies carry
/// stays as it is.
pub(super) struct Dense {
    dim: usize,
    unknowns: Vec<usize>,
    /// Matrix 1 - a J, row by row, or its factors L and U in place.
    matrix: Vec<f64>,
    /// Row that was exchanged with each row in turn.
    pivots: Vec<usize>,
    /// Change of the unknowns, and of the whole state.
    solution: Vec<f64>,
    change: Vec<f64>,
    at: Vec<f64>,
    above: Vec<f64>,
    below: Vec<f64>,
}

impl Dense {
    pub fn new(system: &dyn ParticleSystem) -> Self {
        let (dim, unknowns) = (system.dim(), unknowns(system));
        // A system that is too large is refused.
        let room = Some(unknowns.len()).filter(|count| *count <= LARGEST);
        let room = room.unwrap_or(0);
        Self {
            dim,
            unknowns,
            matrix: vec![0.0; room * room],
            pivots: vec![0; room],
            solution: vec![0.0; room],
            change: vec![0.0; dim],
            at: vec![0.0; dim],
            above: vec![0.0; dim],
            below: vec![0.0; dim],
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
        let mut changes = Changes::new(true);
        for iteration in 0..MOST {
            if iteration == 0 || changes.shrink_fast() == Some(false) {
                let (formed, of_use) = self.keep(system, t, a, y);
                work += formed;
                if !of_use {
                    break;
                }
            }
            work += self.correct(system, t, a, base, y);
            changes.add(norm(&self.change), norm(y), 0.0);
            if newton == Newton::Once || changes.are_over(1e-9) {
                return Ok(work);
            }
            if !changes.are_finite() {
                break;
            }
        }
        Err(changes.failure())
    }

    /// Writes 1 - a J at y into the matrix.
    fn form(&mut self, system: &dyn ParticleSystem, t: f64, a: f64, y: &[f64]) -> Work {
        let count = self.unknowns.len();
        let Self {
            unknowns,
            matrix,
            at,
            above,
            below,
            ..
        } = self;
        at.copy_from_slice(y);
        for (column, &j) in unknowns.iter().enumerate() {
            let h = 1e-6 * y[j].abs().max(1.0);
            at[j] = y[j] + h;
            system.eval_f(t, at, above);
            at[j] = y[j] - h;
            system.eval_f(t, at, below);
            at[j] = y[j];
            for (row, &i) in unknowns.iter().enumerate() {
                let slope = (above[i] - below[i]) / (2.0 * h);
                matrix[row * count + column] = f64::from(i == j) - a * slope;
            }
        }
        Work::of(2 * count as u64)
    }

    /// Factorises the matrix by Gaussian elimination with partial pivoting. Returns false if it is
    /// singular or not finite.
    fn factorise(&mut self) -> bool {
        let (n, matrix) = (self.unknowns.len(), &mut self.matrix);
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
        let (n, matrix, change) = (self.unknowns.len(), &self.matrix, &mut self.solution);
        system.eval_f(t, y, &mut self.above);
        for (change, &i) in change.iter_mut().zip(&self.unknowns) {
            *change = base[i] + a * self.above[i] - y[i];
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
        for (change, &i) in change.iter().zip(&self.unknowns) {
            self.change[i] = *change;
        }
        super::super::add_scaled(y, 1.0, &self.change);
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
