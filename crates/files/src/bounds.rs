//! Numbers that the program accepts: steps, tolerances, and those of options.

use std::ops::RangeInclusive;

use a3_core::{Control, Model};

use super::failure::Failure;

/// The largest step (s): a longer one is refused as a typing error.
pub const LARGEST_STEP: f64 = 10.0;
/// The smallest step (s).
pub const SMALLEST_STEP: f64 = 1e-7;

/// Relative tolerances of adaptive methods: larger ones are meaningless, smaller ones are below
/// rounding error.
pub const TOLERANCES: RangeInclusive<f64> = 1e-13..=1.0;

/// Returns the range of the steps (s) or of the tolerances of a control.
pub fn of(control: Control) -> RangeInclusive<f64> {
    match control {
        Control::Step(_) => SMALLEST_STEP..=LARGEST_STEP,
        Control::Tolerance(_) => TOLERANCES,
    }
}

/// Returns the range of the steps or of the tolerances of a control of a model: the time of a
/// system of one's own may have any unit.
pub fn of_model(model: &Model, control: Control) -> RangeInclusive<f64> {
    match (model.network(), control) {
        (None, Control::Step(_)) => OWN_HORIZONS.range,
        _ => of(control),
    }
}

/// Numbers that an option may have.
pub struct Allowed {
    /// Smallest and largest number.
    pub range: RangeInclusive<f64>,
    /// Message for any other number.
    pub right: &'static str,
}

impl Allowed {
    /// Checks that a number is one of these.
    pub fn check(&self, number: f64) -> Result<f64, Failure> {
        if self.range.contains(&number) {
            return Ok(number);
        }
        Err(Failure::usage(format!("{}, not {number}", self.right)))
    }
}

/// Ends of runs that are compared (s).
pub const HORIZONS: Allowed = Allowed {
    range: 0.01..=1000.0,
    right: "the end is a number of seconds from 0.01 to 1000, such as 1",
};
/// Ends of runs of a system of one's own, whose time has any unit.
pub const OWN_HORIZONS: Allowed = Allowed {
    range: 1e-15..=1e15,
    right: "the end of a system's runs is a number from 1e-15 to 1e15, such as 1",
};
/// Factors of the stiffness.
pub const FACTORS: Allowed = Allowed {
    range: 1e-6..=1e6,
    right: "a factor of the stiffness is a number from 1e-6 to 1e6, such as 10",
};
/// Errors of positions (m).
pub const ERRORS: Allowed = Allowed {
    range: 1e-12..=10.0,
    right: "an error is a number of metres from 1e-12 to 10, such as 1e-3",
};
/// Computing times for a frame (ms).
pub const BUDGETS: Allowed = Allowed {
    range: 1e-4..=1e5,
    right: "a budget is a number of milliseconds from 1e-4 to 1e5, such as 2",
};
