//! Precision of references.

use super::errors::Metric;

/// Precision required of a reference; it is made no more precise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// Quantity that the precision is of.
    pub metric: Metric,
    /// Sufficient uncertainty, in the unit of the metric.
    pub uncertainty: f64,
    /// Largest work, in evaluations: of each run at a tolerance, as predicted by those before it,
    /// and of all runs at steps together. Infinite if the uncertainty must be reached at any cost.
    pub max_work: f64,
}

impl Precision {
    /// The highest precision of positions that double precision allows.
    pub const FINEST: Self = Self {
        metric: Metric::Position,
        uncertainty: 0.0,
        max_work: f64::INFINITY,
    };
}
