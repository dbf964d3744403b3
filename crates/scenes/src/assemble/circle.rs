//! First-order system of one particle on a circle.

use std::ops::Range;

use a3_core::{Measure, ParticleSystem};

/// One particle whose velocity is its position turned by a right angle: f = (-y, x, 0).
pub(super) struct Circling;

impl ParticleSystem for Circling {
    fn dim(&self) -> usize {
        3
    }

    fn eval_f(&self, _t: f64, y: &[f64], dydt: &mut [f64]) {
        dydt.copy_from_slice(&[-y[1], y[0], 0.0]);
    }

    fn measures(&self, visit: &mut dyn FnMut(Range<usize>, Measure)) {
        visit(0..3, Measure::Alike);
    }
}
