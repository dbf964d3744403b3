//! Intervals of time.

/// Interval of time from t to t + h (s): a step, or a part of one.
#[derive(Clone, Copy, Debug)]
pub struct Interval {
    pub t: f64,
    pub h: f64,
}
