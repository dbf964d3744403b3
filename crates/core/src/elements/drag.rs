//! Viscous drag, F = -c v.

use super::force::{At, DriftForces, Force};

/// Viscous drag on each particle, of coefficient c (kg/s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drag(pub f64);

impl Force for Drag {
    fn name(&self) -> &'static str {
        "drag"
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        add(self.0, at.v, f);
    }

    fn add_differential(&self, _: &At, [_, dv]: [&[f64]; 2], df: &mut [f64]) {
        add(self.0, dv, df);
    }

    fn reads_velocity(&self) -> bool {
        self.0 > 0.0
    }

    fn drift_forces(&self) -> Option<DriftForces> {
        Some(DriftForces { drag: self.0, ..DriftForces::default() })
    }
}

/// Adds -c v.
pub(super) fn add(c: f64, v: &[f64], f: &mut [f64]) {
    for (f, v) in f.iter_mut().zip(v) {
        *f -= c * v;
    }
}
