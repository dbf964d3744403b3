//! Quantities in words.

use a3_files::rounding::short;

/// Returns a quantity with two digits, in plain decimals where these are few.
pub fn amount(value: f64) -> String {
    if value == 0.0 || (0.01..1000.0).contains(&value.abs()) {
        short(value, 2).to_string()
    } else {
        format!("{value:.1e}")
    }
}

/// Returns a time in seconds, with few digits.
pub fn seconds(time: f64) -> String {
    let time = short(time, 6);
    if (1e-3..1e6).contains(&time) || time == 0.0 {
        format!("{time} s")
    } else {
        format!("{time:e} s")
    }
}
