//! Steps a run: at a fixed step, or adaptively. A time shown may be within a step, whose state is
//! then read off the step's polynomial: how often a run is looked at changes nothing.

use serde::{Deserialize, Serialize};

use super::within::{Span, Within};
use crate::control::Control;
use crate::error::Error;
use crate::integrators::{Adaptive, AdaptiveState, Integrator, Method, Taken, Work};
use crate::scene::Scene;
use crate::system::ParticleSystem;

/// Integrator of a run, and the step that the time shown is within.
pub(super) struct Stepper {
    pub kind: Kind,
    pub within: Within,
}

/// Kind of steps.
pub(super) enum Kind {
    /// Steps of a fixed length.
    Fixed(Box<dyn Integrator>),
    /// Steps whose length the method chooses.
    Adaptive(Box<Adaptive>),
}

/// Progress of a run within a step, and what an adaptive method remembers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// Memory of an adaptive method.
    pub method: Option<AdaptiveState>,
    /// Step that the time shown is within.
    pub within: Option<Span>,
}

impl Stepper {
    /// Stepper of a method for a scene, whose system is as it is now.
    ///
    /// # Errors
    /// The method does not serve the system, or does not take that control.
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
        // The integrator is made in any case: it checks that the method serves the system.
        let integrator = method.integrator(system)?;
        Ok(Self {
            kind: match adaptive {
                None => Kind::Fixed(integrator),
                Some(adaptive) => Kind::Adaptive(Box::new(adaptive)),
            },
            within: Within::default(),
        })
    }

    /// Whether the method chooses its steps.
    pub fn is_adaptive(&self) -> bool {
        matches!(self.kind, Kind::Adaptive(_))
    }

    /// Takes y from t (s) to the end of a step: of the fixed length, or of the method's choice and
    /// at most `longest` (s).
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
        match &mut self.kind {
            Kind::Adaptive(adaptive) => adaptive.advance(system, t, longest, y),
            Kind::Fixed(integrator) => {
                let h = control.value();
                let work = integrator.step(system, t, h, y)?;
                Ok(Taken { t, h, work })
            }
        }
    }

    /// Writes the state at `since` (s) after the beginning of the last step, at y0 at time t (s),
    /// to `out`: off an adaptive method's polynomial, or by a shorter fixed step, and `out` is not
    /// a number where that fails. Returns the work.
    pub fn state_at(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        since: f64,
        y0: &[f64],
        out: &mut [f64],
    ) -> Work {
        match &mut self.kind {
            Kind::Adaptive(adaptive) => adaptive.interpolate(system, t + since, out),
            Kind::Fixed(integrator) => {
                out.copy_from_slice(y0);
                integrator.step(system, t, since, out).unwrap_or_else(|_| {
                    out.fill(f64::NAN);
                    Work::default()
                })
            }
        }
    }

    /// Forgets the last step: the state or the system is no longer the one that it ended with.
    pub fn forget(&mut self) {
        self.within.leave();
        if let Kind::Adaptive(adaptive) = &mut self.kind {
            adaptive.restart();
        }
    }

    /// Progress of the run or, without `whole`, only what a new step needs.
    pub fn progress(&self, whole: bool) -> Progress {
        let within = self.within.span().filter(|_| whole);
        Progress {
            method: match &self.kind {
                Kind::Fixed(_) => None,
                Kind::Adaptive(adaptive) => Some(adaptive.state(whole)),
            },
            within,
        }
    }

    /// Goes on from that progress.
    ///
    /// # Errors
    /// It is of another method or of another system.
    pub fn resume(&mut self, progress: &Progress, dim: usize) -> Result<(), Error> {
        if let (Kind::Adaptive(adaptive), Some(state)) = (&mut self.kind, &progress.method) {
            adaptive.resume(state)?;
        }
        self.within.resume(progress.within.as_ref(), dim)
    }
}
