//! The changes that the iterations of Newton's method make, and what they foretell.

use crate::error::Error;

/// Change relative to the state at which the iteration ends: the next change would be lost in
/// rounding.
pub(super) const CLOSE: f64 = 1e-11;
/// Rate of convergence, a change over the one before it, up to which the tangent is kept for the
/// next iteration.
const KEPT: f64 = 0.03;
/// Relative residual to which the linear system of an iteration is solved that is not the last: a
/// more exact solution would change little, because the equations are not linear (Dembo, Eisenstat,
/// Steihaug, *Inexact Newton methods*, 1982).
const FORCING: f64 = 1e-3;
/// Least and largest relative residual of the iteration that is foretold to be the last.
const LAST: [f64; 2] = [1e-6, 0.1];
/// Part of a change that counts as none that the linear system of the last iteration may leave:
/// invariants, such as the momentum, drift by what it leaves in each step.
const LEFT: f64 = 1e-3;

/// The changes in one solution of the equations.
pub(super) struct Changes {
    /// Whether they foretell the next one, as with the tangent of smooth forces.
    foretell: bool,
    first: f64,
    last: f64,
    /// The last one over the one before it, infinite if there was none.
    rate: f64,
    /// Size of the state after the last one.
    size: f64,
    /// Relative residual to which the linear system of the last one was solved.
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
            residual: 0.0,
        }
    }

    /// Adds one, which left a state of this size, and whose linear system was solved to this
    /// relative residual.
    pub fn add(&mut self, change: f64, size: f64, residual: f64) {
        if self.first.is_nan() {
            self.first = change;
        } else {
            self.rate = change / self.last;
        }
        (self.last, self.size, self.residual) = (change, size, residual);
    }

    /// Relative residual to which the linear system of the next one is solved.
    pub fn forcing(&self) -> f64 {
        // A tenth, because the next one may be larger than foretold.
        let enough = 0.1 * LEFT * CLOSE * self.size / (self.last * self.rate);
        if self.foretell && enough >= LAST[0] {
            enough.min(LAST[1])
        } else {
            FORCING
        }
    }

    /// Whether they shrink so fast that the tangent can be kept; `None` if that is not known yet.
    pub fn shrink_fast(&self) -> Option<bool> {
        self.rate.is_finite().then_some(self.rate <= KEPT)
    }

    /// Whether the last one, or the next one where it is known to be about as much smaller again,
    /// is none relative to the size of the state, and solved so; or whether they no longer shrink,
    /// if the last one is below this `noise`.
    pub fn are_over(&self, noise: f64) -> bool {
        let shrinks = if self.foretell {
            self.rate.min(1.0)
        } else {
            1.0
        };
        let stay = self.rate.is_finite() && self.rate >= 0.5;
        let none = CLOSE * self.size;
        self.last * shrinks <= none && self.last * self.residual <= LEFT * none
            || stay && self.last <= noise * self.size
    }

    /// Whether the last one is a number, so that there can be a next one.
    pub fn are_finite(&self) -> bool {
        self.last.is_finite()
    }

    /// What is said if they are not over after all iterations.
    pub fn failure(&self) -> Error {
        Error::NoConvergence {
            residual: self.last / self.first,
        }
    }
}
