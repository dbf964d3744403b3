//! Deserialisation of values: each must be of the expected kind and length, and each number within
//! the bounds.

use std::vec;

use serde::de::value::{MapDeserializer, SeqDeserializer, StrDeserializer};
use serde::de::{DeserializeSeed, Expected, IntoDeserializer, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, de, forward_to_deserialize_any};

use super::value::{Entry, Found, Value};
use crate::fault::{Fault, beyond, within};
use crate::material;
use crate::material::Given;
use crate::text::line;
use crate::wording::{
    WHOLE, list_of, missing, quoted, too_large, unknown_choice, unknown_key, wrong_length,
};

impl Value<'_> {
    fn fault(&self, why: String) -> Fault {
        Fault::new("", why).at(|| self.line())
    }

    fn wrong(&self, wanted: &str, found: &Found) -> Fault {
        let found = match found {
            Found::Text(text) => quoted(text),
            Found::Whole(..) | Found::Real(_) => self.source().into(),
            Found::Truth(is) => is.to_string(),
            Found::Date(date) => format!("the date {date}"),
            Found::Null => "null".into(),
            Found::List(_) => "a list".into(),
            Found::Table(_) => "a table".into(),
        };
        self.fault(format!("it must be {wanted}, not {found}"))
    }
}

impl<'de> Deserializer<'de> for Value<'de> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.found()? {
            Found::Text(text) => visitor.visit_str(&text),
            Found::Whole(digits, radix) => {
                if let Ok(number) = i64::from_str_radix(digits, radix) {
                    visitor.visit_i64(number)
                } else if let Ok(number) = u64::from_str_radix(digits, radix) {
                    visitor.visit_u64(number)
                } else {
                    self.deserialize_f64(visitor)
                }
            }
            Found::Real(_) => self.deserialize_f64(visitor),
            Found::Truth(is) => visitor.visit_bool(is),
            Found::Date(date) => visitor.visit_str(&date),
            Found::Null => visitor.visit_unit(),
            Found::List(items) => visitor.visit_seq(Items::new(items)),
            Found::Table(entries) => visitor.visit_map(Entries::new(self.text, entries, vec![])),
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.found()? {
            Found::Truth(is) => visitor.visit_bool(is),
            other => Err(self.wrong("true or false", &other)),
        }
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        let found = self.found()?;
        let number = match found {
            Found::Whole(digits, 10) | Found::Real(digits) => digits.parse().ok(),
            Found::Whole(digits, radix) => {
                i64::from_str_radix(digits, radix).ok().map(|number| number as f64)
            }
            _ => None,
        };
        match number {
            Some(number) if within(number) => visitor.visit_f64(number),
            Some(number) => Err(self.fault(beyond(number))),
            None => Err(self.wrong("a number", &found)),
        }
    }

    fn deserialize_u64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        let found = self.found()?;
        let Found::Whole(digits, radix) = found else {
            return Err(self.wrong(WHOLE, &found));
        };
        match u64::from_str_radix(digits, radix) {
            Ok(number) => visitor.visit_u64(number),
            Err(_) if digits.starts_with('-') => Err(self.wrong(WHOLE, &found)),
            Err(_) => Err(self.fault(too_large(self.source()))),
        }
    }

    fn deserialize_u8<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        self.deserialize_u64(visitor)
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.found()? {
            Found::Text(text) => visitor.visit_str(&text),
            other => Err(self.wrong("a text in quotes", &other)),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        if self.is_null() { visitor.visit_none() } else { visitor.visit_some(self) }
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.found()? {
            Found::List(items) => visitor.visit_seq(Items::new(items)),
            other => Err(match self.in_list().filter(|_| self.is_table()) {
                Some(advice) => {
                    self.fault(format!("it must be a list of tables, not a table: {advice}"))
                }
                None => self.wrong("a list in square brackets", &other),
            }),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        count: usize,
        visitor: V,
    ) -> Result<V::Value, Fault> {
        match self.found()? {
            Found::List(items) if items.len() == count => visitor.visit_seq(Items::new(items)),
            Found::List(items) => Err(self.fault(wrong_length(count, items.len()))),
            other => Err(self.wrong(&list_of(count), &other)),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        kind: &'static str,
        keys: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        match self.found()? {
            Found::Table(entries) => {
                let given = of_material(kind, &entries)?;
                visitor.visit_map(Entries::new(self.text, entries, given))
            }
            other => {
                let wanted = format!("a table with keys among {}", keys.join(", "));
                Err(self.wrong(&wanted, &other))
            }
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        choices: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        match self.found()? {
            Found::Text(text) => {
                let text: StrDeserializer<'_, Fault> = text.as_ref().into_deserializer();
                visitor.visit_enum(text)
            }
            other => {
                let wanted = format!("one of \"{}\"", choices.join("\", \""));
                Err(self.wrong(&wanted, &other))
            }
        }
    }

    fn deserialize_ignored_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_unit()
    }

    forward_to_deserialize_any! {
        i8 i16 i32 i64 i128 u16 u32 u128 f32 char str bytes byte_buf unit unit_struct
        newtype_struct tuple_struct map identifier
    }
}

/// Items of a list, one after another.
struct Items<'a> {
    rest: Box<dyn ExactSizeIterator<Item = Value<'a>> + 'a>,
    count: usize,
}

