//! The stepper of a run: an integrator that takes fixed steps, or an adaptive method that looks ahead.

use super::Checkpoint;
use crate::control::Control;
use crate::error::Error;
use crate::integrators::{Adaptive, Integrator, Method, Tolerance};
use crate::system::ParticleSystem;

/// Taker of the steps.
pub(super) enum Stepper {
    /// Steps of a fixed size.
    Fixed(Box<dyn Integrator>),
    /// Steps of its own choice, whose ends are no times that anyone asked for: the run looks ahead, and the state shown
    /// is on the way to `end`.
    Adaptive {
        adaptive: Box<Adaptive>,
        /// State at the end of the last step.
        end: Vec<f64>,
        /// Time of that end (s), if state and system are still those that the step began with.
        until: Option<f64>,
    },
}

impl Stepper {
    /// The stepper of a method.
    ///
    /// # Errors
    /// The method does not serve the system, or does not take that control.
    pub fn new(
        method: &Method,
        system: &dyn ParticleSystem,
        control: Control,
    ) -> Result<Self, Error> {
        method.check_control(control)?;
        let adaptive = match control {
            Control::Step(_) => None,
            Control::Tolerance(relative) => method.adaptive(system, Tolerance::new(relative)?),
        };
        Ok(match adaptive {
            None => Self::Fixed(method.integrator(system)?),
            Some(adaptive) => Self::Adaptive {
                adaptive: Box::new(adaptive),
                end: vec![0.0; system.dim()],
                until: None,
            },
        })
    }

    /// Writes down what an adaptive method remembers, and with `ahead` also the step that it is within.
    pub fn record(&self, ahead: bool, checkpoint: &mut Checkpoint) {
        (checkpoint.adaptive, checkpoint.ahead) = (None, None);
        if let Self::Adaptive {
            adaptive,
            end,
            until,
        } = self
        {
            let until = until.filter(|_| ahead);
            checkpoint.adaptive = Some(adaptive.state(until.is_some()));
            checkpoint.ahead = until.map(|until| (until, end.clone()));
        }
    }

    /// Goes on from what was written down.
    ///
    /// # Errors
    /// It is of another method or of another system.
    pub fn resume(&mut self, checkpoint: &Checkpoint) -> Result<(), Error> {
        if let Self::Adaptive {
            adaptive,
            end,
            until,
        } = self
            && let Some(state) = &checkpoint.adaptive
        {
            adaptive.resume(state)?;
            if let Some((time, state)) = &checkpoint.ahead {
                if state.len() != end.len() {
                    return Err(Error::Dimension {
                        expected: end.len(),
                        found: state.len(),
                    });
                }
                end.copy_from_slice(state);
                *until = Some(*time);
            }
        }
        Ok(())
    }
}
