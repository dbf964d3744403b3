//! Random scenes from the schema of scene files, with all its tables and keys.

use std::collections::BTreeSet;

use a3_scenes::Description;
use serde_json::{Map, Value};

use crate::chance::Chance;
use crate::ranges::{ALTERNATIVES, COUNTS, NEEDS, NUMBERS, ODD, ONE, TOGETHER, WORDS};
use crate::sense;

/// Keys of a scene that refer to particles by number. They are added when the number of particles
/// is known.
#[rustfmt::skip]
pub const NUMBERED: [&str; 7] = ["springs", "constraint", "joint", "pin", "torn", "trail", "state"];

/// Tables of the bodies, and their keys in a scene.
#[rustfmt::skip]
pub const BODIES: [&str; 8] =
    ["cloth", "jelly", "mesh", "solid", "chain", "particles", "body", "fluid"];

/// The grammar of scene files.
pub struct Grammar {
    schema: Value,
}

impl Grammar {
    pub fn new() -> Self {
        let schema = serde_json::from_str(&Description::schema()).unwrap();
        Self { schema }
    }

    /// Lists all keys, each prefixed by the name of its table.
    pub fn keys(&self) -> BTreeSet<String> {
        let tables = self.schema["$defs"].as_object().unwrap().iter();
        let tables = tables.map(|(name, table)| (name.as_str(), table));
        let all = tables.chain([("", &self.schema)]);
        let named = all.filter_map(|(name, table)| Some((name, table["properties"].as_object()?)));
        let keys = named.flat_map(|(name, keys)| keys.keys().map(move |k| format!("{name}.{k}")));
        keys.collect()
    }

    /// Returns a random table for a key of the scene, or for the scene itself if the key is empty,
    /// and the keys in it.
    pub fn table(&self, key: &str, chance: &mut Chance) -> (Value, BTreeSet<String>) {
        let mut writer = Writer { grammar: self, chance, keys: BTreeSet::new() };
        let value = if key.is_empty() {
            writer.table("", "", &self.schema)
        } else {
            writer.value("", key, &self.schema["properties"][key])
        };
        (value, writer.keys)
    }

    /// Returns the definition that a schema refers to, with its name.
    fn resolve<'a>(&'a self, schema: &'a Value) -> (&'a str, &'a Value) {
        let Some(name) = schema["$ref"].as_str() else {
            return ("", schema);
        };
        let name = name.trim_start_matches("#/$defs/");
        (name, &self.schema["$defs"][name])
    }
}

struct Writer<'a> {
    grammar: &'a Grammar,
    chance: &'a mut Chance,
    keys: BTreeSet<String>,
}

