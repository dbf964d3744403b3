//! Checks of the numbers in a description. The core's errors have the same words.

use std::fmt::Display;

use crate::fault::Fault;

/// Largest magnitude of a number of a scene, whatever its unit: its square fits into single
/// precision.
const LARGEST: f64 = 1e9;

/// What is said of a number that is larger.
pub(crate) const BOUNDS: &str = "it must be a number from -1e9 to 1e9";

/// Whether a number is finite and of a reasonable size.
pub(crate) fn within(x: f64) -> bool {
    x.abs() <= LARGEST
}

/// What is said of a number that is not.
pub(crate) fn beyond(x: f64) -> String {
    format!("{BOUNDS}, not {x:e}")
}

/// The result, its error as a fault of that key.
pub(crate) fn at<T>(key: &str, result: Result<T, impl Display>) -> Result<T, Fault> {
    result.map_err(|why| Fault::new(key, why))
}

/// `Ok` if `value` is finite and at least `low`, else what is wrong with `what`.
pub(crate) fn at_least(low: f64, what: &str, value: f64) -> Result<(), String> {
    if value.is_finite() && value >= low {
        Ok(())
    } else {
        Err(format!(
            "{what} must be a finite number of at least {low}, not {value}"
        ))
    }
}

/// `Ok` if `value` is from 0 to 1, else what is wrong with `what`.
pub(crate) fn share(what: &str, value: f64) -> Result<(), String> {
    if (0.0..=1.0).contains(&value) {
        Ok(())
    } else {
        Err(format!("{what} must be a number from 0 to 1, not {value}"))
    }
}

/// `Ok` if `value` is finite and above 0, else what is wrong with `what`.
pub(crate) fn positive(what: &str, value: f64) -> Result<(), String> {
    if value.is_finite() && value > 0.0 {
        Ok(())
    } else {
        Err(format!(
            "{what} must be a finite number above 0, not {value}"
        ))
    }
}

/// The number of exactly one of two keys, and whether it is that of the first.
pub(crate) fn one_of(
    (a, first): (&str, Option<f64>),
    (b, second): (&str, Option<f64>),
) -> Result<(bool, f64), Fault> {
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

/// The key of one of several parts of a kind, which goes without a number if it is the only one.
pub(crate) fn key_of(kind: &str, k: usize, count: usize) -> String {
    if count == 1 {
        kind.into()
    } else {
        format!("{kind}.{k}")
    }
}
