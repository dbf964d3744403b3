//! JSON: lists of times, positions and velocities; or states as `a3 simulate` writes them.

use std::borrow::Cow;

use serde::Deserialize;
use serde_json::value::RawValue;

use super::build::States;

/// States, or one state, as a file has them.
#[derive(Deserialize)]
#[serde(expecting = "a table with the keys t and x")]
struct Record<'a> {
    #[serde(borrow, alias = "time", alias = "times")]
    t: &'a RawValue,
    #[serde(borrow, alias = "positions")]
    x: &'a RawValue,
    #[serde(borrow, default, alias = "velocities")]
    v: Option<&'a RawValue>,
    #[serde(default)]
    seconds: Option<f64>,
}

/// Vectors of all particles. A number that is not finite is null in JSON.
type Vectors = Vec<[Option<f64>; 3]>;

/// Reads states.
///
/// # Errors
/// The text is not JSON, or a key is missing or holds something else.
pub fn read(text: &str) -> Result<States, String> {
    // Python writes numbers that are not finite as these words.
    let mut text = Cow::Borrowed(text);
    for word in ["-Infinity", "Infinity", "NaN"] {
        if text.contains(word) {
            text = text.replace(word, "null").into();
        }
    }
    let mut raw = States::default();
    if text.trim_start().starts_with('[') {
        let records: Vec<Record> = parsed(&text, "list of states")?;
        for (k, record) in records.iter().enumerate() {
            add_state(&mut raw, record).map_err(|why| format!("state {k}: {why}"))?;
        }
        return Ok(raw);
    }
    let record: Record = parsed(&text, "states")?;
    if !record.t.get().starts_with('[') {
        add_state(&mut raw, &record)?;
        return Ok(raw);
    }
    raw.seconds = record.seconds;
    raw.times = times(record.t)?;
    raw.digits[0].add_all(record.t.get());
    raw.digits[1].add_all(record.x.get());
    let rows = |all: Vec<Vectors>| all.iter().map(columns).collect();
    raw.positions = rows(parsed(record.x.get(), "x")?);
    if let Some(v) = record.v.filter(|v| v.get() != "null") {
        let velocities: Vec<_> = rows(parsed(v.get(), "v")?);
        raw.velocities = Some(velocities).filter(|rows| !rows.is_empty());
    }
    Ok(raw)
}

/// Adds one state.
fn add_state(raw: &mut States, record: &Record) -> Result<(), String> {
    let time: f64 = parsed(record.t.get(), "time")?;
    raw.times.push(time);
    raw.digits[0].add_all(record.t.get());
    raw.digits[1].add_all(record.x.get());
    raw.positions.push(columns(&parsed(record.x.get(), "positions")?));
    if let Some(v) = record.v.filter(|v| v.get() != "null") {
        let velocities = raw.velocities.get_or_insert_default();
        velocities.push(columns(&parsed(v.get(), "velocities")?));
    }
    raw.seconds = record.seconds.or(raw.seconds);
    Ok(())
}

/// Reads times.
fn times(text: &RawValue) -> Result<Vec<f64>, String> {
    let times: Vec<Option<f64>> = parsed(text.get(), "t")?;
    Ok(times.into_iter().map(|t| t.unwrap_or(f64::NAN)).collect())
}

/// Returns vectors as a matrix in column-major order.
fn columns(vectors: &Vectors) -> Vec<f64> {
    let column = |axis: usize| vectors.iter().map(move |v| v[axis].unwrap_or(f64::NAN));
    (0..3).flat_map(column).collect()
}

/// Reads a part of the text.
fn parsed<'a, T: Deserialize<'a>>(text: &'a str, what: &str) -> Result<T, String> {
    serde_json::from_str(text).map_err(|e| {
        format!(
            "its {what} cannot be read ({e}): it must be {{\"t\": [0, ...], \"x\": [[[x, y, z], ...], ...]}}, also with \
             \"v\", or the JSON of a3 simulate"
        )
    })
}
