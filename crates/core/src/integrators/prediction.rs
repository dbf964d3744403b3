//! Prediction of a step without springs, for methods that then solve spring by spring: with masses
//! m, drag c and the other forces F, v* = (m v + h F(t, x, v)) / (m + h c), x* = x + h v*. Drag is
//! treated as in implicit Euler, so it is stable at any step; it adds h c to the masses for the
//! solution of springs. Pinned particles move to their places at t + h.

use crate::error::Error;
use crate::refusal::Refusal;
use crate::system::{Compliant, Mechanics, ParticleSystem, place_pins};
use crate::work::Work;

/// Scratch of a prediction.
pub(super) struct Prediction {
    f: Vec<f64>,
    /// One over m + h c of each particle (1/kg); 0 where it is pinned.
    pub inverse_masses: Vec<f64>,
}

impl Prediction {
    /// Creates a prediction for a system of n particles.
    pub fn new(particles: usize) -> Self {
        Self { f: vec![0.0; 3 * particles], inverse_masses: vec![0.0; particles] }
    }

    /// Advances x and v from t to t + h (s) as if there were no springs.
    pub fn take(&mut self, system: &dyn Compliant, t: f64, h: f64, x: &mut [f64], v: &mut [f64]) {
        let Self { f, inverse_masses } = self;
        system.other_forces(t, x, v, f);
        let masses = system.inverse_masses();
        let drag = h * system.drag_coefficient();
        for (inverse, w) in inverse_masses.iter_mut().zip(masses) {
            *inverse = w / (1.0 + drag * w);
        }
        let n = masses.len();
        for axis in 0..3 {
            let column = axis * n..(axis + 1) * n;
            let moved = x[column.clone()].iter_mut().zip(&mut v[column.clone()]);
            for (((x, v), f), w) in moved.zip(&f[column]).zip(masses) {
                *v = (*v + h * w * f) / (1.0 + drag * w);
                *x += h * *v;
            }
        }
        place_pins(system, t + h, x, v);
    }
}

/// Returns the view of a system that has its springs one by one.
///
/// # Errors
/// It has none.
pub(super) fn springs_of<'a>(
    system: &'a dyn ParticleSystem,
    method: &'static str,
) -> Result<&'a dyn Compliant, Error> {
    let mechanics = system.mechanics();
    mechanics
        .and_then(Mechanics::compliant)
        .ok_or(Error::Unsupported { method, why: Refusal::LacksSprings })
}

/// Returns the work of iterations over all springs: each counts as an evaluation and, for the rest
/// of its cost (in evaluations of forces spring by spring), as linear algebra.
pub(super) fn work(system: &dyn Compliant, iterations: u32, price: f64) -> Work {
    let speed = system.linearized().map_or(1.0, |system| system.hints().speed);
    Work {
        evaluations: iterations.into(),
        algebra: f64::from(iterations) * (speed * price - 1.0),
        ..Work::default()
    }
}
