//! Digits with which a file gives its numbers: they tell how far these are rounded.

/// Digits of the numbers of a file.
#[derive(Clone, Copy, Debug, Default)]
pub struct Digits {
    /// Largest number of decimals. A number has -2 of them if its last digit counts hundreds.
    decimals: Option<i32>,
    /// Largest number of significant digits.
    significant: i32,
    /// Share of a number by which it is rounded at most, where the file is binary.
    share: f64,
}

impl Digits {
    /// Digits of binary numbers that are rounded by at most this share of them.
    pub fn binary(share: f64) -> Self {
        Self {
            share,
            ..Self::default()
        }
    }

    /// Takes account of a number as it is written.
    pub fn add(&mut self, text: &str) {
        let (digits, power) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
        let Ok(power) = power.parse::<i16>() else {
            return;
        };
        let after = digits.split_once('.').map_or("", |(_, after)| after);
        let decimals = (after.len() as i32).saturating_sub(power.into());
        let all = digits.bytes().filter(u8::is_ascii_digit);
        let significant = all.skip_while(|b| *b == b'0').count() as i32;
        self.decimals = Some(self.decimals.map_or(decimals, |most| most.max(decimals)));
        self.significant = self.significant.max(significant);
    }

    /// Takes account of all numbers in a text, and of nothing else that is in it.
    pub fn add_all(&mut self, text: &str) {
        let words = text.split(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c)));
        for word in words.filter(|word| word.bytes().any(|b| b.is_ascii_digit())) {
            self.add(word);
        }
    }

    /// Returns the largest error of numbers up to `largest` by their rounding: half a unit of the
    /// last digit. Some programs write a fixed number of decimals, others one of significant
    /// digits.
    pub fn rounding(&self, largest: f64) -> f64 {
        let Some(decimals) = self.decimals else {
            return self.share * largest;
        };
        let first = if largest > 0.0 {
            largest.log10().floor() as i32
        } else {
            0
        };
        let unit = (-decimals).max(first + 1 - self.significant.max(1));
        0.5 * 10f64.powi(unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounding_is_half_a_unit_of_the_last_digit() {
        for (text, largest, rounding) in [
            ("0.000000 12.345678 -0.001234", 12.3, 5e-7),
            ("1.23457e-05 1.23457 12.3457", 12.3, 5e-5),
            ("0.1 0.30000000000000004 2.5e-17", 0.3, 5e-18),
            ("0 1 2 15", 15.0, 0.5),
            ("1e3 2e3", 2000.0, 500.0),
            ("[nothing]", 1.0, 0.0),
        ] {
            let mut digits = Digits::default();
            digits.add_all(text);
            let found = digits.rounding(largest);
            assert!(
                (found - rounding).abs() <= 1e-9 * rounding,
                "{text}: {found}"
            );
        }
        assert_eq!(Digits::binary(0.25).rounding(2.0), 0.5);
    }
}
