//! Faults in the text of a scene, and where they are.

use std::borrow::Cow;
use std::fmt;

use toml::de::{DeTable, DeValue};

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
            write!(f, "{}: ", brief(&self.key))?;
        }
        f.write_str(&brief(&self.why))
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

    /// Fault that the TOML reader found.
    pub(crate) fn of_toml(text: &str, error: &toml::de::Error) -> Self {
        let at = error.span().map(|span| span.start);
        let key = at.and_then(|at| {
            let table = DeTable::parse(text).ok()?;
            key_at(table.get_ref(), at)
        });
        Self {
            line: at.map(|at| line(text, at)),
            key: key.unwrap_or_default(),
            why: explain(error.message()),
        }
    }
}

/// Line of a byte, counted from 1.
fn line(text: &str, at: usize) -> usize {
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

/// The key whose value or name is at that byte. The span of a table is only its header, so that its
/// contents are searched first.
fn key_at(table: &DeTable, at: usize) -> Option<String> {
    table.iter().find_map(|(name, value)| {
        let rest = match value.get_ref() {
            DeValue::Table(inner) => key_at(inner, at),
            DeValue::Array(items) => items.iter().enumerate().find_map(|(i, item)| {
                let rest = key_at(item.get_ref().as_table()?, at);
                let own = || item.span().contains(&at).then(String::new);
                let number = (items.len() > 1).then(|| i.to_string());
                Some(join(number, rest.or_else(own)?))
            }),
            _ => None,
        };
        let own = || (name.span().contains(&at) || value.span().contains(&at)).then(String::new);
        Some(join(Some(name.get_ref().to_string()), rest.or_else(own)?))
    })
}

fn join(first: Option<String>, rest: String) -> String {
    match first {
        None => rest,
        Some(first) if rest.is_empty() => first,
        Some(first) => format!("{first}.{rest}"),
    }
}

/// A message with at most a thousand characters: it may quote a whole file.
fn brief(message: &str) -> Cow<'_, str> {
    match message.char_indices().nth(1000) {
        Some((end, _)) => format!("{} ...", &message[..end]).into(),
        None => message.into(),
    }
}

/// The TOML reader's message, rephrased.
fn explain(message: &str) -> String {
    let message = message.lines().next().unwrap_or_default();
    let quoted: Vec<_> = message.split('`').skip(1).step_by(2).collect();
    if let (true, [unknown, known @ ..]) = (
        message.starts_with("unknown field") || message.starts_with("unknown variant"),
        &quoted[..],
    ) {
        let (what, all) = if message.starts_with("unknown field") {
            ("there is no key", "keys")
        } else {
            ("there is no", "choices")
        };
        // Two neighbouring letters in the wrong order count as one slip.
        let likeness = |name: &str| strsim::normalized_damerau_levenshtein(unknown, name);
        // No key is so long; the time that a comparison takes grows with the length.
        let near = known.iter().filter(|_| unknown.len() < 50);
        let nearest = near
            .map(|name| (likeness(name), *name))
            .filter(|(likeness, _)| *likeness > 0.55)
            .max_by(|a, b| a.0.total_cmp(&b.0));
        let known = known.join(", ");
        return match nearest {
            Some((_, name)) => {
                format!("{what} `{unknown}`; did you mean `{name}`? The {all} are {known}")
            }
            None => format!("{what} `{unknown}`; the {all} are {known}"),
        };
    }
    if let (true, [missing, ..]) = (message.starts_with("missing field"), &quoted[..]) {
        return format!("the key `{missing}` is missing");
    }
    message.to_owned()
}
