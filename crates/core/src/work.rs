//! The work of a step.

use serde::{Deserialize, Serialize};

/// Work of a step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Work {
    /// Number of evaluations of f(t, y), or of the forces.
    pub evaluations: u64,
    /// Number of linear systems solved.
    pub solves: u64,
    /// Number of iterations of conjugate gradients.
    pub iterations: u64,
    /// Number of matrices factorised.
    pub factorizations: u64,
    /// Cost of the linear algebra, in evaluations, at prices that are the same on every machine.
    pub algebra: f64,
    /// Largest relative residual of a solve.
    pub residual: f64,
    /// Number of steps of an adaptive method that were rejected as too inaccurate.
    pub rejections: u64,
}

impl Work {
    /// Creates the work of a number of evaluations, and nothing else.
    #[must_use]
    pub fn of(evaluations: u64) -> Self {
        Self { evaluations, ..Self::default() }
    }

    /// Returns the total cost, in evaluations.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.evaluations as f64 + self.algebra
    }
}

impl std::ops::AddAssign for Work {
    fn add_assign(&mut self, other: Self) {
        self.evaluations += other.evaluations;
        self.solves += other.solves;
        self.iterations += other.iterations;
        self.factorizations += other.factorizations;
        self.algebra += other.algebra;
        self.residual = self.residual.max(other.residual);
        self.rejections += other.rejections;
    }
}
