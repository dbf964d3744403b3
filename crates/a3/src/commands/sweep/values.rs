//! Values of a sweep: a single one, a list, or a range.

use serde_json::{Number, Value};

/// Largest number of values of a range.
const MAX_COUNT: u64 = 1_000_000;
/// Keys of a range.
const RANGE: [&str; 4] = ["from", "to", "count", "spacing"];

/// Description of valid values, for errors.
const VALID_VALUES: &str =
    "a value, a list, or a range such as { from = 1, to = 100, count = 5, spacing = \"linear\" }";

/// Returns whether a table is a range.
pub fn is_range(value: &Value) -> bool {
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
                return Err(format!(
                    "there is no key `{key}`: it must be {VALID_VALUES}"
                ));
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
        assert_eq!(
            all(&seeds),
            Ok(vec![json!(1), json!(2), json!(3), json!(4)])
        );
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
}