impl<'a> Items<'a> {
    fn new(rest: Box<dyn ExactSizeIterator<Item = Value<'a>> + 'a>) -> Self {
        let count = rest.len();
        Self { rest, count }
    }
}

impl<'de> de::SeqAccess<'de> for Items<'de> {
    type Error = Fault;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, Fault> {
        let k = self.count - self.rest.len();
        let Some(item) = self.rest.next() else {
            return Ok(None);
        };
        let read = seed.deserialize(item.clone());
        let read = read.map_err(|fault| {
            let fault = fault.at(|| item.line());
            // The key of the only item has no number, nor that of a number or a text in a list.
            if (item.is_list() || item.is_table()) && self.count > 1 {
                fault.within(&k.to_string())
            } else {
                fault
            }
        });
        read.map(Some)
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.rest.len())
    }
}

/// Returns the keys that the material of a table of this kind gives, if it has one.
fn of_material(kind: &str, entries: &[Entry]) -> Result<Vec<(&'static str, Given)>, Fault> {
    let find = |key: &str| entries.iter().find(|entry| entry.key == key);
    // What is wrong with a value is said where it is read.
    let numbers = |key: &str| {
        let value = &find(key)?.value;
        let one = || f64::deserialize(value.clone()).map(|x| vec![x]);
        let all = Vec::deserialize(value.clone()).or_else(|_| one());
        Some(all.unwrap_or_default())
    };
    let named = find("material").map(|entry| (entry, String::deserialize(entry.value.clone())));
    let Some((entry, Ok(name))) = named else {
        return Ok(vec![]);
    };
    material::keys(kind, &name, &numbers)
        .map_err(|why| Fault::new("material", why).at(|| line(entry.value.text, entry.at)))
}

impl<'de> Deserializer<'de> for Given {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self {
            Self::Number(number) => visitor.visit_f64(number),
            Self::List(numbers) => visitor.visit_seq(SeqDeserializer::new(numbers.into_iter())),
            Self::Table(numbers) => visitor.visit_map(MapDeserializer::new(numbers.into_iter())),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_some(self)
    }

    forward_to_deserialize_any! {
        bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf unit
        unit_struct newtype_struct seq tuple tuple_struct map struct enum identifier ignored_any
    }
}

/// Entries of a table, one after another, and then those that its material gives.
struct Entries<'a> {
    text: &'a str,
    rest: vec::IntoIter<Entry<'a>>,
    given: vec::IntoIter<(&'static str, Given)>,
    /// Value that the material gives, and that comes next.
    next_given: Option<Given>,
    /// Entry whose value comes next.
    entry: Option<Entry<'a>>,
}

impl<'a> Entries<'a> {
    fn new(text: &'a str, entries: Vec<Entry<'a>>, given: Vec<(&'static str, Given)>) -> Self {
        Self {
            text,
            rest: entries.into_iter(),
            given: given.into_iter(),
            next_given: None,
            entry: None,
        }
    }
}

impl<'de> de::MapAccess<'de> for Entries<'de> {
    type Error = Fault;

    fn next_key_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, Fault> {
        self.entry = self.rest.next();
        let Some(Entry { key, at, .. }) = &self.entry else {
            let Some((key, given)) = self.given.next() else {
                return Ok(None);
            };
            self.next_given = Some(given);
            let key: StrDeserializer<'_, Fault> = key.into_deserializer();
            return seed.deserialize(key).map(Some);
        };
        let key: StrDeserializer<'_, Fault> = key.as_ref().into_deserializer();
        let read = seed.deserialize(key);
        read.map(Some).map_err(|fault| fault.at(|| line(self.text, *at)))
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, Fault> {
        if let Some(given) = self.next_given.take() {
            return seed.deserialize(given);
        }
        let Some(Entry { key, at, value }) = self.entry.take() else {
            return Err(Fault::new("", "a key has no value"));
        };
        let read = seed.deserialize(value);
        read.map_err(|fault| fault.at(|| line(self.text, at)).within(&key))
    }
}

impl de::Error for Fault {
    fn custom<T: std::fmt::Display>(why: T) -> Self {
        Self::new("", why)
    }

    fn invalid_type(found: Unexpected, wanted: &dyn Expected) -> Self {
        let found = match found {
            Unexpected::Str(text) => quoted(text),
            Unexpected::Bool(is) => is.to_string(),
            Unexpected::Unit => "null".into(),
            Unexpected::Seq => "a list".into(),
            Unexpected::Map => "a table".into(),
            other => other.to_string(),
        };
        Self::new("", format!("it must be {wanted}, not {found}"))
    }

    fn invalid_value(found: Unexpected, wanted: &dyn Expected) -> Self {
        match found {
            Unexpected::Unsigned(number) => Self::new("", too_large(number)),
            _ => Self::invalid_type(found, wanted),
        }
    }

    fn missing_field(key: &'static str) -> Self {
        Self::new("", missing(key))
    }

    fn unknown_field(key: &str, known: &'static [&'static str]) -> Self {
        Self::new(key, unknown_key(key, known))
    }

    fn unknown_variant(name: &str, known: &'static [&'static str]) -> Self {
        Self::new("", unknown_choice(name, known))
    }
}
