//! Steps and tolerances that the program accepts.

use std::ops::RangeInclusive;

use a3_core::Control;

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
