//! Steps a run: at a fixed step, or adaptively.

use crate::control::Control;
use crate::error::Error;
use crate::integrators::{Adaptive, AdaptiveState, Integrator, Method, Taken, Work};
use crate::scene::Scene;
use crate::system::ParticleSystem;

/// Integrator of a run.
pub(super) enum Stepper {
    /// Takes steps of a fixed length.
    Fixed(Box<dyn Integrator>),
    /// Takes steps whose length the method chooses.
    Adaptive(Box<Adaptive>),
}

impl Stepper {
    /// Creates the stepper of a method for a scene, whose system is as it is now.
    ///
    /// # Errors
    /// The method does not support the system or the control.
    pub fn new(
        method: &Method,
        scene: &Scene,
        system: &dyn ParticleSystem,
        control: Control,
    ) -> Result<Self, Error> {
        method.check_control(control)?;
        let adaptive = match control {
            Control::Step(_) => None,
            Control::Tolerance(relative) => method.adaptive(system, scene.tolerance(relative)?),
        };
        // The integrator is made in any case: it checks that the method supports the system.
        let integrator = method.integrator(system)?;
        Ok(match adaptive {
            None => Self::Fixed(integrator),
            Some(adaptive) => Self::Adaptive(Box::new(adaptive)),
        })
    }

    /// Returns whether the method chooses its steps.
    pub fn is_adaptive(&self) -> bool {
        matches!(self, Self::Adaptive(_))
    }

    /// Returns the step (s): the fixed one, or the last one under a tolerance, if there was one
    /// yet.
    pub fn step_size(&self, control: Control) -> Option<f64> {
        match self {
            Self::Fixed(_) => control.step(),
            Self::Adaptive(adaptive) => Some(adaptive.last().h).filter(|h| *h > 0.0),
        }
    }

    /// Advances y from t (s) by one step: of the fixed length, or of the length that the method
    /// chooses, at most `longest` (s).
    ///
    /// # Errors
    /// The step failed.
    pub fn integrate(
        &mut self,
        system: &dyn ParticleSystem,
        control: Control,
        t: f64,
        longest: f64,
        y: &mut [f64],
    ) -> Result<Taken, Error> {
        match self {
            Self::Adaptive(adaptive) => adaptive.advance(system, t, longest, y),
            Self::Fixed(integrator) => {
                let h = control.value();
                let work = integrator.step(system, t, h, y)?;
                Ok(Taken { t, h, work })
            }
        }
    }

    /// Writes the state at `since` (s) after the beginning of the last step, at y0 at time t (s),
    /// to `out`: by an adaptive method's polynomial, or by a shorter fixed step. Where that fails,
    /// `out` is NaN. Returns the work.
    pub fn state_at(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        since: f64,
        y0: &[f64],
        out: &mut [f64],
    ) -> Work {
        match self {
            Self::Adaptive(adaptive) => adaptive.interpolate(system, t + since, out),
            Self::Fixed(integrator) => {
                out.copy_from_slice(y0);
                integrator.step(system, t, since, out).unwrap_or_else(|_| {
                    out.fill(f64::NAN);
                    Work::default()
                })
            }
        }
    }

    /// Forgets the last step, because the state or the system has changed since.
    pub fn forget(&mut self) {
        if let Self::Adaptive(adaptive) = self {
            adaptive.restart();
        }
    }

    /// Recreates the integrator for a system that has changed: it sizes its scratch and its cost
    /// model by the system.
    pub fn refit(&mut self, method: &Method, system: &dyn ParticleSystem) {
        // The method supported this system before.
        if let Self::Fixed(integrator) = self
            && let Ok(other) = method.integrator(system)
        {
            *integrator = other;
        }
    }

    /// Returns the memory of an adaptive method: all of it or, without `whole`, only what a new
    /// step needs.
    pub fn memory(&self, whole: bool) -> Option<AdaptiveState> {
        match self {
            Self::Fixed(_) => None,
            Self::Adaptive(adaptive) => Some(adaptive.state(whole)),
        }
    }

    /// Continues with a saved memory.
    ///
    /// # Errors
    /// It is of another method.
    pub fn resume(&mut self, memory: Option<&AdaptiveState>) -> Result<(), Error> {
        match (self, memory) {
            (Self::Adaptive(adaptive), Some(memory)) => adaptive.resume(memory),
            _ => Ok(()),
        }
    }
}
