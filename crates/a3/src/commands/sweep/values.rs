//! Values of a sweep: a single one, a list, or a range; and the keys of a scene that have them, by
//! their paths: `chain.stiffness` of all chains, `chain.0.stiffness` of the first, `gravity.1` of a
//! list.

use std::collections::BTreeMap;

use serde_json::{Map, Number, Value};

/// Largest number of values of a range.
const MAX_COUNT: u64 = 1_000_000;
/// Keys of a range.
const RANGE: [&str; 4] = ["from", "to", "count", "spacing"];

/// Description of valid values, for errors.
const VALID_VALUES: &str =
    "a value, a list, or a range such as { from = 1, to = 100, count = 5, spacing = \"linear\" }";

/// Returns whether a table is a range.
fn is_range(value: &Value) -> bool {
    let table = value.as_object();
    table.is_some_and(|table| RANGE[..3].iter().any(|key| table.contains_key(*key)))
}

/// Lists all values. Those of a range have equal ratios, unless its spacing is linear.
pub fn all(value: &Value) -> Result<Vec<Value>, String> {
    match value {
        Value::Array(list) if list.is_empty() => Err("the list is empty".into()),
        Value::Array(list) => Ok(list.clone()),
        Value::Object(table) => {
            if let Some(key) = table.keys().find(|key| !RANGE.contains(&key.as_str())) {
                let why = format!("there is no key `{key}`: it must be {VALID_VALUES}");
                return Err(why);
            }
            let number = |key: &str| {
                let number = table.get(key).and_then(Value::as_f64);
                number.ok_or_else(|| format!("`{key}` must be a number: it must be {VALID_VALUES}"))
            };
            let (from, to) = (number("from")?, number("to")?);
            let count = table.get("count").and_then(Value::as_u64);
            let count = count.filter(|count| (1..=MAX_COUNT).contains(count));
            let count = count
                .ok_or_else(|| format!("`count` must be a whole number from 1 to {MAX_COUNT}"))?;
            match table.get("spacing").and_then(Value::as_str) {
                Some("linear") => Ok(spread(from, to, count, |share| from + (to - from) * share)),
                None if !(from > 0.0 && to > 0.0) => Err(
                    "ratios need numbers above 0: make `from` and `to` positive, or add spacing = \"linear\"".into(),
                ),
                None => Ok(spread(from, to, count, |share| {
                    from * libm::pow(to / from, share)
                })),
                Some(_) => Err("`spacing` must be \"linear\", or left out for equal ratios".into()),
            }
        }
        value => Ok(vec![value.clone()]),
    }
}

/// Returns `count` numbers: both ends as they are, and between them `at` of equal shares from 0 to
/// 1, rounded to six digits. Whole numbers stay whole.
fn spread(from: f64, to: f64, count: u64, at: impl Fn(f64) -> f64) -> Vec<Value> {
    let numbers = (0..count).map(|k| match k {
        0 => from,
        k if k + 1 == count => to,
        k => {
            let number = at(k as f64 / (count - 1) as f64);
            format!("{number:.5e}").parse().unwrap_or(number)
        }
    });
    numbers.map(exact).collect()
}

/// Converts a number, to a whole one if it is whole.
pub fn exact(number: f64) -> Value {
    if number.fract() == 0.0 && number.abs() < 2f64.powi(53) {
        Value::from(number as i64)
    } else {
        Number::from_f64(number).map_or(Value::Null, Value::Number)
    }
}

/// Returns the paths of all keys in nested tables, with their values. A table is a range if it has
/// the keys of one; the name of any other table is a part of the path.
pub fn flat(keys: &BTreeMap<String, Value>) -> Vec<(String, Value)> {
    let mut all = vec![];
    for (name, value) in keys {
        flatten(name.clone(), value, &mut all);
    }
    all
}

