//! The pull of a hand on a particle: F = -m (w2 (x - p) + 2 w (v - p')), a
//! critically damped spring from the position p of the hand.

use super::force::{At, Force, check_particle};
use crate::error::Error;
use crate::path::Path;

/// A critically damped spring from a moving point to a particle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attraction {
    /// The particle.
    pub particle: usize,
    /// Mass m (kg): that of the particle and of the hand, or of the rigid body that carries it.
    pub mass: f64,
    /// Path of the point.
    pub path: Path,
    /// Natural frequency w (1/s).
    pub frequency: f64,
}

impl Attraction {
    /// Adds -m (w2 d + 2 w d').
    fn add(&self, d: [f64; 3], rate: [f64; 3], f: &mut [f64]) {
        let (n, w) = (f.len() / 3, self.frequency);
        for axis in 0..3 {
            let pull = w * w * d[axis] + 2.0 * w * rate[axis];
            f[axis * n + self.particle] -= self.mass * pull;
        }
    }

    fn row(&self, a: &[f64]) -> [f64; 3] {
        let n = a.len() / 3;
        [0, n, 2 * n].map(|column| a[column + self.particle])
    }
}

impl Force for Attraction {
    fn name(&self) -> &'static str {
        "attraction"
    }

    fn is_driven(&self) -> bool {
        true
    }

    fn check(&self, particles: usize) -> Result<(), Error> {
        check_particle(self.particle, particles)
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        let (place, x, v) = (self.path.at(at.t), self.row(at.x), self.row(at.v));
        let away = std::array::from_fn(|axis| x[axis] - place.position[axis]);
        let rate = std::array::from_fn(|axis| v[axis] - place.velocity[axis]);
        self.add(away, rate, f);
    }

    fn add_differential(&self, _: &At, [dx, dv]: [&[f64]; 2], df: &mut [f64]) {
        self.add(self.row(dx), self.row(dv), df);
    }

    fn reads_velocity(&self) -> bool {
        true
    }
}