impl Writer<'_> {
    /// Decides whether an optional key is there: few keys of the scene are, and some of a table.
    fn is_there(&mut self, table: &str, key: &str) -> bool {
        match (table, key) {
            ("", key) if NUMBERED.contains(&key) || key == "circle" => false,
            (_, "material" | "contact_gravity") => false,
            ("", "gravity") | ("HingeSpec" | "SliderSpec", _) => self.chance.once_in(2),
            ("", key) if BODIES.contains(&key) => self.chance.once_in(5),
            ("", _) => self.chance.once_in(6),
            _ => self.chance.once_in(4),
        }
    }

    /// Chooses the keys of a table: the required ones, and others by chance.
    fn choose<'a>(&mut self, name: &str, schema: &'a Value) -> Vec<&'a str> {
        let all = || schema["properties"].as_object().unwrap().keys();
        // What a material may give is there, too.
        let required = [&schema["required"], &schema["anyOf"][0]["required"]];
        let required = required.map(|all| all.as_array().into_iter().flatten());
        let required: Vec<_> = required.into_iter().flatten().collect();
        let is_required = |key: &&str| required.iter().any(|r| *r == *key);
        let mut is_there = |key: &&str| is_required(key) || self.is_there(name, key);
        let mut keys: Vec<_> = all().map(String::as_str).filter(|key| is_there(key)).collect();
        // A circle is alone.
        if name.is_empty() && self.chance.once_in(60) {
            keys.retain(|key| !BODIES.contains(key));
            keys.push("circle");
        } else if name.is_empty() && !keys.iter().any(|key| BODIES.contains(key)) {
            keys.push(self.chance.from(&BODIES));
        }
        let among = |one: &[&str]| -> Vec<&'a str> {
            let known = all().map(String::as_str);
            known.filter(|key| one.contains(key)).collect()
        };
        for (_, one) in ONE.iter().filter(|(table, _)| *table == name) {
            keys.retain(|key| !one.contains(key));
            keys.push(self.chance.from(&among(one)));
        }
        for one in ALTERNATIVES {
            let there: Vec<_> = keys.iter().copied().filter(|k| one.contains(k)).collect();
            if there.len() > 1 && !there.iter().all(is_required) {
                let kept = self.chance.from(&there);
                keys.retain(|key| !one.contains(key) || *key == kept || is_required(key));
            }
        }
        for (_, key, others) in TOGETHER.iter().filter(|(table, ..)| *table == name) {
            keys.retain(|other| other != key);
            if others.split(' ').any(|other| keys.contains(&other)) {
                keys.extend(among(&[key]));
            }
        }
        for (_, key, other) in NEEDS.iter().filter(|(table, ..)| *table == name) {
            if !other.split(' ').any(|other| keys.contains(&other)) {
                keys.retain(|k| k != key);
            }
        }
        keys
    }

    /// Returns a random table of a type, for a key of its owner.
    fn table(&mut self, owner: &str, name: &str, schema: &Value) -> Value {
        let mut table = Map::new();
        for key in self.choose(name, schema) {
            let value = self.value(name, key, &schema["properties"][key]);
            table.insert(key.into(), value);
        }
        // Now and then, a scene makes no sense.
        if !self.chance.once_in(150) {
            sense::mend(owner, name, &mut table, self.chance);
        }
        for key in table.keys() {
            self.keys.insert(format!("{name}.{key}"));
        }
        Value::Object(table)
    }

    fn value(&mut self, table: &str, key: &str, schema: &Value) -> Value {
        let (name, schema) = self.grammar.resolve(schema);
        if schema["properties"].is_object() {
            return self.table(table, name, schema);
        }
        for choices in ["anyOf", "oneOf"] {
            if let Some(all) = schema[choices].as_array() {
                let all: Vec<_> = all.iter().filter(|s| s["type"] != "null").collect();
                let one = self.chance.from(&all);
                return self.value(table, key, one);
            }
        }
        if let Some(all) = schema["enum"].as_array() {
            return all[self.chance.below(all.len())].clone();
        }
        if !schema["const"].is_null() {
            return schema["const"].clone();
        }
        let kind = schema["type"].as_array();
        let kind = kind.map_or(&schema["type"], |all| &all[0]);
        let own = format!("{table}.{key}");
        let is_meant = |keys: &&[&str]| keys.contains(&key) || keys.contains(&own.as_str());
        match kind.as_str().unwrap() {
            "array" => self.list(table, key, schema),
            "boolean" => Value::Bool(self.chance.once_in(2)),
            "integer" => {
                let counts = COUNTS.iter().find(|(keys, ..)| is_meant(keys));
                let (_, low, high) = counts.unwrap_or_else(|| panic!("no counts of {own}"));
                (low + self.chance.below(high - low + 1)).into()
            }
            "number" => {
                let numbers = NUMBERS.iter().find(|(keys, _)| is_meant(keys));
                let (_, range) = numbers.unwrap_or_else(|| panic!("no numbers of {own}"));
                if self.chance.once_in(200) {
                    return self.chance.from(&ODD).into();
                }
                self.chance.within(*range).into()
            }
            "string" => {
                let words = WORDS.iter().find(|(word, _)| *word == key || *word == own);
                let (_, words) = words.unwrap_or_else(|| panic!("no words of {own}"));
                self.chance.from(words).into()
            }
            other => panic!("{own} is of the kind {other}"),
        }
    }

    fn list(&mut self, table: &str, key: &str, schema: &Value) -> Value {
        if let Some(items) = schema["prefixItems"].as_array() {
            let items = items.iter().map(|item| self.value(table, key, item));
            return items.collect();
        }
        let count = match (schema["minItems"].as_u64(), key) {
            (Some(count), _) => count as usize,
            (None, "positions") => 2 + self.chance.below(5),
            (None, _) => 1 + self.chance.below(2),
        };
        let mut item = |_| self.value(table, key, &schema["items"]);
        (0..count).map(&mut item).collect()
    }
}
