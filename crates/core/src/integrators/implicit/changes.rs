//! The changes that the iterations of Newton's method make, and what they foretell.

use crate::error::Error;

/// Change relative to the state at which the iteration ends: the next change would be lost in
/// rounding.
pub(super) const CLOSE: f64 = 1e-11;
/// Rate of convergence, a change over the one before it, up to which the tangent is kept for the
/// next iteration.
const KEPT: f64 = 0.03;

/// The changes in one solution of the equations.
pub(super) struct Changes {
    /// Whether they foretell the next one, as with the tangent of smooth forces.
    foretell: bool,
    first: f64,
    last: f64,
    /// The last one over the one before it, infinite if there was none.
    rate: f64,
}

impl Changes {
    pub fn new(foretell: bool) -> Self {
        Self {
            foretell,
            first: f64::NAN,
            last: f64::NAN,
            rate: f64::INFINITY,
        }
    }

    pub fn add(&mut self, change: f64) {
        if self.first.is_nan() {
            self.first = change;
        } else {
            self.rate = change / self.last;
        }
        self.last = change;
    }

    /// Whether they shrink so fast that the tangent can be kept; `None` if that is not known yet.
    pub fn shrink_fast(&self) -> Option<bool> {
        self.rate.is_finite().then_some(self.rate <= KEPT)
    }

    /// Whether the last one, or the next one where it is known to be about as much smaller again,
    /// is none relative to the `size` of the state; or whether they no longer shrink, if the last
    /// one is below this `noise`.
    pub fn are_over(&self, size: f64, noise: f64) -> bool {
        let shrinks = if self.foretell {
            self.rate.min(1.0)
        } else {
            1.0
        };
        let stay = self.rate.is_finite() && self.rate >= 0.5;
        self.last * shrinks <= CLOSE * size || stay && self.last <= noise * size
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
