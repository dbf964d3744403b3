//! Reader of TOML and JSON, which deserialises values of the expected kinds and lengths. Its faults
//! have keys and lines.

mod deserializer;
mod places;
mod value;

use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

use crate::fault::Fault;
pub use places::Places;
use value::Value;

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
