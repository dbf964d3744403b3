//! Failures of steps.

use super::bounds::not_finite;
use crate::error::{Cause, Error};
use crate::refusal::Refusal;
use crate::scene::Model;

/// Reason why a run cannot continue.
pub(super) enum Failure {
    /// Blow-up by a cause, at a time (s).
    BlowUp { cause: Cause, time: f64 },
    /// Error that is no blow-up.
    Error(Error),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Error(error)
    }
}

/// Returns the cause of a model's blow-up, if a failed step with this error is one; otherwise the
/// error.
pub(super) fn cause_of(error: Error, model: &Model) -> Result<Cause, Error> {
    match error {
        Error::NotFinite { component, .. } => Ok(not_finite(model, component)),
        Error::StepTooSmall { step, .. } => Ok(Cause::StepTooSmall { step }),
        Error::NoConvergence { residual } => Ok(Cause::NoConvergence { residual }),
        Error::Unsupported {
            why: Refusal::ReadsVelocity,
            ..
        } => Ok(Cause::ReadsVelocity),
        error => Err(error),
    }
}
