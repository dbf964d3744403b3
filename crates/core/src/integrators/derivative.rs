//! The derivative of a system, as functions of others get it: steps of own methods, and solvers of
//! other libraries.

use super::integrator::check_dim;
use crate::error::Error;
use crate::system::ParticleSystem;
use crate::work::Work;

/// The derivative f(t, y) of a system, for a step of an own method. It counts its evaluations.
pub struct Derivative<'a> {
    system: &'a dyn ParticleSystem,
    dim: usize,
    evaluations: u64,
    /// Largest number of evaluations.
    most: f64,
}

impl<'a> Derivative<'a> {
    /// Creates the derivative of a system, which nothing has evaluated yet, for a step of an own
    /// [`Integrator`](super::Integrator).
    #[must_use]
    pub fn new(system: &'a dyn ParticleSystem) -> Self {
        Self { system, dim: system.dim(), evaluations: 0, most: f64::INFINITY }
    }

    /// Refuses evaluations beyond this number.
    pub(crate) fn with_most(self, most: f64) -> Self {
        Self { most, ..self }
    }

    /// Returns whether an evaluation was refused, because there were too many.
    #[must_use]
    pub fn is_spent(&self) -> bool {
        self.evaluations as f64 > self.most
    }

    /// Returns the evaluations until now.
    #[must_use]
    pub fn work(&self) -> Work {
        Work::of(self.evaluations)
    }
}

impl Derivative<'_> {
    /// Returns f(t, y).
    ///
    /// # Errors
    /// The length of y is not that of the system's state, or the system reports a failure.
    pub fn at(&mut self, t: f64, y: &[f64]) -> Result<Vec<f64>, Error> {
        let mut dydt = vec![0.0; self.dim];
        self.write(t, y, &mut dydt)?;
        Ok(dydt)
    }

    /// Writes f(t, y) to `dydt`.
    ///
    /// # Errors
    /// As [`at`](Self::at); also if the length of `dydt` is not that of the system's state.
    pub fn write(&mut self, t: f64, y: &[f64], dydt: &mut [f64]) -> Result<(), Error> {
        check_dim(self.dim, y)?;
        check_dim(self.dim, dydt)?;
        self.evaluations += 1;
        if self.is_spent() {
            let why = format!("more than {:.0} evaluations cost too much here", self.most);
            return Err(Error::Callback(why));
        }
        self.system.eval_f(t, y, dydt);
        self.system.take_failure().map_or(Ok(()), Err)
    }

    /// Returns the system.
    #[must_use]
    pub fn system(&self) -> &dyn ParticleSystem {
        self.system
    }
}

/// Function that runs a whole span of time.
pub(crate) type Solve =
    dyn Fn(&mut Derivative, &[f64], &[f64], f64) -> Result<Vec<f64>, Error> + Send + Sync;
