//! The values of what is plotted at one time.

/// Number of values of a row.
pub const VALUES: usize = 11;

/// Values of a pick at one time. Of a spring: length (m), strain and force (N), above 0 when it
/// pulls. Otherwise: position (m), velocity (m/s), kinetic and potential energy (J), and the
/// angular velocity (rad/s) of a rigid body. A value that is not known is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Simulated time (s).
    pub time: f64,
    pub values: [f64; VALUES],
}
