//! Control of the steps of a run.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Control of the steps of a run: their length, or the error that each of them may make.
///
/// Every method takes steps of a fixed length. A tolerance is for adaptive methods, which estimate
/// their error.
///
/// ```
/// use a3_core::{Control, integrators};
///
/// let (rk4, dopri5) = (integrators::find("rk4").unwrap(), integrators::find("dopri5").unwrap());
/// assert!(rk4.check_control(Control::Step(0.01)).is_ok());
/// assert!(rk4.check_control(Control::Tolerance(1e-6)).is_err());
/// assert!(dopri5.check_control(Control::Tolerance(1e-6)).is_ok());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Control {
    /// Length of every step (s).
    Step(f64),
    /// Relative tolerance of the error of a step, without unit.
    Tolerance(f64),
}

impl Control {
    /// Returns the step (s) or the tolerance, as a user types it or a table shows it.
    #[must_use]
    pub fn value(self) -> f64 {
        match self {
            Self::Step(value) | Self::Tolerance(value) => value,
        }
    }

    /// Returns a control of the same kind with another value.
    #[must_use]
    pub fn with_value(self, value: f64) -> Self {
        match self {
            Self::Step(_) => Self::Step(value),
            Self::Tolerance(_) => Self::Tolerance(value),
        }
    }

    /// Returns the fixed step (s), if there is one.
    #[must_use]
    pub fn step(self) -> Option<f64> {
        match self {
            Self::Step(step) => Some(step),
            Self::Tolerance(_) => None,
        }
    }

    /// Returns the relative tolerance, if there is one.
    #[must_use]
    pub fn tolerance(self) -> Option<f64> {
        match self {
            Self::Step(_) => None,
            Self::Tolerance(tolerance) => Some(tolerance),
        }
    }
}

impl fmt::Display for Control {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Step(step) => write!(f, "step {}", StepLength(*step)),
            Self::Tolerance(tolerance) => write!(f, "tolerance {tolerance:e}"),
        }
    }
}

/// Step (s) as people write it: `0.005 s`, `1/60 s` in place of all its digits, or `0.06 ms`.
#[derive(Clone, Copy, Debug)]
pub struct StepLength(pub f64);

impl fmt::Display for StepLength {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (decimal, rate) = (self.0.to_string(), 1.0 / self.0);
        if decimal.len() > 10 && (rate - rate.round()).abs() < 1e-9 * rate {
            write!(f, "1/{} s", rate.round())
        } else if self.0 < 1e-3 {
            let digits = format!("{:.9e}", 1e3 * self.0);
            write!(f, "{} ms", digits.parse::<f64>().unwrap_or(1e3 * self.0))
        } else {
            write!(f, "{decimal} s")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::StepLength;

    #[test]
    fn steps_are_written_as_people_write_them() {
        for (step, words) in [
            (0.005, "0.005 s"),
            (1.0 / 60.0, "1/60 s"),
            (0.016_666_666_666_666_7, "1/60 s"),
            (0.001_234_567_890_123, "0.001234567890123 s"),
            (6e-5, "0.06 ms"),
            (1.0 / 30_000.0, "1/30000 s"),
            (1e-7, "0.0001 ms"),
        ] {
            assert_eq!(StepLength(step).to_string(), words);
        }
    }
}
