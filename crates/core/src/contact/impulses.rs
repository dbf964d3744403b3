//! Impulses of contact in a step.

use nalgebra::Vector3;

/// Impulses (N s) on particles during a step, in the order in which they were given.
#[derive(Clone, Debug, Default)]
pub(crate) struct Impulses(Vec<(u32, Vector3<f64>)>);

impl Impulses {
    /// Creates an empty list with room for one impulse on each of n particles.
    pub fn with_room_for(particles: usize) -> Self {
        Self(Vec::with_capacity(particles))
    }

    /// Removes the impulses of the previous step.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Adds an impulse on vertex i.
    pub fn add(&mut self, i: usize, impulse: Vector3<f64>) {
        self.0.push((i as u32, impulse));
    }

    /// Adds an impulse between two primitives, distributed to their points by the weights.
    pub fn share(&mut self, points: [u32; 4], weights: [f64; 4], impulse: Vector3<f64>) {
        for (i, weight) in points.into_iter().zip(weights) {
            if weight != 0.0 {
                self.0.push((i, impulse * weight));
            }
        }
    }

    /// Adds the impulses, divided by a time of h (s), to forces (N), n x 3; those on obstacles do
    /// not count.
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
