//! The stepper of a run: an integrator that takes fixed steps, or an adaptive method that looks
//! ahead.

use serde::{Deserialize, Serialize};

use crate::control::Control;
use crate::error::Error;
use crate::integrators::{Adaptive, AdaptiveState, Integrator, Method, Tolerance};
use crate::system::ParticleSystem;

/// Taker of the steps.
pub(super) enum Stepper {
    /// Steps of a fixed size.
    Fixed(Box<dyn Integrator>),
    /// Steps of its own choice, whose ends are no times that anyone asked for: the run looks ahead,
    /// and the state shown is on the way to `end`.
    Adaptive {
        adaptive: Box<Adaptive>,
        /// State at the end of the last step.
        end: Vec<f64>,
        /// Time of that end (s), if state and system are still those that the step began with.
        until: Option<f64>,
    },
}

/// Progress of an adaptive method within a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// Memory of the method.
    pub method: AdaptiveState,
    /// End of the step that the run is within: its time (s), and the state there.
    pub ahead: Option<(f64, Vec<f64>)>,
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
        method.check(system)?;
        method.check_control(control)?;
        method.check(system)?;
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

    /// What an adaptive method remembers, and with `ahead` also the step that the run is within.
    pub fn progress(&self, ahead: bool) -> Option<Progress> {
        match self {
            Self::Fixed(_) => None,
            Self::Adaptive {
                adaptive,
                end,
                until,
            } => {
                let until = until.filter(|_| ahead);
                Some(Progress {
                    method: adaptive.state(until.is_some()),
                    ahead: until.map(|until| (until, end.clone())),
                })
            }
        }
    }

    /// Goes on from what was remembered.
    ///
    /// # Errors
    /// It is of another method or of another system.
    pub fn resume(&mut self, progress: &Progress) -> Result<(), Error> {
        let Self::Adaptive {
            adaptive,
            end,
            until,
        } = self
        else {
            return Ok(());
        };
        adaptive.resume(&progress.method)?;
        if let Some((time, state)) = &progress.ahead {
            if state.len() != end.len() {
                return Err(Error::Dimension {
                    expected: end.len(),
                    found: state.len(),
                });
            }
            end.copy_from_slice(state);
            *until = Some(*time);
        }
        Ok(())
    }
}
