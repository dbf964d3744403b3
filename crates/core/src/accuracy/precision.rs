//! Precision of references.

use super::errors::Metric;

/// Precision that is asked of a reference: it is made no finer than this.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Precision {
    /// Quantity that has to be precise.
    pub metric: Metric,
    /// Uncertainty that is enough, in the unit of the metric.
    pub uncertainty: f64,
    /// Most work of the runs at tolerances, each by what those before it predict, and of all runs
    /// at steps together, in evaluations. Infinite where the uncertainty has to be reached at any
    /// cost.
    pub most: f64,
}

impl Precision {
    /// The finest precision of positions that double precision allows.
    pub const FINEST: Self = Self {
        metric: Metric::Position,
        uncertainty: 0.0,
        most: f64::INFINITY,
    };
}
