//! Checks of the numbers in a description, in the words of the core's errors.

use std::fmt::Display;

use crate::fault::Fault;

/// Largest magnitude of a number of a scene, in any unit: its square fits into single precision.
const MAX_NUMBER: f64 = 1e13;

/// Largest magnitude of a coordinate (m).
const MAX_COORDINATE: f64 = 1e9;

/// Message for a place with a coordinate beyond the bounds.
pub(crate) const COORDINATES: &str = "each coordinate must be a number from -1e9 to 1e9";

/// Returns whether a number of a scene is within the bounds, and not NaN.
pub(crate) fn within(x: f64) -> bool {
    x.abs() <= MAX_NUMBER
}

/// Returns whether a coordinate is within the bounds, and not NaN.
pub(crate) fn is_coordinate(x: f64) -> bool {
    x.abs() <= MAX_COORDINATE
}

/// Returns the message for a number of a scene that is not within the bounds.
pub(crate) fn beyond(x: f64) -> String {
    format!("it must be a number from -1e13 to 1e13, not {x:e}")
}

/// Turns the error of a result into a fault of a key.
pub(crate) fn at<T>(key: &str, result: Result<T, impl Display>) -> Result<T, Fault> {
    result.map_err(|why| Fault::new(key, why))
}

/// Checks that `value` is finite and at least `low`. The error calls it `what`.
pub(crate) fn at_least(low: f64, what: &str, value: f64) -> Result<(), String> {
    if value.is_finite() && value >= low {
        Ok(())
    } else {
        Err(format!(
            "{what} must be a finite number of at least {low}, not {value}"
        ))
    }
}

/// Checks that `value` is from 0 to 1. The error calls it `what`.
pub(crate) fn share(what: &str, value: f64) -> Result<(), String> {
    if (0.0..=1.0).contains(&value) {
        Ok(())
    } else {
        Err(format!("{what} must be a number from 0 to 1, not {value}"))
    }
}

/// Checks that `value` is finite and above 0. The error calls it `what`.
pub(crate) fn positive(what: &str, value: f64) -> Result<(), String> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(format!(
            "{what} must be a finite number above 0, not {value}"
        ))
    }
}

/// Returns the value of the one key of two that is given, and whether that is the first.
pub(crate) fn one_of<T>(
    (a, first): (&str, Option<T>),
    (b, second): (&str, Option<T>),
) -> Result<(bool, T), Fault> {
    match (first, second) {
        (Some(x), None) => Ok((true, x)),
        (None, Some(x)) => Ok((false, x)),
        (Some(_), Some(_)) => Err(Fault::not_both(a, b)),
        (None, None) => Err(Fault::new(
            "",
            format!("one of the keys `{a}` and `{b}` is needed"),
        )),
    }
}

/// Returns the same as `one_of`. The number must be finite and above 0.
pub(crate) fn positive_one(
    (a, first): (&str, Option<f64>),
    (b, second): (&str, Option<f64>),
) -> Result<(bool, f64), Fault> {
    let (is_first, number) = one_of((a, first), (b, second))?;
    at(if is_first { a } else { b }, positive("it", number)).map(|()| (is_first, number))
}

/// Returns the key of part k of a kind. The only part of a kind has no number.
pub(crate) fn key_of(kind: &str, k: usize, count: usize) -> String {
    if count == 1 {
        kind.into()
    } else {
        format!("{kind}.{k}")
    }
}
