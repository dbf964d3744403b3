//! Trial steps: the interface of a method whose steps an adaptive integrator chooses.

use serde::{Deserialize, Serialize};

use super::error_norm::ErrorNorm;
use super::integrator::check_dim;
use crate::error::Error;
use crate::system::ParticleSystem;
use crate::work::Work;

/// Share of the tolerated error that a step aims at.
const SAFETY: f64 = 0.8;

/// A method that estimates the error of its step, and interpolates states within it.
pub(super) trait Trial: Send {
    /// Checks that the method supports the system as it is now.
    ///
    /// # Errors
    /// It does not.
    fn check(&self, _system: &dyn ParticleSystem) -> Result<(), Error> {
        Ok(())
    }

    /// Returns the length of the state.
    fn dim(&self) -> usize;

    /// Returns the power of h to which the estimated local error is proportional.
    fn exponent(&self) -> f64;

    /// Returns the factor for the next step, given this step's error relative to the tolerance.
    fn change(&self, error: f64) -> f64 {
        SAFETY * libm::pow(error, -1.0 / self.exponent())
    }

    /// Begins a step at an unrelated state y.
    fn begin(&mut self, system: &dyn ParticleSystem, t: f64, y: &[f64]) -> Work;

    /// Begins a step at y, the end of the last step after changes by contact.
    fn begin_again(&mut self, system: &dyn ParticleSystem, t: f64, y: &[f64]) -> Work {
        self.begin(system, t, y)
    }

    /// Begins a step at the end of the last one, and reuses its derivative.
    fn start_from_end(&mut self);

    /// Writes f at the beginning of the step to `out`.
    fn derivative(&self, system: &dyn ParticleSystem, out: &mut [f64]);

    /// Returns the second derivative of y at the beginning of a first step, where it is known and f
    /// is not the first.
    fn second_derivative(&self) -> Option<&[f64]> {
        None
    }

    /// Tries a step of h (s). Returns its cost, and its estimated error over the allowed one, which
    /// is at most 1 for an accepted step.
    fn attempt(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        norm: &ErrorNorm,
    ) -> (Work, f64);

    /// Returns the state at the end of the step.
    fn end(&self) -> &[f64];

    /// Writes the state at the fraction theta of an accepted step that began at t (s) to `out`.
    /// Returns the cost.
    fn interpolate(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        theta: f64,
        out: &mut [f64],
    ) -> Work;

    /// Returns the memory of the last step.
    fn last(&self) -> LastStep;

    /// Continues after a saved step.
    ///
    /// # Errors
    /// The step is of another method or of another system; nothing changes then.
    fn resume(&mut self, step: &LastStep) -> Result<(), Error>;
}

/// The last step of a method: the next one starts from it, and states within it are interpolated.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct LastStep {
    /// Length of the step (s).
    pub h: f64,
    /// State at the beginning.
    pub y0: Vec<f64>,
    /// State at the end.
    pub y1: Vec<f64>,
    /// Derivatives or other vectors of the stages, in the method's own order.
    pub k: Vec<Vec<f64>>,
    /// Whether the stages for states within the step have been computed.
    pub dense: bool,
    /// Other integers, in the method's own order.
    #[serde(default)]
    pub counts: Vec<usize>,
    /// Other numbers, in the method's own order.
    #[serde(default)]
    pub numbers: Vec<f64>,
}

impl LastStep {
    /// Creates the memory of a method with a number of stages, for a system of this dimension.
    pub fn new(dim: usize, stages: usize) -> Self {
        Self {
            h: 0.0,
            y0: vec![0.0; dim],
            y1: vec![0.0; dim],
            k: vec![vec![0.0; dim]; stages],
            dense: false,
            counts: vec![],
            numbers: vec![],
        }
    }

    /// Copies another step of the same shape.
    ///
    /// # Errors
    /// The step is of another method or of another system; nothing changes then.
    pub fn resume(&mut self, step: &Self) -> Result<(), Error> {
        let stages = self.k.len();
        if step.k.len() != stages {
            return Err(Error::Invalid(format!(
                "the last step has {} stages, but the method has {stages}",
                step.k.len()
            )));
        }
        let own = [&self.y0, &self.y1].into_iter().chain(&self.k);
        let others = [&step.y0, &step.y1].into_iter().chain(&step.k);
        for (own, other) in own.zip(others) {
            check_dim(own.len(), other)?;
        }
        self.clone_from(step);
        Ok(())
    }
}
