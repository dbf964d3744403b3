//! Faults in the text of a scene, with their places, and checks of the numbers in a description, in
//! the words of the core's errors.

use std::fmt;
use std::fmt::Display;

use crate::text::line;
use crate::wording::{brief, of_json, of_toml};

/// Returns an error, if a condition holds or always: the fault of a key, or only a text. It has a
/// reason like that of `format!`.
macro_rules! refuse {
    (if $is_wrong:expr => $key:tt: $($why:tt)+) => {
        if $is_wrong {
            refuse!($key: $($why)+);
        }
    };
    (if $is_wrong:expr => $($why:tt)+) => {
        if $is_wrong {
            refuse!($($why)+);
        }
    };
    ($key:tt: $($why:tt)+) => {
        return Err($crate::fault::Fault::new($key, format_args!($($why)+)))
    };
    ($($why:tt)+) => {
        return Err(format_args!($($why)+).to_string())
    };
}

/// Largest number of characters of a key or a reason.
const MAX_CHARACTERS: usize = 1000;

/// Fault in a description, with its place in the text.
///
/// ```
/// let fault = a3_scenes::parse_toml("gravity = [0, 1]\n").err().unwrap();
/// assert_eq!((fault.line, &*fault.key), (Some(1), "gravity"));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Line of the text, counted from 1, if it is known.
    pub line: Option<usize>,
    /// Key, such as `cloth.spacing`, or `cloth.1.spacing` of the second of several cloths. It is
    /// empty for the description as a whole.
    pub key: String,
    /// Reason, and what would be right.
    pub why: String,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        if !self.key.is_empty() {
            write!(f, "{}: ", brief(&self.key, MAX_CHARACTERS))?;
        }
        f.write_str(&brief(&self.why, MAX_CHARACTERS))
    }
}

impl std::error::Error for Fault {}

impl From<Fault> for a3_core::Error {
    fn from(fault: Fault) -> Self {
        Self::Invalid(fault.to_string())
    }
}

impl Fault {
    /// Creates a fault of a key, whose line is not yet known.
    pub(crate) fn new(key: impl Into<String>, why: impl fmt::Display) -> Self {
        Self { line: None, key: key.into(), why: why.to_string() }
    }

    /// Creates the fault of the second of two keys of which only one may be given.
    pub(crate) fn not_both(a: &str, b: &str) -> Self {
        Self::new(b, format!("give either `{a}` or `{b}`, not both"))
    }

    /// Creates the fault of a number i that none of the `particles` has.
    pub(crate) fn no_particle(key: &str, i: usize, particles: usize) -> Self {
        let last = particles - 1;
        let why = format!("there is no particle {i}: they are numbered 0 to {last}");
        Self::new(key, why)
    }

    /// Prefixes the key with that of the part of the description that it is in.
    pub(crate) fn within(self, key: &str) -> Self {
        Self { key: join(key, &self.key), ..self }
    }

    /// Sets the line, unless it is known.
    pub(crate) fn at(self, line: impl FnOnce() -> usize) -> Self {
        Self { line: self.line.or_else(|| Some(line())), ..self }
    }

    /// Creates the fault of a text that is no TOML.
    pub(crate) fn of_toml(text: &str, error: &toml::de::Error) -> Self {
        let at = error.span().map(|span| span.start);
        let rest = at.and_then(|at| text.get(at..)).unwrap_or_default();
        Self { line: at.map(|at| line(text, at)), ..Self::new("", of_toml(error.message(), rest)) }
    }

    /// Creates the fault of a text that is no JSON and begins at this line.
    pub(crate) fn of_json(first: usize, error: &serde_json::Error) -> Self {
        let message = error.to_string();
        // The reader appends the place.
        let message = message.split(" at line ").next().unwrap_or_default();
        Self {
            line: Some(first + error.line().saturating_sub(1)),
            ..Self::new("", of_json(message))
        }
    }
}

/// Joins the key of a whole and that of a part of it.
pub(crate) fn join(whole: &str, part: &str) -> String {
    match (whole, part) {
        ("", key) | (key, "") => key.into(),
        _ => format!("{whole}.{part}"),
    }
}

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
    refuse!(if !(value.is_finite() && value >= low) =>
        "{what} must be a finite number of at least {low}, not {value}");
    Ok(())
}

/// Checks that `value` is from 0 to 1. The error calls it `what`.
pub(crate) fn share(what: &str, value: f64) -> Result<(), String> {
    refuse!(if !(0.0..=1.0).contains(&value) => "{what} must be a number from 0 to 1, not {value}");
    Ok(())
}

/// Checks that `value` is finite and above 0. The error calls it `what`.
pub(crate) fn positive(what: &str, value: f64) -> Result<(), String> {
    refuse!(if !(value.is_finite() && value > 0.0) =>
        "{what} must be a finite number above 0, not {value}");
    Ok(())
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
        (None, None) => refuse!("": "one of the keys `{a}` and `{b}` is needed"),
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
    match count {
        1 => kind.into(),
        _ => format!("{kind}.{k}"),
    }
}
