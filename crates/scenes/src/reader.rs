//! Reading TOML as values of the kinds and lengths that are wanted. What is wrong is a fault with
//! its key and line.

use std::ops::Range;

use serde::de::value::StrDeserializer;
use serde::de::{
    self, DeserializeOwned, DeserializeSeed, Expected, IntoDeserializer, Unexpected, Visitor,
};
use serde::{Deserializer, forward_to_deserialize_any};
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue};

use crate::fault::{Fault, line};
use crate::wording::{
    WHOLE, list_of, missing, quoted, too_large, unknown_choice, unknown_key, wrong_length,
};

/// Reads a text in TOML, with words for what is wrong that say what would be right.
///
/// # Errors
/// The text is not TOML, or not what is wanted: with the line.
pub fn read<T: DeserializeOwned>(text: &str) -> Result<T, Fault> {
    let table = DeTable::parse(text).map_err(|error| Fault::of_toml(text, &error))?;
    let table = DeValue::Table(table.into_inner());
    let whole = Value {
        text,
        found: &table,
        span: 0..0,
    };
    T::deserialize(whole).map_err(|fault| fault.locate(text))
}

/// A value, and where it is in the text. The span of a table is its header.
struct Value<'a> {
    text: &'a str,
    found: &'a DeValue<'a>,
    span: Range<usize>,
}

impl<'a> Value<'a> {
    fn new(text: &'a str, spanned: &'a Spanned<DeValue<'a>>) -> Self {
        Self {
            text,
            found: spanned.get_ref(),
            span: spanned.span(),
        }
    }

    fn fault(&self, why: String) -> Fault {
        Fault {
            line: Some(line(self.text, self.span.start)),
            ..Fault::new("", why)
        }
    }

    fn wrong(&self, wanted: &str) -> Fault {
        let found = match self.found {
            DeValue::String(text) => quoted(text),
            DeValue::Integer(number) => number.to_string(),
            DeValue::Float(number) => number.to_string(),
            DeValue::Boolean(is) => is.to_string(),
            DeValue::Datetime(date) => format!("the date {date}"),
            DeValue::Array(_) => "a list".into(),
            DeValue::Table(_) => "a table".into(),
        };
        self.fault(format!("it must be {wanted}, not {found}"))
    }

    /// The fault of a table where there is to be a list.
    fn alone(&self) -> Fault {
        let source = self.text.get(self.span.clone()).unwrap_or_default();
        let advice = if source.starts_with('[') {
            format!("write its header as `[{source}]`")
        } else {
            "put it in square brackets, as in `[{ ... }]`".into()
        };
        self.fault(format!(
            "it must be a list of tables, not a table: {advice}"
        ))
    }

    fn number(&self) -> Option<f64> {
        match self.found {
            DeValue::Integer(number) if number.radix() == 10 => number.as_str().parse().ok(),
            DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix())
                .ok()
                .map(|number| number as f64),
            DeValue::Float(number) => number.as_str().parse().ok(),
            _ => None,
        }
    }

    fn items<V: Visitor<'a>>(&self, items: &'a DeArray<'a>, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_seq(Items {
            text: self.text,
            rest: items.iter().enumerate(),
            count: items.len(),
        })
    }

    fn entries<V: Visitor<'a>>(
        &self,
        table: &'a DeTable<'a>,
        visitor: V,
    ) -> Result<V::Value, Fault> {
        let mut entries: Vec<_> = table.iter().collect();
        // What is wrong first is said first.
        entries.sort_by_key(|(key, _)| key.span().start);
        visitor.visit_map(Entries {
            text: self.text,
            rest: entries.into_iter(),
            entry: None,
        })
    }
}

