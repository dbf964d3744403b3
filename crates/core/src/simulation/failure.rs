//! Failures of steps.

use super::bounds::not_finite;
use crate::error::{Cause, Error, Refusal};
use crate::scene::Model;

/// Reason for which a run does not go on.
pub(super) enum Failure {
    /// It is lost, by that time (s).
    Lost { cause: Cause, time: f64 },
    /// An error that is not of the run.
    Error(Error),
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self::Error(error)
    }
}

/// The cause of a blow-up of a model by a step that failed; other errors are handed on.
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
