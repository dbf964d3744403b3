//! Faults in the text of a scene, and where they are.

use std::fmt;

use toml::de::{DeTable, DeValue};

use crate::wording::{brief, of_serde, of_toml};

/// Most characters of a key or a reason.
const LONGEST: usize = 1000;
/// What is said of a list of fixed length that goes on.
const TOO_LONG: &str = "the list has too many numbers; write decimal points, as in 0.5";

/// Fault in a description, with its place in the text.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// Line of the text, counted from 1, once it is known.
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
            write!(f, "{}: ", brief(&self.key, LONGEST))?;
        }
        f.write_str(&brief(&self.why, LONGEST))
    }
}

impl std::error::Error for Fault {}

impl From<Fault> for a3_core::Error {
    fn from(fault: Fault) -> Self {
        Self::Invalid(fault.to_string())
    }
}

impl Fault {
    /// Fault of that key, whose line is not yet known.
    pub(crate) fn new(key: impl Into<String>, why: impl fmt::Display) -> Self {
        Self {
            line: None,
            key: key.into(),
            why: why.to_string(),
        }
    }

    /// Fault of one of two keys of which only one may be given.
    pub(crate) fn not_both(a: &str, b: &str) -> Self {
        Self::new(b, format!("give either `{a}` or `{b}`, not both"))
    }

    /// Fault of a number that no particle has, among this many.
    pub(crate) fn no_particle(key: &str, i: usize, particles: usize) -> Self {
        let last = particles - 1;
        Self::new(
            key,
            format!("there is no particle {i}: they are numbered 0 to {last}"),
        )
    }

    /// The fault with its key inside that of a part of the description.
    pub(crate) fn within(self, key: &str) -> Self {
        Self {
            key: join(Some(key.into()), self.key),
            ..self
        }
    }

    /// The fault with the line of its key in that text.
    #[must_use]
    pub fn locate(self, text: &str) -> Self {
        if text.trim_start().starts_with('{') {
            return self.in_json(text);
        }
        let offset = || {
            // The text as a whole has no line, and may be too long to be read.
            if self.key.is_empty() {
                return None;
            }
            let table = DeTable::parse(text).ok()?;
            offset_of(table.get_ref(), &self.key)
        };
        Self {
            line: self.line.or_else(|| Some(line(text, offset()?))),
            ..self
        }
    }

    /// The fault with the key and the line that it has in JSON, where there are single particles
    /// alone.
    fn in_json(self, text: &str) -> Self {
        let key = match self.key.strip_prefix("particles.") {
            Some("masses") => "mass",
            Some("pin" | "pin.particles") => "pinned",
            Some(key) => key,
            None => &self.key,
        };
        let at = || text.find(&format!("\"{key}\"")).filter(|_| !key.is_empty());
        Self {
            line: self.line.or_else(|| Some(line(text, at()?))),
            key: key.into(),
            why: self.why,
        }
    }

    /// Fault of a text that is no TOML.
    pub(crate) fn of_toml(text: &str, error: &toml::de::Error) -> Self {
        let at = error.span().map(|span| span.start);
        let rest = at.and_then(|at| text.get(at..)).unwrap_or_default();
        Self {
            line: at.map(|at| line(text, at)),
            ..Self::new("", of_toml(error.message(), rest))
        }
    }

    /// Fault that the JSON reader found in a table of lists.
    pub(crate) fn of_json(text: &str, error: &serde_json::Error) -> Self {
        let why = error.to_string();
        // The reader ends with the place.
        let why = why.split(" at line ").next().unwrap_or_default();
        let mut lines = text.split_inclusive('\n');
        let before: usize = lines
            .by_ref()
            .take(error.line().saturating_sub(1))
            .map(str::len)
            .sum();
        let head = text.get(..before + error.column()).unwrap_or_default();
        let is_in_list = head.matches('[').count() > head.matches(']').count();
        let (key, why) = match why {
            "trailing characters" if is_in_list => (last_key(head), TOO_LONG.into()),
            _ if why.starts_with("invalid ") && error.is_data() => (last_key(head), of_serde(why)),
            _ => (None, of_serde(why)),
        };
        Self {
            line: Some(error.line()),
            ..Self::new(key.unwrap_or_default(), why)
        }
    }
}

/// The last key of a text in JSON: a text in quotes before a colon.
fn last_key(text: &str) -> Option<&str> {
    text.rmatch_indices(':').find_map(|(colon, _)| {
        let key = text[..colon].trim_end().strip_suffix('"')?;
        Some(&key[key.rfind('"')? + 1..])
    })
}

/// Line of a byte, counted from 1.
pub(crate) fn line(text: &str, at: usize) -> usize {
    1 + text.bytes().take(at).filter(|b| *b == b'\n').count()
}

/// Byte at which the value of a key begins, or that of the longest part of the key that is there.
fn offset_of(table: &DeTable, key: &str) -> Option<usize> {
    let mut parts = key.split('.');
    let first = parts.next()?;
    let (name, value) = table.get_key_value(first)?;
    let mut at = name.span().start;
    let mut value = value.get_ref();
    for part in parts {
        let next = match value {
            DeValue::Table(table) => table.get_key_value(part).map(|(name, v)| (name.span(), v)),
            DeValue::Array(array) => match part.parse::<usize>() {
                Ok(i) => array.get(i).map(|v| (v.span(), v)),
                // The only element goes without a number.
                Err(_) => array
                    .first()
                    .and_then(|v| v.get_ref().as_table()?.get_key_value(part))
                    .map(|(name, v)| (name.span(), v)),
            },
            _ => None,
        };
        let Some((span, v)) = next else { break };
        (at, value) = (span.start, v.get_ref());
    }
    Some(at)
}

fn join(first: Option<String>, rest: String) -> String {
    match first {
        None => rest,
        Some(first) if rest.is_empty() => first,
        Some(first) => format!("{first}.{rest}"),
    }
}
