//! Failures of steps.

use crate::error::{Cause, Error, Refusal};

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

/// The cause of a blow-up of n particles, if that is why a step failed; any other error is
/// returned.
pub(super) fn cause_of(error: Error, n: usize) -> Result<Cause, Error> {
    match error {
        Error::NotFinite { component, .. } => Ok(Cause::NotFinite {
            particle: component % n,
        }),
        Error::StepTooSmall { step, .. } => Ok(Cause::StepTooSmall { step }),
        Error::NoConvergence { residual } => Ok(Cause::NoConvergence { residual }),
        Error::Unsupported {
            why: Refusal::ReadsVelocity,
            ..
        } => Ok(Cause::ReadsVelocity),
        error => Err(error),
    }
}
