//! Checks of single numbers, in the words of those that the core makes.

use a3_core::Error;

/// `Ok` if `value` is finite and at least `low`, else an error that names it.
pub(crate) fn at_least(low: f64, what: &str, value: f64) -> Result<(), Error> {
    if value.is_finite() && value >= low {
        Ok(())
    } else {
        Err(Error::Invalid(format!(
            "{what} must be a finite number of at least {low}, not {value}"
        )))
    }
}

/// `Ok` if `value` is finite and above zero, else an error that names it.
pub(crate) fn positive(what: &str, value: f64) -> Result<(), Error> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(Error::Invalid(format!(
            "{what} must be a finite number above 0, not {value}"
        )))
    }
}
