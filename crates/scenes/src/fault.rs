//! Faults in the text of a scene, with their places.

use std::fmt;

use crate::text::line;
use crate::wording::{brief, of_json, of_toml};

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
        Self {
            line: None,
            key: key.into(),
            why: why.to_string(),
        }
    }

    /// Creates the fault of the second of two keys of which only one may be given.
    pub(crate) fn not_both(a: &str, b: &str) -> Self {
        Self::new(b, format!("give either `{a}` or `{b}`, not both"))
    }

    /// Creates the fault of a number i that none of the `particles` has.
    pub(crate) fn no_particle(key: &str, i: usize, particles: usize) -> Self {
        let last = particles - 1;
        Self::new(
            key,
            format!("there is no particle {i}: they are numbered 0 to {last}"),
        )
    }

    /// Prefixes the key with that of the part of the description that it is in.
    pub(crate) fn within(self, key: &str) -> Self {
        Self {
            key: join(key, &self.key),
            ..self
        }
    }

    /// Sets the line, unless it is known.
    pub(crate) fn at(self, line: impl FnOnce() -> usize) -> Self {
        Self {
            line: self.line.or_else(|| Some(line())),
            ..self
        }
    }

    /// Creates the fault of a text that is no TOML.
    pub(crate) fn of_toml(text: &str, error: &toml::de::Error) -> Self {
        let at = error.span().map(|span| span.start);
        let rest = at.and_then(|at| text.get(at..)).unwrap_or_default();
        Self {
            line: at.map(|at| line(text, at)),
            ..Self::new("", of_toml(error.message(), rest))
        }
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
