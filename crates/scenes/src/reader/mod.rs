//! Reading TOML and JSON as values of the kinds and lengths that are wanted. What is wrong is a
//! fault with its key and line.

mod deserializer;
mod places;
mod value;

use serde::de::DeserializeOwned;
use toml::de::{DeTable, DeValue};

use crate::fault::Fault;
pub use places::Places;
use value::Value;

/// Reads a text in TOML, with words for what is wrong that say what would be right. No number may
/// be beyond the bounds of a scene's.
///
/// # Errors
/// The text is not TOML, or not what is wanted: with the line.
pub fn read<T: DeserializeOwned>(text: &str) -> Result<T, Fault> {
    let table = table_of(text)?;
    T::deserialize(Value::of_toml(text, &table))
}

/// Reads a text in TOML as [`read`] does, with the places of its keys.
pub(crate) fn read_toml<T: DeserializeOwned>(text: &str) -> Result<(T, Places), Fault> {
    let table = table_of(text)?;
    with_places(Value::of_toml(text, &table))
}

/// Reads a text in JSON as [`read`] does, with the places of its keys.
pub(crate) fn read_json<T: DeserializeOwned>(text: &str) -> Result<(T, Places), Fault> {
    with_places(Value::of_json(text, text))
}

fn table_of(text: &str) -> Result<DeValue<'_>, Fault> {
    let table = DeTable::parse(text).map_err(|error| Fault::of_toml(text, &error))?;
    Ok(DeValue::Table(table.into_inner()))
}

/// Keys that are known have few parts, so their places take little memory: they come second.
fn with_places<T: DeserializeOwned>(value: Value) -> Result<(T, Places), Fault> {
    let read = T::deserialize(value.clone())?;
    let places = Places::of(&value)?;
    Ok((read, places))
}
