//! Steps and tolerances that the program accepts.

use std::ops::RangeInclusive;

use a3_core::Control;

/// The largest step (s): a longer one is taken for a slip of the finger.
pub const LARGEST_STEP: f64 = 10.0;
/// The smallest step (s).
pub const SMALLEST_STEP: f64 = 1e-7;

/// Relative tolerances of adaptive methods: larger ones promise nothing, smaller ones are lost in
/// rounding.
pub const TOLERANCES: RangeInclusive<f64> = 1e-13..=1.0;

/// The steps (s) or the tolerances that a control of this kind may have.
pub fn of(control: Control) -> RangeInclusive<f64> {
    match control {
        Control::Step(_) => SMALLEST_STEP..=LARGEST_STEP,
        Control::Tolerance(_) => TOLERANCES,
    }
}
