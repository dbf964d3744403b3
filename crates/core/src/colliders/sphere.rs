//! A sphere, still or moving.

use nalgebra::Vector3;

use crate::path::Path;

/// Keeps particles out of a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Of the centre.
    pub path: Path,
    /// In m.
    pub radius: f64,
}

impl Sphere {
    pub(crate) fn push_out(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        let center = self.path.at(t);
        let c = center.position;
        let n = x.len() / 3;
        for i in 0..n {
            let (dx, dy, dz) = (x[i] - c.x, x[n + i] - c.y, x[2 * n + i] - c.z);
            let squared = dx * dx + dy * dy + dz * dz;
            if squared >= self.radius * self.radius {
                continue;
            }
            let distance = squared.sqrt();
            let normal = if distance > 0.0 {
                Vector3::new(dx, dy, dz) / distance
            } else {
                Vector3::y()
            };
            let velocity = Vector3::new(v[i], v[n + i], v[2 * n + i]) - center.velocity;
            let inwards = velocity.dot(&normal).min(0.0);
            for axis in 0..3 {
                x[axis * n + i] = c[axis] + self.radius * normal[axis];
                v[axis * n + i] -= inwards * normal[axis];
            }
        }
    }
}
