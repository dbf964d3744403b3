//! Reader of TOML and JSON, which deserialises values of the expected kinds and lengths. Its faults
//! have keys and lines.

mod deserializer;
mod value;

use std::collections::BTreeMap;
use std::iter;

use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

use crate::fault::{Fault, join};
use value::{Found, Value};

/// Reads a text in TOML. Each number that is not a whole one must be within the bounds of a scene.
///
/// # Errors
/// The text is not TOML, or a key or a value is wrong: with its line, and with what would be right.
pub fn read<T: DeserializeOwned>(text: &str) -> Result<T, Fault> {
    let table = table_of(text)?;
    T::deserialize(Value::of_toml(text, &table))
}

/// Reads a text in TOML as [`read`] does, with the places of its keys.
pub(crate) fn read_toml<T: DeserializeOwned>(text: &str) -> Result<(T, Places), Fault> {
    let table = table_of(text)?;
    with_places(&Value::of_toml(text, &table), usize::MAX)
}

/// Reads a text in JSON as [`read`] does, with the places of the keys of its top level. Values that
/// are ignored may have any depth.
pub(crate) fn read_json<T: DeserializeOwned>(text: &str) -> Result<(T, Places), Fault> {
    with_places(&Value::of_json(text, text), 1)
}

fn table_of(text: &str) -> Result<DeValue<'_>, Fault> {
    let table = DeTable::parse(text).map_err(|error| Fault::of_toml(text, &error))?;
    Ok(DeValue::Table(table.into_inner()))
}

/// Reads a value, and then the places of its keys down to a level: only keys that are known are
/// short enough to be kept.
fn with_places<T: DeserializeOwned>(value: &Value, levels: usize) -> Result<(T, Places), Fault> {
    let read = T::deserialize(value.clone())?;
    let places = Places::of(value, levels)?;
    Ok((read, places))
}

/// Lines of the keys in the text of a description.
#[derive(Clone, Debug, Default)]
pub struct Places {
    /// Line of each key, counted from 1. Keys are written as in faults, such as `cloth.1.spacing`.
    lines: BTreeMap<String, usize>,
    /// Prefixes of keys of the description, and those that the text has in their place.
    names: &'static [(&'static str, &'static str)],
}

impl Places {
    /// Collects the places of the keys of a table, and of the tables in it down to a level.
    fn of(whole: &Value, levels: usize) -> Result<Self, Fault> {
        let ends = whole.text.bytes().enumerate().filter(|(_, b)| *b == b'\n');
        let mut walk = Walk { ends: ends.map(|(at, _)| at).collect(), lines: BTreeMap::new() };
        walk.add("", whole, levels)?;
        Ok(Self { lines: walk.lines, names: &[] })
    }

    /// Sets the prefixes of keys of the description, and those that the text has in their place.
    pub(crate) fn named(self, names: &'static [(&'static str, &'static str)]) -> Self {
        Self { names, ..self }
    }

    /// Forgets the lines, for a text that was generated and that the user has not seen.
    #[must_use]
    pub fn without_lines(self) -> Self {
        Self { lines: BTreeMap::new(), ..self }
    }

    /// Adds the line to a fault, and rewrites its key as in the text. The line is that of the
    /// longest prefix of the key that the text has.
    #[must_use]
    pub fn locate(&self, fault: Fault) -> Fault {
        let mut names = self.names.iter();
        let name = names.find_map(|(ours, theirs)| {
            let rest = fault.key.strip_prefix(ours)?;
            Some(format!("{theirs}{rest}"))
        });
        let key = name.unwrap_or_else(|| fault.key.clone());
        let mut parts = iter::successors(Some(key.as_str()), |part| {
            part.rsplit_once('.').map(|(part, _)| part)
        });
        let mut line_of_part = || parts.find_map(|part| self.lines.get(part).copied());
        let line = fault.line.or_else(&mut line_of_part);
        Fault { line, key, ..fault }
    }
}

/// Walk through all tables.
struct Walk {
    /// Bytes at which lines end.
    ends: Vec<usize>,
    lines: BTreeMap<String, usize>,
}

impl Walk {
    fn insert(&mut self, key: String, at: usize) {
        let line = 1 + self.ends.partition_point(|end| *end < at);
        self.lines.insert(key, line);
    }

    /// Adds the keys in a value, which has the key `key` itself, down to a level. Numbers in lists
    /// have no keys.
    fn add(&mut self, key: &str, value: &Value, levels: usize) -> Result<(), Fault> {
        if levels == 0 {
            return Ok(());
        }
        match value.found()? {
            Found::Table(entries) => {
                for entry in entries {
                    let key = join(key, &entry.key);
                    self.add(&key, &entry.value, levels - 1)?;
                    self.insert(key, entry.at);
                }
            }
            Found::List(items) => {
                let count = items.len();
                for (k, item) in items.enumerate() {
                    if !item.is_table() {
                        break;
                    }
                    if count == 1 {
                        self.add(key, &item, levels)?;
                    } else {
                        let key = join(key, &k.to_string());
                        self.add(&key, &item, levels)?;
                        self.insert(key, item.at());
                    }
                }
            }
            _ => {}
        }
        Ok(())
    }
}
