//! Keys of a scene, by their paths: `chain.stiffness` of all chains, `chain.0.stiffness` of the
//! first, `gravity.1` of a list.

use std::collections::BTreeMap;

use serde_json::{Map, Value};

use super::values::is_range;

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
    match (at, first.parse::<usize>()) {
        (Value::Array(list), Ok(k)) => {
            let count = list.len();
            let item = list.get_mut(k).ok_or_else(|| {
                format!(
                    "there is no number {k}: the list has 0 to {}",
                    count.max(1) - 1
                )
            })?;
            set_in(item, rest, value)
        }
        (Value::Array(list), Err(_)) => list.iter_mut().try_for_each(|item| set(item, path, value)),
        (Value::Object(table), _) => {
            let empty = || Value::Object(Map::new());
            set_in(table.entry(first).or_insert_with(empty), rest, value)
        }
        _ => Err(format!(
            "there is no key `{first}` in a value that is not a table"
        )),
    }
}

fn set_in(at: &mut Value, rest: Option<&str>, value: &Value) -> Result<(), String> {
    if let Some(rest) = rest {
        return set(at, rest, value);
    }
    at.clone_from(value);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

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
