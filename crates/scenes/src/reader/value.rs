//! Values of a text in TOML or JSON, and where they are in it.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fmt;
use std::ops::Range;

use serde::Deserialize;
use serde::de::{Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;
use toml::Spanned;
use toml::de::DeValue;

use crate::fault::Fault;
use crate::text::line;

/// Value with its place in the text. The span of a table in TOML is its header.
#[derive(Clone)]
pub(super) struct Value<'a> {
    pub text: &'a str,
    node: ValueNode<'a>,
    span: Range<usize>,
}

/// Value in TOML, which is parsed as a whole, or in JSON, which is parsed level by level.
#[derive(Clone)]
enum ValueNode<'a> {
    Toml(&'a DeValue<'a>),
    Json(&'a str),
}

/// Value that is opened: its kind, and the values in it.
pub(super) enum Found<'a> {
    Text(Cow<'a, str>),
    /// Whole number: its digits, and their radix.
    Whole(&'a str, u32),
    Real(&'a str),
    Truth(bool),
    Date(String),
    Null,
    List(Box<dyn ExactSizeIterator<Item = Value<'a>> + 'a>),
    Table(Vec<Entry<'a>>),
}

/// Entry of a table.
pub(super) struct Entry<'a> {
    pub key: Cow<'a, str>,
    /// Byte at which the key begins, or, in JSON, its value.
    pub at: usize,
    pub value: Value<'a>,
}

impl<'a> Value<'a> {
    /// Creates the value of a whole text in TOML.
    pub fn of_toml(text: &'a str, whole: &'a DeValue<'a>) -> Self {
        Self { text, node: ValueNode::Toml(whole), span: 0..0 }
    }

    /// Creates the value of a part of a text in JSON.
    pub fn of_json(text: &'a str, part: &'a str) -> Self {
        let start = part.as_ptr() as usize - text.as_ptr() as usize;
        Self { text, node: ValueNode::Json(part), span: start..start + part.len() }
    }

    fn spanned(text: &'a str, spanned: &'a Spanned<DeValue<'a>>) -> Self {
        Self { text, node: ValueNode::Toml(spanned.get_ref()), span: spanned.span() }
    }

    /// Returns the byte at which it begins.
    pub fn at(&self) -> usize {
        self.span.start
    }

    /// Returns the line at which it begins, counted from 1.
    pub fn line(&self) -> usize {
        line(self.text, self.span.start)
    }

    /// Returns the text of the value, or of its header.
    pub fn source(&self) -> &'a str {
        self.text.get(self.span.clone()).unwrap_or_default()
    }

    pub fn is_table(&self) -> bool {
        match self.node {
            ValueNode::Toml(value) => matches!(value, DeValue::Table(_)),
            ValueNode::Json(part) => part.starts_with('{'),
        }
    }

    pub fn is_list(&self) -> bool {
        match self.node {
            ValueNode::Toml(value) => matches!(value, DeValue::Array(_)),
            ValueNode::Json(part) => part.starts_with('['),
        }
    }

    pub fn is_null(&self) -> bool {
        matches!(self.node, ValueNode::Json("null"))
    }

    /// Says how to turn a table into a list of tables; `None` in JSON, where no list of tables is
    /// wanted.
    pub fn in_list(&self) -> Option<String> {
        match (&self.node, self.source()) {
            (ValueNode::Json(_), _) => None,
            (_, header) if header.starts_with('[') => {
                Some(format!("write its header as `[{header}]`"))
            }
            _ => Some("put it in square brackets, as in `[{ ... }]`".into()),
        }
    }

    /// Opens the value, one level deep.
    ///
    /// # Errors
    /// It is no JSON.
    pub fn found(&self) -> Result<Found<'a>, Fault> {
        match self.node {
            ValueNode::Toml(value) => Ok(self.found_in_toml(value)),
            ValueNode::Json(part) => self.found_in_json(part),
        }
    }

    fn found_in_toml(&self, value: &'a DeValue<'a>) -> Found<'a> {
        let text = self.text;
        match value {
            DeValue::String(found) => Found::Text(found.as_ref().into()),
            DeValue::Integer(number) => Found::Whole(number.as_str(), number.radix()),
            DeValue::Float(number) => Found::Real(number.as_str()),
            DeValue::Boolean(is) => Found::Truth(*is),
            DeValue::Datetime(date) => Found::Date(date.to_string()),
            DeValue::Array(items) => {
                Found::List(Box::new(items.iter().map(|item| Self::spanned(text, item))))
            }
            DeValue::Table(table) => {
                let mut entries: Vec<_> = table.iter().collect();
                // Of several faults, the first in the text is reported.
                entries.sort_by_key(|(key, _)| key.span().start);
                let entries = entries.into_iter().map(|(key, value)| Entry {
                    key: key.get_ref().as_ref().into(),
                    at: key.span().start,
                    value: Self::spanned(text, value),
                });
                Found::Table(entries.collect())
            }
        }
    }

    fn found_in_json(&self, part: &'a str) -> Result<Found<'a>, Fault> {
        let text = self.text;
        Ok(match part.trim_start().bytes().next() {
            Some(b'{') => {
                let Members(members) = self.json(part)?;
                let mut keys = BTreeSet::new();
                let members = members.into_iter().map(|(key, value)| {
                    let value = Self::of_json(text, value.get());
                    if keys.insert(key.clone()) {
                        let (key, at) = (key.into(), value.span.start);
                        return Ok(Entry { key, at, value });
                    }
                    let twice = Fault::new(key, "the key is there twice");
                    Err(twice.at(|| value.line()))
                });
                Found::Table(members.collect::<Result<_, _>>()?)
            }
            Some(b'[') => {
                let items: Vec<&RawValue> = self.json(part)?;
                let items = items.into_iter();
                Found::List(Box::new(items.map(|item| Self::of_json(text, item.get()))))
            }
            Some(b'"') => Found::Text(self.json::<String>(part)?.into()),
            Some(b't' | b'f') => Found::Truth(self.json(part)?),
            Some(b'n') => self.json(part).map(|()| Found::Null)?,
            _ => {
                let number = self.json::<&RawValue>(part)?.get();
                if number.contains(['.', 'e', 'E']) {
                    Found::Real(number)
                } else {
                    Found::Whole(number, 10)
                }
            }
        })
    }

    fn json<T: Deserialize<'a>>(&self, part: &'a str) -> Result<T, Fault> {
        serde_json::from_str(part).map_err(|error| Fault::of_json(self.line(), &error))
    }
}

/// Keys of an object in JSON with their values, in the order of the text, also if a key is there
/// twice.
struct Members<'a>(Vec<(String, &'a RawValue)>);

impl<'de> Deserialize<'de> for Members<'de> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(MembersVisitor)
    }
}

struct MembersVisitor;

impl<'de> Visitor<'de> for MembersVisitor {
    type Value = Members<'de>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a table")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        let mut members = vec![];
        while let Some(member) = map.next_entry()? {
            members.push(member);
        }
        Ok(Members(members))
    }
}
