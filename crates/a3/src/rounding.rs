//! Numbers as one would type them.

/// A value rounded to so many digits.
pub fn short(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// The least of 1, 2 or 5 times a power of ten that is no less than a value.
pub fn round_up(value: f64) -> f64 {
    let power = 10_f64.powf(value.log10().floor());
    let next = [1.0, 2.0, 5.0, 10.0].map(|m| short(m * power, 1));
    next.into_iter().find(|n| *n >= value).unwrap_or(value)
}
