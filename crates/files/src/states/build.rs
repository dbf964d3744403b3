//! States at times, checked, and the digits with which a file gives its numbers, which tell how far
//! these are rounded.

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
        Self { share, ..Self::default() }
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
        let first = if largest > 0.0 { largest.log10().floor() as i32 } else { 0 };
        let unit = (-decimals).max(first + 1 - self.significant.max(1));
        0.5 * 10f64.powi(unit)
    }
}

/// States of particles at increasing times. Matrices of positions and velocities are n x 3,
/// column-major: all x, all y, all z.
#[derive(Clone, Debug, Default)]
pub struct States {
    /// Times (s), increasing.
    pub times: Vec<f64>,
    /// Positions at each time (m).
    pub positions: Vec<Vec<f64>>,
    /// Velocities at each time (m/s), if there are any.
    pub velocities: Option<Vec<Vec<f64>>>,
    /// Computing time of the run (s), if the file has it.
    pub seconds: Option<f64>,
    /// First time (s) at which a number is not finite. States from then on are left out.
    pub not_finite_at: Option<f64>,
    /// Digits of the times and of the positions.
    pub digits: [Digits; 2],
}

impl States {
    /// Checks states of that many particles, as a file has them, and leaves out those that are not
    /// finite.
    ///
    /// # Errors
    /// There are no states, the times do not increase from 0 on, a number of particles is wrong, or
    /// the first state has numbers that are not finite.
    pub fn checked(mut self, particles: usize) -> Result<Self, String> {
        let times = &self.times;
        if times.is_empty() {
            return Err("it has no states".into());
        }
        check_counts(times, "positions", &self.positions, particles)?;
        if let Some(velocities) = &self.velocities {
            check_counts(times, "velocities", velocities, particles)?;
        }
        check_times(times)?;
        let is_finite = |k: &usize| {
            let velocities = self.velocities.iter().flat_map(|rows| &rows[*k]);
            let mut all = self.positions[*k].iter().chain(velocities);
            all.all(|x| x.is_finite())
        };
        let finite = (0..times.len()).take_while(is_finite).count();
        if finite == 0 {
            return Err("its first state has numbers that are not finite".into());
        }
        self.not_finite_at = times.get(finite).copied();
        self.times.truncate(finite);
        self.positions.truncate(finite);
        if let Some(velocities) = &mut self.velocities {
            velocities.truncate(finite);
        }
        let is_wrong = |seconds: f64| !(seconds > 0.0 && seconds.is_finite());
        if self.seconds.is_some_and(is_wrong) {
            return Err("its computing time is no number of seconds above 0".into());
        }
        Ok(self)
    }
}

/// Checks that there is a row of three numbers for each particle at each time.
fn check_counts(
    times: &[f64],
    name: &str,
    rows: &[Vec<f64>],
    particles: usize,
) -> Result<(), String> {
    if rows.len() != times.len() {
        return Err(format!(
            "it has {} times and {name} for {}: there must be as many",
            times.len(),
            rows.len()
        ));
    }
    for (t, row) in times.iter().zip(rows) {
        if row.len() != 3 * particles {
            return Err(format!(
                "its {name} at t = {t} s are of {} particles, and the scene has {particles}",
                row.len() / 3
            ));
        }
    }
    Ok(())
}

/// Checks that times are finite, not below 0, and increasing.
fn check_times(times: &[f64]) -> Result<(), String> {
    if let Some(wrong) = times.iter().find(|t| !(t.is_finite() && **t >= 0.0)) {
        return Err(format!("a time must be a number of seconds from 0, not {wrong}"));
    }
    let pairs = times.windows(2);
    let wrong = pairs.into_iter().find(|pair| pair[1] <= pair[0]);
    match wrong {
        Some(pair) => {
            Err(format!("its times must increase: after {} s comes {} s", pair[0], pair[1]))
        }
        None => Ok(()),
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
            assert!((found - rounding).abs() <= 1e-9 * rounding, "{text}: {found}");
        }
        assert_eq!(Digits::binary(0.25).rounding(2.0), 0.5);
    }
}
