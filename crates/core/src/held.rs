//! The view of a system for implicit methods whose particles are held by constraints C(x) = 0: the
//! forces without those of the constraints, and the constraints to second order.

use nalgebra::{Matrix3, Vector3};

/// View of [`Held`], of which other crates see only whether it is there.
#[derive(Clone, Copy)]
pub struct HeldView<'a>(pub(crate) &'a dyn Held);

/// A system with constraints, none of which holds a rigid body.
pub(crate) trait Held {
    /// Writes all forces (N) except those of constraints to f.
    fn free_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]);

    /// Replaces `out` by all constraints at x, always the same number in the same order.
    fn joints(&self, x: &[f64], out: &mut Vec<Joint>);

    /// Writes the multipliers (N) at t (s) in the state (x, v) under the free forces f (N), three
    /// for each joint.
    fn multipliers(&self, t: f64, state: [&[f64]; 2], f: &[f64], out: &mut [f64]);

    /// Moves x and v by the least distance, weighted by the masses, so that all constraints are met
    /// and stay so. Pinned particles do not move.
    fn project(&self, x: &mut [f64], v: &mut [f64]);
}

/// A constraint at given positions: up to three equations C = 0 (m) on one or two particles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Joint {
    /// Its particles; the same one twice if there is one.
    pub ends: [usize; 2],
    /// Number of its equations; 0 while it holds nothing.
    pub count: usize,
    /// Gradients of the equations by the position of the first end. For the second, they are
    /// opposite.
    pub gradients: [Vector3<f64>; 3],
    /// Errors C (m).
    pub values: [f64; 3],
    /// Second derivative of the last equation (1/m); the others are linear.
    pub curvature: Matrix3<f64>,
}

impl Joint {
    /// Lists the particles, each with the sign of its gradients.
    pub fn parts(&self) -> impl Iterator<Item = (usize, f64)> {
        let [i, j] = self.ends;
        [(i, 1.0), (j, -1.0)].into_iter().take(if i == j { 1 } else { 2 })
    }

    /// Returns the row of the first end less that of the second, if there is one.
    pub fn relative(&self, a: &[f64]) -> Vector3<f64> {
        let n = a.len() / 3;
        let row = |i: usize| Vector3::new(a[i], a[n + i], a[2 * n + i]);
        self.parts().map(|(i, sign)| row(i) * sign).sum()
    }

    /// Adds a vector to the row of the first end, and its opposite to that of the second.
    pub fn spread(&self, by: Vector3<f64>, out: &mut [f64]) {
        let n = out.len() / 3;
        for (i, sign) in self.parts() {
            for axis in 0..3 {
                out[axis * n + i] += sign * by[axis];
            }
        }
    }

    /// Returns the matrix by which impulses (N s) along the gradients change with the positions.
    pub fn turning(&self, impulses: &[f64]) -> Matrix3<f64> {
        match self.count {
            0 => Matrix3::zeros(),
            count => self.curvature * impulses[count - 1],
        }
    }
}
