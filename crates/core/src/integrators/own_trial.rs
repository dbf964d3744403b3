//! Steps of an own function that estimates their errors, so that they are chosen to a tolerance.

use std::cell::Cell;

use super::derivative::Derivative;
use super::embedded::{EmbeddedPair, Tableau};
use super::error_norm::ErrorNorm;
use super::integrator::{Integrator, check_dim};
use super::sweep::add_scaled;
use super::trial::{LastStep, Trial};
use crate::error::Error;
use crate::system::ParticleSystem;
use crate::work::Work;

/// Function that takes a step: from f, t (s), y and h (s), the state at t + h, the estimate of its
/// error and, if there are more, the coefficients q of the polynomial within the step, y + theta
/// `q_1` + theta^2 `q_2` + ...
pub(super) type Estimated =
    dyn Fn(&mut Derivative, f64, &[f64], f64) -> Result<Vec<Vec<f64>>, Error> + Send + Sync;

/// The cubic through both ends of a step: a pair without stages of its own.
static CUBIC: Tableau = Tableau {
    stages: &[],
    weights: &[],
    errors: &[],
    exponent: 0.0,
    extra: &[],
    dense: &[],
    powers: &[],
};

/// Stages of that pair: the derivatives at both ends.
const ENDS: usize = 2;

/// Steps of an own function. Between the ends of a step, states are on its polynomial or, if it has
/// none, on the cubic through both.
pub(super) struct OwnTrial {
    name: &'static str,
    exponent: f64,
    step: &'static Estimated,
    /// Both ends of the last step, with their derivatives.
    ends: EmbeddedPair,
    /// Coefficients of its polynomial; none for the cubic.
    within: Vec<Vec<f64>>,
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
            within: vec![],
            failure: Cell::new(None),
        }
    }

    /// Takes a step of h (s) from y at t (s). Returns what the function returned, and its cost.
    fn take(
        &self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &[f64],
    ) -> Result<(Vec<Vec<f64>>, Work), Error> {
        let mut f = Derivative::new(system);
        let found = (self.step)(&mut f, t, y, h)?;
        let wrong = found.iter().find(|numbers| numbers.len() != y.len());
        if wrong.is_none() && found.len() >= ENDS {
            return Ok((found, f.work()));
        }
        Err(Error::Callback(format!(
            "the method {} returned {} numbers, but the state has {}",
            self.name,
            wrong.map_or(0, Vec::len),
            y.len()
        )))
    }

    /// Keeps the polynomial of a step that ended, if it has one.
    ///
    /// # Errors
    /// It does not end where the step does.
    fn keep(&mut self, within: &[Vec<f64>], norm: &ErrorNorm) -> Result<(), Error> {
        self.within = within.to_vec();
        let (start, end) = (self.ends.start(), self.ends.end());
        let gap = |k: usize| end[k] - start[k] - within.iter().map(|q| q[k]).sum::<f64>();
        let gaps: Vec<_> = (0..start.len()).map(gap).collect();
        if within.is_empty() || norm.of(start, end, &gaps) <= 1.0 {
            return Ok(());
        }
        Err(Error::Callback(format!(
            "the coefficients that the method {} returned do not sum to the change of its step",
            self.name
        )))
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
        let (found, work) = self.take(system, t, h, y)?;
        y.copy_from_slice(&found[0]);
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
        let (found, mut work) = match self.take(system, t, h, self.ends.start()) {
            Ok(taken) => taken,
            Err(failure) => {
                self.failure.set(Some(failure));
                return (Work::default(), f64::NAN);
            }
        };
        let error = norm.of(self.ends.start(), &found[0], &found[1]);
        self.ends.end_at(h, &found[0]);
        if error <= 1.0 {
            if let Err(failure) = self.keep(&found[ENDS..], norm) {
                self.failure.set(Some(failure));
                return (work, f64::NAN);
            }
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
        if self.within.is_empty() {
            return self.ends.interpolate(system, t, theta, out);
        }
        out.copy_from_slice(self.ends.start());
        let mut power = 1.0;
        for q in &self.within {
            power *= theta;
            add_scaled(out, power, q);
        }
        Work::default()
    }

    fn last(&self) -> LastStep {
        let mut last = self.ends.last();
        last.k.extend(self.within.iter().cloned());
        last
    }

    fn resume(&mut self, step: &LastStep) -> Result<(), Error> {
        let mut ends = step.clone();
        let within = ends.k.split_off(ENDS.min(ends.k.len()));
        within.iter().try_for_each(|q| check_dim(self.dim(), q))?;
        self.ends.resume(&ends)?;
        self.within = within;
        Ok(())
    }
}