impl<'de> Deserializer<'de> for Value<'de> {
    type Error = Fault;

    fn deserialize_any<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.found {
            DeValue::String(text) => visitor.visit_str(text),
            DeValue::Boolean(is) => visitor.visit_bool(*is),
            DeValue::Array(items) => self.items(items, visitor),
            DeValue::Table(table) => self.entries(table, visitor),
            DeValue::Datetime(date) => visitor.visit_str(&date.to_string()),
            DeValue::Integer(_) | DeValue::Float(_) => self.deserialize_f64(visitor),
        }
    }

    fn deserialize_bool<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.found {
            DeValue::Boolean(is) => visitor.visit_bool(*is),
            _ => Err(self.wrong("true or false")),
        }
    }

    fn deserialize_f64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.number() {
            Some(number) => visitor.visit_f64(number),
            None => Err(self.wrong("a number")),
        }
    }

    fn deserialize_u64<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        let DeValue::Integer(number) = self.found else {
            return Err(self.wrong(WHOLE));
        };
        match u64::from_str_radix(number.as_str(), number.radix()) {
            Ok(number) => visitor.visit_u64(number),
            Err(_) if number.as_str().starts_with('-') => Err(self.wrong(WHOLE)),
            Err(_) => Err(self.fault(too_large(number))),
        }
    }

    fn deserialize_u8<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        self.deserialize_u64(visitor)
    }

    fn deserialize_string<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.found {
            DeValue::String(text) => visitor.visit_str(text),
            _ => Err(self.wrong("a text in quotes")),
        }
    }

    fn deserialize_option<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        visitor.visit_some(self)
    }

    fn deserialize_seq<V: Visitor<'de>>(self, visitor: V) -> Result<V::Value, Fault> {
        match self.found {
            DeValue::Array(items) => self.items(items, visitor),
            DeValue::Table(_) => Err(self.alone()),
            _ => Err(self.wrong("a list in square brackets")),
        }
    }

    fn deserialize_tuple<V: Visitor<'de>>(
        self,
        count: usize,
        visitor: V,
    ) -> Result<V::Value, Fault> {
        match self.found {
            DeValue::Array(items) if items.len() == count => self.items(items, visitor),
            DeValue::Array(items) => Err(self.fault(wrong_length(count, items.len()))),
            _ => Err(self.wrong(&list_of(count))),
        }
    }

    fn deserialize_struct<V: Visitor<'de>>(
        self,
        _: &'static str,
        keys: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        match self.found {
            DeValue::Table(table) => self.entries(table, visitor),
            _ => Err(self.wrong(&format!("a table with keys among {}", keys.join(", ")))),
        }
    }

    fn deserialize_enum<V: Visitor<'de>>(
        self,
        _: &'static str,
        choices: &'static [&'static str],
        visitor: V,
    ) -> Result<V::Value, Fault> {
        match self.found {
            DeValue::String(text) => {
                let text: StrDeserializer<'_, Fault> = text.as_ref().into_deserializer();
                visitor.visit_enum(text)
            }
            _ => Err(self.wrong(&format!("one of \"{}\"", choices.join("\", \"")))),
        }
    }

    forward_to_deserialize_any! {
        i8 i16 i32 i64 i128 u16 u32 u128 f32 char str bytes byte_buf unit unit_struct
        newtype_struct tuple_struct map identifier ignored_any
    }
}

/// The items of a list, one after another.
struct Items<'a, I> {
    text: &'a str,
    rest: I,
    count: usize,
}

impl<'de, I> de::SeqAccess<'de> for Items<'de, I>
where
    I: ExactSizeIterator<Item = (usize, &'de Spanned<DeValue<'de>>)>,
{
    type Error = Fault;

    fn next_element_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, Fault> {
        let Some((k, item)) = self.rest.next() else {
            return Ok(None);
        };
        let read = seed.deserialize(Value::new(self.text, item));
        // The only item goes without a number, and so do single numbers and texts.
        let is_part = matches!(item.get_ref(), DeValue::Array(_) | DeValue::Table(_));
        match read {
            Err(fault) if is_part && self.count > 1 => Err(fault.within(&k.to_string())),
            read => read.map(Some),
        }
    }

    fn size_hint(&self) -> Option<usize> {
        Some(self.rest.len())
    }
}

/// The keys and values of a table, one after another.
struct Entries<'a, I> {
    text: &'a str,
    rest: I,
    /// The value that comes next, and its key.
    entry: Option<(&'a str, &'a Spanned<DeValue<'a>>)>,
}

impl<'de, I, K> de::MapAccess<'de> for Entries<'de, I>
where
    K: AsRef<str> + 'de,
    I: Iterator<Item = (&'de Spanned<K>, &'de Spanned<DeValue<'de>>)>,
{
    type Error = Fault;

    fn next_key_seed<S: DeserializeSeed<'de>>(
        &mut self,
        seed: S,
    ) -> Result<Option<S::Value>, Fault> {
        self.entry = self
            .rest
            .next()
            .map(|(key, value)| (key.get_ref().as_ref(), value));
        let Some((key, _)) = self.entry else {
            return Ok(None);
        };
        let key: StrDeserializer<'_, Fault> = key.into_deserializer();
        seed.deserialize(key).map(Some)
    }

    fn next_value_seed<S: DeserializeSeed<'de>>(&mut self, seed: S) -> Result<S::Value, Fault> {
        let Some((key, value)) = self.entry.take() else {
            return Err(Fault::new("", "a key has no value"));
        };
        seed.deserialize(Value::new(self.text, value))
            .map_err(|fault| fault.within(key))
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
