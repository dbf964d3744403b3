//! Newton's method: numbers of iterations, changes of the state in them, and predictions of further
//! ones.
//!
//! Secants for Newton's method with an inexact tangent: the last few steps s of v, with the change
//! y of the residual over each, correct the tangent to one that maps s to y (limited-memory BFGS:
//! Nocedal, *Updating quasi-Newton matrices with limited storage*, 1980; with the tangent of an
//! implicit step: Liu, Bouaziz, Kavan, *Quasi-Newton methods for real-time simulation of
//! hyperelastic materials*, 2017).
//!
//! Backward differences `D_1`, `D_2`, ... of the states at the ends of equal steps, and their
//! change with the step on the same polynomial.

use super::super::sweep::add_scaled;
use crate::error::Error;

/// Largest number of iterations of Newton's method.
pub(super) const MAX_ITERATIONS: u32 = 30;
/// The same where one iteration is enough.
const MAX_TRIED: u32 = 12;

/// Number of iterations of Newton's method.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Newton {
    /// One iteration, with compressed springs clamped; of rigid bodies more, if they lead to a
    /// solution.
    Once,
    /// Iterations until the state no longer changes.
    Full,
    /// The same for the middle of a step, at whose end constraints are met.
    Mirrored,
}

impl Newton {
    /// Returns the largest number of iterations.
    pub fn most(self) -> u32 {
        if self == Self::Once { MAX_TRIED } else { MAX_ITERATIONS }
    }
}

/// Returns the Euclidean norm.
pub(super) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Returns the scalar product.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

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
        Self { kept: (0..MAX_SECANTS).map(|_| room()).collect(), count: 0 }
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
        secant.change.extend(from.iter().zip(to).map(|(from, to)| from - to));
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

/// Relative change of the state at which the iteration ends: the next change would vanish in
/// rounding.
pub(super) const TOLERANCE: f64 = 1e-11;
/// Change of plain numbers, relative to the state, that may be a rounding error of f.
pub(super) const NOISE: f64 = 1e-9;
/// Ratio of consecutive changes up to which the tangent is kept for the next iteration.
const MAX_KEPT_RATE: f64 = 0.03;
/// Relative residual of the linear system in all iterations except the last: the equations are
/// nonlinear, so a more exact solution would not help (Dembo, Eisenstat, Steihaug, *Inexact Newton
/// methods*, 1982).
const FORCING: f64 = 1e-3;
/// Least and largest relative residual in the iteration that is predicted to be the last.
const LAST_RESIDUALS: [f64; 2] = [1e-6, 0.1];
/// Part of a negligible change that the linear system of the last iteration may leave: in each
/// step, invariants such as the momentum drift by that part.
const RESIDUAL_SHARE: f64 = 1e-3;

/// Changes in one solution of the equations.
pub(super) struct Changes {
    /// Whether they predict the next one, as they do with the tangent of smooth forces.
    foretell: bool,
    first: f64,
    last: f64,
    /// Ratio of the last change to the one before it; infinite without such.
    rate: f64,
    /// Size of the state after the last change.
    size: f64,
    /// Change that counts as negligible.
    none: f64,
    /// Relative residual of the linear system of the last change.
    residual: f64,
}

impl Changes {
    pub fn new(foretell: bool) -> Self {
        Self {
            foretell,
            first: f64::NAN,
            last: f64::NAN,
            rate: f64::INFINITY,
            size: f64::NAN,
            none: f64::NAN,
            residual: 0.0,
        }
    }

    /// Adds a change that led to a state of this size, the change that is negligible there, and the
    /// relative residual of its linear system.
    pub fn add(&mut self, change: f64, [size, none]: [f64; 2], residual: f64) {
        if self.first.is_nan() {
            self.first = change;
        } else {
            self.rate = change / self.last;
        }
        (self.last, self.residual) = (change, residual);
        (self.size, self.none) = (size, none);
    }

    /// Returns the relative residual for the linear system of the next change.
    pub fn forcing(&self) -> f64 {
        // Divided by ten, because the next change may be larger than predicted.
        let enough = 0.1 * RESIDUAL_SHARE * self.none / (self.last * self.rate);
        if self.foretell && enough >= LAST_RESIDUALS[0] {
            enough.min(LAST_RESIDUALS[1])
        } else {
            FORCING
        }
    }

    /// Returns whether changes shrink so fast that the tangent can be kept; `None` if unknown yet.
    pub fn shrink_fast(&self) -> Option<bool> {
        self.rate.is_finite().then_some(self.rate <= MAX_KEPT_RATE)
    }

    /// Returns whether the last change, or the predicted next one, is negligible and its linear
    /// system solved accurately enough; or whether changes no longer shrink, if the last one is
    /// below `noise`, relative to the state.
    pub fn are_over(&self, noise: f64) -> bool {
        let shrinks = if self.foretell { self.rate.min(1.0) } else { 1.0 };
        let stay = self.rate.is_finite() && self.rate >= 0.5;
        let none = self.none;
        self.last * shrinks <= none && self.last * self.residual <= RESIDUAL_SHARE * none
            || stay && self.last <= noise * self.size
    }

    /// Returns whether the next change is no larger than the last one.
    pub fn shrink_to(&self, next: f64) -> bool {
        next <= self.last
    }

    /// Returns whether the last change went too far, because the next one is larger, and not by a
    /// rounding error.
    pub fn overshoot(&self, next: f64) -> bool {
        !self.shrink_to(next) && self.last > NOISE * self.size
    }

    /// Returns whether the last change is finite, so that another iteration is possible.
    pub fn are_finite(&self) -> bool {
        self.last.is_finite()
    }

    /// Returns the error for changes that are not negligible after all iterations.
    pub fn failure(&self) -> Error {
        Error::NoConvergence { residual: self.last / self.first }
    }
}

/// Largest number of differences.
pub(super) const MAX_ORDER: usize = 5;

/// Changes `k` to the differences of states `ratio` times as far apart, on the same polynomial.
pub(super) fn rescale(k: &mut [Vec<f64>], ratio: f64) {
    let order = k.len();
    // The polynomial through the ends is y0 + sum s (s + 1) ... (s + j - 1) / j! D_j: the new
    // differences are sums of the old ones, with a product of two triangular matrices as weights.
    let of_ratio = |i: usize, j: usize, ratio: f64| -> f64 {
        (1..=i).map(|m| (m as f64 - 1.0 - ratio * j as f64) / m as f64).product()
    };
    let mut old = [0.0; MAX_ORDER];
    let mut weights = [[0.0; MAX_ORDER]; MAX_ORDER];
    for (i, row) in weights[..order].iter_mut().enumerate() {
        for (j, weight) in row[..order].iter_mut().enumerate() {
            *weight =
                (1..=order).map(|m| of_ratio(j + 1, m, ratio) * of_ratio(m, i + 1, 1.0)).sum();
        }
    }
    for number in 0..k.first().map_or(0, Vec::len) {
        for (old, d) in old.iter_mut().zip(&*k) {
            *old = d[number];
        }
        for (d, weights) in k.iter_mut().zip(&weights[..order]) {
            let terms = weights[..order].iter().zip(&old);
            d[number] = terms.map(|(weight, old)| weight * old).sum();
        }
    }
}
