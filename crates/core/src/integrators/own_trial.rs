//! Steps of an own function that estimates their errors, so that they are chosen to a tolerance.

use std::cell::Cell;

use super::derivative::Derivative;
use super::embedded::{EmbeddedPair, Tableau};
use super::error_norm::ErrorNorm;
use super::integrator::{Integrator, check_dim};
use super::trial::{LastStep, Trial};
use crate::error::Error;
use crate::system::ParticleSystem;
use crate::work::Work;

/// Function that takes a step: from f, t (s), y and h (s), the state at t + h and the estimate of
/// its error.
pub(super) type Estimated =
    dyn Fn(&mut Derivative, f64, &[f64], f64) -> Result<[Vec<f64>; 2], Error> + Send + Sync;

/// The cubic through both ends of a step: a pair without stages of its own.
static CUBIC: Tableau = Tableau {
    stages: &[],
    weights: &[],
    errors: &[],
    exponent: 0.0,
    extra: &[],
    dense: &[],
};

/// Steps of an own function. Between the ends of a step, states are on the cubic through both.
pub(super) struct OwnTrial {
    name: &'static str,
    exponent: f64,
    step: &'static Estimated,
    /// Both ends of the last step, with their derivatives.
    ends: EmbeddedPair,
    /// Error of the last attempt.
    failure: Cell<Option<Error>>,
}

impl OwnTrial {
    /// Creates the steps of a method of this name, whose estimates fall as h to the power of
    /// `order`, for states of `dim` numbers.
    pub fn new(name: &'static str, order: u32, step: &'static Estimated, dim: usize) -> Self {
        Self {
            name,
            exponent: f64::from(order),
            step,
            ends: EmbeddedPair::new(&CUBIC, dim),
            failure: Cell::new(None),
        }
    }

    /// Takes a step of h (s) from y at t (s). Returns the state after it, the estimate of its
    /// error, and its cost.
    fn take(
        &self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &[f64],
    ) -> Result<([Vec<f64>; 2], Work), Error> {
        let mut f = Derivative::new(system);
        let found = (self.step)(&mut f, t, y, h)?;
        match found.iter().find(|numbers| numbers.len() != y.len()) {
            None => Ok((found, f.work())),
            Some(numbers) => Err(Error::Callback(format!(
                "the method {} returned {} numbers, but the state has {}",
                self.name,
                numbers.len(),
                y.len()
            ))),
        }
    }
}

impl Integrator for OwnTrial {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        check_dim(self.ends.dim(), y)?;
        let ([next, _], work) = self.take(system, t, h, y)?;
        y.copy_from_slice(&next);
        Ok(work)
    }
}

impl Trial for OwnTrial {
    fn check(&self, _system: &dyn ParticleSystem) -> Result<(), Error> {
        self.failure.take().map_or(Ok(()), Err)
    }

    fn dim(&self) -> usize {
        self.ends.dim()
    }

    fn exponent(&self) -> f64 {
        self.exponent
    }

    fn begin(&mut self, system: &dyn ParticleSystem, t: f64, y: &[f64]) -> Work {
        self.ends.begin(system, t, y)
    }

    fn start_from_end(&mut self) {
        self.ends.start_from_end();
    }

    fn derivative(&self, system: &dyn ParticleSystem, out: &mut [f64]) {
        self.ends.derivative(system, out);
    }

    fn attempt(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        norm: &ErrorNorm,
    ) -> (Work, f64) {
        let ([next, estimate], mut work) = match self.take(system, t, h, self.ends.start()) {
            Ok(taken) => taken,
            Err(failure) => {
                self.failure.set(Some(failure));
                return (Work::default(), f64::NAN);
            }
        };
        let error = norm.of(self.ends.start(), &next, &estimate);
        self.ends.end_at(h, &next);
        if error <= 1.0 {
            work += self.ends.finish(system, t);
        }
        (work, error)
    }

    fn end(&self) -> &[f64] {
        self.ends.end()
    }

    fn interpolate(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        theta: f64,
        out: &mut [f64],
    ) -> Work {
        self.ends.interpolate(system, t, theta, out)
    }

    fn last(&self) -> LastStep {
        self.ends.last()
    }

    fn resume(&mut self, step: &LastStep) -> Result<(), Error> {
        self.ends.resume(step)
    }
}
