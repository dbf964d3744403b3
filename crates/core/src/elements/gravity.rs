//! Uniform gravity, F = m g.

use nalgebra::Vector3;

use super::force::{At, DriftForces, Force};
use crate::energy::Energy;

/// Uniform gravity, an acceleration g (m/s2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gravity(pub Vector3<f64>);

impl Force for Gravity {
    fn name(&self) -> &'static str {
        "gravity"
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        for (g, f) in self.0.iter().zip(f.chunks_exact_mut(at.masses.len())) {
            add(*g, at.masses, f);
        }
    }

    fn add_differential(&self, _: &At, _: [&[f64]; 2], _: &mut [f64]) {}

    fn energy(&self, at: &At) -> Energy {
        let of_axis =
            |(x, g): (&[f64], &f64)| -g * x.iter().zip(at.masses).map(|(x, m)| m * x).sum::<f64>();
        let columns = at.x.chunks_exact(at.masses.len());
        Energy { gravitational: columns.zip(&self.0).map(of_axis).sum(), ..Energy::default() }
    }

    fn drift_forces(&self) -> Option<DriftForces> {
        Some(DriftForces { gravity: self.0, ..DriftForces::default() })
    }
}

/// Adds m g along one axis.
pub(super) fn add(g: f64, masses: &[f64], f: &mut [f64]) {
    if g != 0.0 {
        for (f, m) in f.iter_mut().zip(masses) {
            *f += m * g;
        }
    }
}
