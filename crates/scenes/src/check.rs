//! Checks of the numbers in a description. The core's errors have the same words.

use std::fmt::Display;

use a3_core::Vector3;

use crate::description::Triple;
use crate::fault::Fault;

/// Largest number that is taken for a position, a velocity, an angle or a time (m, m/s, rad, s).
const LARGEST: f64 = 1e9;

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

/// The number of that key, if it is of a reasonable size.
pub(crate) fn number(key: &str, x: f64) -> Result<f64, Fault> {
    if x.abs() <= LARGEST {
        Ok(x)
    } else {
        let why = format!(
            "it must be a number from {:e} to {LARGEST:e}, not {x}",
            -LARGEST
        );
        Err(Fault::new(key, why))
    }
}

/// The vector of that key, if its components are of a reasonable size.
pub(crate) fn vector(key: &str, triple: Triple) -> Result<Vector3<f64>, Fault> {
    for x in triple {
        number(key, x)?;
    }
    Ok(triple.into())
}

/// The vector of that key, zero if it is not given.
pub(crate) fn vector_or_zero(key: &str, triple: Option<Triple>) -> Result<Vector3<f64>, Fault> {
    vector(key, triple.unwrap_or_default())
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
