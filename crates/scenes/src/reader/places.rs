//! Places of the keys of a text, which tell the line of a fault that is found after reading.

use std::collections::BTreeMap;
use std::iter;

use super::value::{Found, Value};
use crate::fault::{Fault, join};

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
    pub(super) fn of(whole: &Value, levels: usize) -> Result<Self, Fault> {
        let ends = whole.text.bytes().enumerate().filter(|(_, b)| *b == b'\n');
        let mut walk = Walk {
            ends: ends.map(|(at, _)| at).collect(),
            lines: BTreeMap::new(),
        };
        walk.add("", whole, levels)?;
        Ok(Self {
            lines: walk.lines,
            names: &[],
        })
    }

    /// Sets the prefixes of keys of the description, and those that the text has in their place.
    pub(crate) fn named(self, names: &'static [(&'static str, &'static str)]) -> Self {
        Self { names, ..self }
    }

    /// Forgets the lines, for a text that was generated and that the user has not seen.
    #[must_use]
    pub fn without_lines(self) -> Self {
        Self {
            lines: BTreeMap::new(),
            ..self
        }
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
        let line = fault
            .line
            .or_else(|| parts.find_map(|part| self.lines.get(part).copied()));
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
