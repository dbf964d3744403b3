//! Errors as Python exceptions, with the words of the program.

use a3_core::{BlowUp, Cause, Error};
use a3_files::failure::Failure;
use pyo3::exceptions::PyKeyboardInterrupt;
use pyo3::prelude::*;
use pyo3::types::PyType;

/// Creates an exception of a class of `a3_simulator._errors`.
fn exception<A: pyo3::PyErrArguments + Send + Sync + 'static>(
    py: Python<'_>,
    class: &str,
    args: A,
) -> PyErr {
    let found = py.import("a3_simulator._errors").and_then(|errors| {
        let class = errors.getattr(class)?;
        Ok(class.cast_into::<PyType>()?)
    });
    match found {
        Ok(class) => PyErr::from_type(class, args),
        Err(error) => error,
    }
}

/// Creates the exception for a request that cannot be met.
pub fn wrong(py: Python<'_>, why: impl Into<String>) -> PyErr {
    exception(py, "InputError", (why.into(),))
}

/// Creates the exception for a failure of the program.
pub fn of_failure(py: Python<'_>, failure: &Failure) -> PyErr {
    let why = failure.to_string();
    match failure {
        Failure::Usage(_) | Failure::Input(_) => wrong(py, why),
        Failure::Run(_) => exception(py, "Error", (why,)),
        Failure::Interrupted(_) => PyKeyboardInterrupt::new_err(why),
    }
}

/// Returns what was made, or raises the exception of a failure.
pub fn told<T>(py: Python<'_>, made: Result<T, Failure>) -> PyResult<T> {
    made.map_err(|failure| of_failure(py, &failure))
}

/// Creates the exception for an error of a run. `message` has its words, and perhaps advice.
pub fn of_error(py: Python<'_>, error: &Error, message: String) -> PyErr {
    match error {
        Error::BlowUp(blow_up) => {
            let BlowUp { step, time, .. } = *blow_up;
            exception(py, "BlowUp", (message, step, time, particle(blow_up)))
        }
        Error::Invalid(_) | Error::Unsupported { .. } | Error::Dimension { .. } => {
            wrong(py, message)
        }
        _ => exception(py, "Error", (message,)),
    }
}

/// Returns the particle at which a run blew up, if it is known.
fn particle(blow_up: &BlowUp) -> Option<usize> {
    match blow_up.cause {
        Cause::Away { particle, .. }
        | Cause::Gained { particle, .. }
        | Cause::NotFinite { particle } => Some(particle),
        _ => None,
    }
}
