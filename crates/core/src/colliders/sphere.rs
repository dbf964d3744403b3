//! A sphere, still or moving.

use nalgebra::Vector3;

use super::{Nearest, push_out};
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
        push_out(&self.path.at(t), x, v, |d| {
            nearest(d, self.radius, Vector3::y)
        });
    }
}

/// The nearest point of a ball's surface to an inner point at d from its centre; `aside` is where the centre is put.
pub(super) fn nearest(
    d: Vector3<f64>,
    radius: f64,
    aside: impl Fn() -> Vector3<f64>,
) -> Option<Nearest> {
    let squared = d.x * d.x + d.y * d.y + d.z * d.z;
    if squared < radius * radius {
        let distance = squared.sqrt();
        let normal = if distance > 0.0 {
            d / distance
        } else {
            aside()
        };
        Some(Nearest {
            point: radius * normal,
            normal,
        })
    } else {
        None
    }
}
