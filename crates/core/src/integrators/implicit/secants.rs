//! Secants for Newton's method with an inexact tangent: the last few steps s of v, with the change
//! y of the residual over each, correct the tangent to one that maps s to y (limited-memory BFGS:
//! Nocedal, *Updating quasi-Newton matrices with limited storage*, 1980; with the tangent of an
//! implicit step: Liu, Bouaziz, Kavan, *Quasi-Newton methods for real-time simulation of
//! hyperelastic materials*, 2017).

use super::super::arithmetic::add_scaled;
use super::newton::dot;

/// Largest number of secants.
const MAX_SECANTS: usize = 8;
/// Least cosine of the angle between a step and the change of the residual over it: with less, the
/// residual hardly falls along the step.
const MIN_COSINE: f64 = 1e-6;

/// The last secants, oldest first.
pub(super) struct Secants {
    kept: Vec<Secant>,
    count: usize,
}

#[derive(Default)]
struct Secant {
    step: Vec<f64>,
    /// Change of the residual, with the opposite sign.
    change: Vec<f64>,
    /// Scalar product of both.
    product: f64,
    /// Coefficient of the step in the solution for the right-hand side.
    share: f64,
}

impl Secants {
    /// Creates an empty list, with room for secants of systems of n equations.
    pub fn new(equations: usize) -> Self {
        let room = || Secant {
            step: Vec::with_capacity(equations),
            change: Vec::with_capacity(equations),
            ..Secant::default()
        };
        Self {
            kept: (0..MAX_SECANTS).map(|_| room()).collect(),
            count: 0,
        }
    }

    /// Forgets all.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds the secant of a step that took the residual from one to another.
    pub fn add(&mut self, step: &[f64], share: f64, from: &[f64], to: &[f64]) {
        if self.count == MAX_SECANTS {
            self.kept.rotate_left(1);
            self.count -= 1;
        }
        let secant = &mut self.kept[self.count];
        secant.step.clear();
        secant.step.extend(step.iter().map(|s| share * s));
        secant.change.clear();
        secant
            .change
            .extend(from.iter().zip(to).map(|(from, to)| from - to));
        secant.product = dot(&secant.step, &secant.change);
        let sizes = dot(&secant.step, &secant.step) * dot(&secant.change, &secant.change);
        if secant.product > MIN_COSINE * sizes.sqrt() {
            self.count += 1;
        }
    }

    /// Removes the part of a right-hand side that the secants solve.
    pub fn reduce(&mut self, rhs: &mut [f64]) {
        for secant in self.kept[..self.count].iter_mut().rev() {
            secant.share = dot(&secant.step, rhs) / secant.product;
            add_scaled(rhs, -secant.share, &secant.change);
        }
    }

    /// Adds the part that the secants solve to the solution of the reduced system.
    pub fn complete(&self, solution: &mut [f64]) {
        for secant in &self.kept[..self.count] {
            let share = secant.share - dot(&secant.change, solution) / secant.product;
            add_scaled(solution, share, &secant.step);
        }
    }
}