fn flatten(path: String, value: &Value, all: &mut Vec<(String, Value)>) {
    match value {
        Value::Object(table) if !is_range(value) && !table.is_empty() => {
            for (name, value) in table {
                flatten(format!("{path}.{name}"), value, all);
            }
        }
        value => all.push((path, value.clone())),
    }
}

/// Sets the value of the key at a path.
pub fn set(at: &mut Value, path: &str, value: &Value) -> Result<(), String> {
    let (first, rest) = match path.split_once('.') {
        Some((first, rest)) => (first, Some(rest)),
        None => (path, None),
    };
    let item = match (at, first.parse::<usize>()) {
        (Value::Array(list), Ok(k)) => {
            let last = list.len().max(1) - 1;
            let why = || format!("there is no number {k}: the list has 0 to {last}");
            list.get_mut(k).ok_or_else(why)?
        }
        (Value::Array(list), Err(_)) => {
            return list.iter_mut().try_for_each(|item| set(item, path, value));
        }
        (Value::Object(table), _) => {
            let empty = || Value::Object(Map::new());
            table.entry(first).or_insert_with(empty)
        }
        _ => {
            let why = format!("there is no key `{first}` in a value that is not a table");
            return Err(why);
        }
    };
    match rest {
        Some(rest) => return set(item, rest, value),
        None => item.clone_from(value),
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn values_are_alone_listed_or_in_ranges() {
        assert_eq!(all(&json!(3)), Ok(vec![json!(3)]));
        assert_eq!(all(&json!([1, [2, 3]])), Ok(vec![json!(1), json!([2, 3])]));
        let range = json!({"from": 0.001, "to": 0.1, "count": 3});
        assert_eq!(all(&range), Ok(vec![json!(0.001), json!(0.01), json!(0.1)]));
        let seeds = json!({"from": 1, "to": 4, "count": 4, "spacing": "linear"});
        assert_eq!(all(&seeds), Ok(vec![json!(1), json!(2), json!(3), json!(4)]));
        let one = json!({"from": 5.5, "to": 9, "count": 1});
        assert_eq!(all(&one), Ok(vec![json!(5.5)]));
        for wrong in [
            json!([]),
            json!({"from": 1, "to": 2}),
            json!({"from": 1, "to": 2, "count": 0}),
            json!({"from": 1, "to": 2, "count": 2.5}),
            json!({"from": 0, "to": 2, "count": 2}),
            json!({"from": 1, "to": 2, "count": 2, "spacing": "log"}),
            json!({"from": 1, "to": 2, "count": 2, "steps": 3}),
        ] {
            assert!(all(&wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn keys_are_set_by_their_paths() {
        let mut scene = json!({"gravity": [0, -9.8, 0], "chain": [{"mass": 1}, {"mass": 2}]});
        for (path, value) in [
            ("chain.mass", json!(7)),
            ("chain.1.stiffness", json!(25)),
            ("gravity.1", json!(-1)),
            ("wind.seed", json!(3)),
            ("drag", json!(0.1)),
        ] {
            set(&mut scene, path, &value).unwrap();
        }
        let right = json!({"gravity": [0, -1, 0], "drag": 0.1, "wind": {"seed": 3},
            "chain": [{"mass": 7}, {"mass": 7, "stiffness": 25}]});
        assert_eq!(scene, right);
        for wrong in ["gravity.3", "chain.2.mass", "drag.more"] {
            assert!(set(&mut scene, wrong, &json!(1)).is_err(), "{wrong}");
        }
    }

    #[test]
    fn tables_are_parts_of_paths() {
        let keys = json!({"chain": {"mass": [1, 2], "0": {"drag": {"from": 1, "to": 2, "count": 2}}}, "a.b": 1});
        let flat = flat(&serde_json::from_value(keys).unwrap());
        let paths: Vec<_> = flat.iter().map(|(path, _)| path.as_str()).collect();
        assert_eq!(paths, ["a.b", "chain.0.drag", "chain.mass"]);
    }
}
