//! Functions that may fail, and the failure of one, kept until it is asked for.

use std::fmt::Display;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::error::Error;

/// What a function of an own system returns: nothing or, if it can fail, a result, whose error ends
/// a run as an [`Error::Callback`] of the same text.
pub trait Outcome {
    /// Returns the text of the error, if the function failed.
    ///
    /// # Errors
    /// The function failed.
    fn outcome(self) -> Result<(), String>;
}

impl Outcome for () {
    fn outcome(self) -> Result<(), String> {
        Ok(())
    }
}

impl<E: Display> Outcome for Result<(), E> {
    fn outcome(self) -> Result<(), String> {
        self.map_err(|why| why.to_string())
    }
}

/// Returns whether a run or a step succeeded. A failure of a [callback](Error::Callback) stays an
/// error: it says nothing about the method or its step.
pub(crate) fn succeeded<T>(done: Result<T, Error>) -> Result<bool, Error> {
    match done {
        Err(error @ Error::Callback(_)) => Err(error),
        done => Ok(done.is_ok()),
    }
}

/// Failure of an evaluation, if there was one since it was last taken.
#[derive(Default)]
pub(crate) struct Failure {
    /// Whether there is one, which is all that evaluations ask for.
    is_there: AtomicBool,
    error: Mutex<Option<Error>>,
}

impl Failure {
    /// Evaluates a function that writes to `out`. If it fails, keeps the first error and fills
    /// `out` with NaN; until the error is taken, the function is not called again.
    pub fn guard(&self, out: &mut [f64], evaluate: impl FnOnce(&mut [f64]) -> Result<(), String>) {
        if !self.is_there.load(Ordering::Acquire) {
            let Err(why) = evaluate(out) else {
                return;
            };
            let mut error = self.error.lock().unwrap_or_else(PoisonError::into_inner);
            error.get_or_insert_with(|| Error::Callback(why));
            self.is_there.store(true, Ordering::Release);
        }
        out.fill(f64::NAN);
    }

    /// Takes the error.
    pub fn take(&self) -> Option<Error> {
        if !self.is_there.load(Ordering::Acquire) {
            return None;
        }
        let mut error = self.error.lock().unwrap_or_else(PoisonError::into_inner);
        self.is_there.store(false, Ordering::Release);
        error.take()
    }
}
