//! Rounding to numbers with few digits.

/// Number of digits that hide the rounding errors of sums and products.
pub const DIGITS: usize = 15;

/// Rounds a value to a number of digits.
pub fn short(value: f64, digits: usize) -> f64 {
    format!("{value:.*e}", digits - 1).parse().unwrap_or(value)
}

/// Round numbers from 1 to 10, far apart.
pub const FEW: &[f64] = &[1.0, 2.0, 5.0, 10.0];

/// Round numbers from 1 to 10, each at least four fifths of the next.
pub const MANY: &[f64] = &[1.0, 1.2, 1.5, 1.8, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0, 6.0, 7.0, 8.0, 10.0];

/// Rounds a value above 0 up to a round number: one of `rounds`, from 1 to 10, times a power of
/// ten.
pub fn round_up(value: f64, rounds: &[f64]) -> f64 {
    let power = 10_f64.powf(value.log10().floor());
    let mut next = rounds.iter().map(|round| short(round * power, 2));
    next.find(|n| *n >= value).unwrap_or(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn little_is_added_by_rounding_up() {
        for k in -500..500 {
            let value = 1.037_f64.powi(k);
            let up = round_up(value, MANY);
            assert!(up >= value && value >= 0.8 * up * (1.0 - 1e-12), "{value} {up}");
            assert!(round_up(value, FEW) >= up);
        }
        assert_eq!([1.8, 1.81, 0.008].map(|value| round_up(value, MANY)), [1.8, 2.0, 0.008]);
        assert_eq!([2.0, 2.1, 70.0].map(|value| round_up(value, FEW)), [2.0, 5.0, 100.0]);
    }
}
