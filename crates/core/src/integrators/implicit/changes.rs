//! Changes of the state in the iterations of Newton's method, and prediction of further ones.

use crate::error::Error;

/// Relative change of the state at which the iteration ends: the next change would vanish in
/// rounding.
pub(super) const TOLERANCE: f64 = 1e-11;
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
            residual: 0.0,
        }
    }

    /// Adds a change that led to a state of this size, and the relative residual of its linear
    /// system.
    pub fn add(&mut self, change: f64, size: f64, residual: f64) {
        if self.first.is_nan() {
            self.first = change;
        } else {
            self.rate = change / self.last;
        }
        (self.last, self.size, self.residual) = (change, size, residual);
    }

    /// Returns the relative residual for the linear system of the next change.
    pub fn forcing(&self) -> f64 {
        // Divided by ten, because the next change may be larger than predicted.
        let enough = 0.1 * RESIDUAL_SHARE * TOLERANCE * self.size / (self.last * self.rate);
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

    /// Returns whether the last change, or the predicted next one, is negligible relative to the
    /// state and its linear system solved accurately enough; or whether changes no longer shrink,
    /// if the last one is below `noise`.
    pub fn are_over(&self, noise: f64) -> bool {
        let shrinks = if self.foretell {
            self.rate.min(1.0)
        } else {
            1.0
        };
        let stay = self.rate.is_finite() && self.rate >= 0.5;
        let none = TOLERANCE * self.size;
        self.last * shrinks <= none && self.last * self.residual <= RESIDUAL_SHARE * none
            || stay && self.last <= noise * self.size
    }

    /// Returns whether the last change is finite, so that another iteration is possible.
    pub fn are_finite(&self) -> bool {
        self.last.is_finite()
    }

    /// Returns the error for changes that are not negligible after all iterations.
    pub fn failure(&self) -> Error {
        Error::NoConvergence {
            residual: self.last / self.first,
        }
    }
}
