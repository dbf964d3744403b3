//! Implicit stages of a small system without masses, or of rigid bodies, by Newton's method with
//! the Jacobian J of the system's own or from central differences.

use super::newton::{Changes, MAX_ITERATIONS, Newton, dot};
use crate::error::Error;
use crate::integrators::integrator::check_dim;
use crate::integrators::method::MAX_DENSE;
use crate::integrators::sweep::add_scaled;
use crate::measure::Measure;
use crate::system::{ParticleSystem, rigid_of};
use crate::work::Work;

/// Half the step of a difference quotient, over the unit of the number.
const DIFFERENCE_SHARE: f64 = 1e-6;
/// The same for speeds, relative to that for positions: the resulting motion is tiny.
const SPEED_DIFFERENCE_SHARE: f64 = 1e-3;

/// Lists the numbers of the state that the equations are solved for: all, except those of particles
/// on rigid bodies, which f does not read.
pub(super) fn unknowns(system: &dyn ParticleSystem) -> Vec<usize> {
    let mut all = vec![];
    system.measures(&mut |numbers, _| all.extend(numbers));
    all
}

/// Solver of the implicit stages of a small system, with its scratch. Particles on rigid bodies
/// stay as they are.
pub(crate) struct Dense {
    dim: usize,
    unknowns: Vec<usize>,
    /// Unit of each unknown, in which changes are compared, and half the step of its difference
    /// quotient.
    units: Vec<[f64; 2]>,
    /// Matrix 1 - a J, row by row, or its factors L and U in place.
    matrix: Vec<f64>,
    /// Row that each row was exchanged with, in turn.
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
        // Systems that are too large are refused, and need no room.
        let room = Some(unknowns.len()).filter(|count| *count <= MAX_DENSE);
        let room = room.unwrap_or(0);
        Self {
            dim,
            units: Vec::with_capacity(unknowns.len()),
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

    /// Solves y = base + a f(t, y), starting from the guess y.
    pub(super) fn solve(
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
        for iteration in 0..MAX_ITERATIONS {
            if iteration == 0 || changes.shrink_fast() == Some(false) {
                let (formed, of_use) = self.keep(system, t, a, y);
                work += formed;
                if !of_use {
                    break;
                }
            }
            work += self.correct(system, t, a, base, y);
            // Where bodies are does not matter.
            let size = match rigid_of(system) {
                Some(_) => (self.unknowns.len() as f64).sqrt(),
                None => self.norm(y),
            };
            changes.add(self.norm(&self.change), size, 0.0);
            if newton == Newton::Once || changes.are_over(1e-9) {
                return Ok(work);
            }
            if !changes.are_finite() {
                break;
            }
        }
        Err(changes.failure())
    }

    /// Returns the norm of the unknowns in a state, in their units.
    fn norm(&self, y: &[f64]) -> f64 {
        let numbers = self.unknowns.iter().zip(&self.units);
        let squares = numbers.map(|(i, [unit, _])| (y[*i] / unit).powi(2));
        squares.sum::<f64>().sqrt()
    }

    /// Finds the units at y. With rigid bodies they are the largest radius, the speed that covers
    /// it in a time a, the length of a quaternion, and the angular momentum at which the body's
    /// surface has that speed; without bodies, plain numbers.
    fn measure(&mut self, system: &dyn ParticleSystem, a: f64, y: &[f64]) {
        let mut length: f64 = 0.0;
        system.measures(&mut |_, measure| {
            if let Measure::Rotation { radius } = measure {
                length = length.max(radius);
            }
        });
        let speed = length / a.abs();
        self.units.clear();
        system.measures(&mut |numbers, measure| {
            let unit = match measure {
                Measure::Position => length,
                Measure::Rotation { .. } => dot(&y[numbers.clone()], &y[numbers.clone()]).sqrt(),
                Measure::Velocity => speed,
                Measure::Momentum { speed: own } => speed / own,
                Measure::Plain | Measure::Alike => 0.0,
            };
            let difference = match measure {
                Measure::Position | Measure::Rotation { .. } => DIFFERENCE_SHARE * unit,
                _ => SPEED_DIFFERENCE_SHARE * DIFFERENCE_SHARE * unit,
            };
            self.units.extend(numbers.map(|k| {
                if unit > 0.0 {
                    [unit, difference]
                } else {
                    [1.0, DIFFERENCE_SHARE * y[k].abs().max(1.0)]
                }
            }));
        });
    }

    /// Writes 1 - a J at y into the matrix. A Jacobian that the system knows counts as an
    /// evaluation for each of its columns, one by differences as two.
    fn form(&mut self, system: &dyn ParticleSystem, t: f64, a: f64, y: &[f64]) -> Work {
        self.measure(system, a, y);
        let count = self.unknowns.len();
        let Self {
            unknowns,
            units,
            matrix,
            at,
            above,
            below,
            ..
        } = self;
        if count == y.len() && system.jacobian(t, y, matrix) {
            for (k, slope) in matrix.iter_mut().enumerate() {
                *slope = f64::from(k % (count + 1) == 0) - a * *slope;
            }
            return Work::of(count as u64);
        }
        at.copy_from_slice(y);
        for (column, &j) in unknowns.iter().enumerate() {
            let [_, h] = units[column];
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
            let (above, below) = matrix.split_at_mut((k + 1) * n);
            let pivots = &above[k * n + k..];
            for row in below.chunks_exact_mut(n) {
                let row = &mut row[k..];
                let factor = row[0] / pivots[0];
                row[0] = factor;
                // Zero if particles do not act on one another, as most do not.
                if factor != 0.0 {
                    for (x, pivot) in row[1..].iter_mut().zip(&pivots[1..]) {
                        *x -= factor * pivot;
                    }
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
        add_scaled(y, 1.0, &self.change);
        Work {
            solves: 1,
            ..Work::of(1)
        }
    }

    /// Returns the change of y by the last correction.
    pub fn change(&self) -> &[f64] {
        &self.change
    }

    /// Forms and factorises 1 - a J at y. Returns the cost, and whether that succeeded.
    pub fn keep(&mut self, system: &dyn ParticleSystem, t: f64, a: f64, y: &[f64]) -> (Work, bool) {
        let work = Work {
            factorizations: 1,
            ..self.form(system, t, a, y)
        };
        (work, self.factorise())
    }
}
