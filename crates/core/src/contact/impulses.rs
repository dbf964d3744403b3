//! Impulses that contact gave in a step: on whom, and how much.

use nalgebra::Vector3;

/// Impulses (N s) on particles during a step, in the order in which they were given.
#[derive(Clone, Debug, Default)]
pub(crate) struct Impulses(Vec<(u32, Vector3<f64>)>);

impl Impulses {
    /// A list with room for one impulse on each of so many particles.
    pub fn with_room_for(particles: usize) -> Self {
        Self(Vec::with_capacity(particles))
    }

    /// Forgets those of the step before.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds an impulse on vertex i.
    pub fn add(&mut self, i: usize, impulse: Vector3<f64>) {
        self.0.push((i as u32, impulse));
    }

    /// Adds an impulse between two primitives: each of their points gets its share by its weight.
    pub fn share(&mut self, points: [u32; 4], weights: [f64; 4], impulse: Vector3<f64>) {
        for (i, weight) in points.into_iter().zip(weights) {
            if weight != 0.0 {
                self.0.push((i, impulse * weight));
            }
        }
    }

    /// Adds the impulses over a time of h (s) to forces (N), n x 3; those on obstacles do not
    /// count.
    pub fn add_forces(&self, h: f64, f: &mut [f64]) {
        let n = f.len() / 3;
        for (i, impulse) in &self.0 {
            let i = *i as usize;
            for axis in (0..3).filter(|_| i < n) {
                f[axis * n + i] += impulse[axis] / h;
            }
        }
    }
}
