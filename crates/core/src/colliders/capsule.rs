//! A capsule, still or moving: all that is within a radius of a line segment.

use nalgebra::Vector3;

use super::{Nearest, push_out, sphere};
use crate::error::{Error, finite, positive};
use crate::path::Path;

/// Keeps particles out of a rounded rod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Capsule {
    /// Of the point that the ends are seen from.
    pub path: Path,
    /// Of the segment in its middle, from there (m).
    pub ends: [Vector3<f64>; 2],
    /// In m.
    pub radius: f64,
}

impl Capsule {
    /// # Errors
    /// The radius is not above 0, or a number is not finite.
    pub fn new(path: Path, ends: [Vector3<f64>; 2], radius: f64) -> Result<Self, Error> {
        for end in ends {
            finite("the end of a capsule", end)?;
        }
        positive("a capsule's radius", radius)?;
        Ok(Self { path, ends, radius })
    }

    pub(crate) fn push_out(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        push_out(&self.path.at(t), x, v, |d| self.nearest(d));
    }

    fn nearest(&self, d: Vector3<f64>) -> Option<Nearest> {
        let [a, b] = self.ends;
        let axis = b - a;
        let squared = axis.norm_squared();
        let share = if squared > 0.0 {
            ((d - a).dot(&axis) / squared).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let middle = a + share * axis;
        let aside = || upwards(axis);
        let Nearest { point, normal } = sphere::nearest(d - middle, self.radius, aside)?;
        Some(Nearest {
            point: middle + point,
            normal,
        })
    }
}

/// The unit vector across an axis that leads upwards most steeply; along x from an upright one.
fn upwards(axis: Vector3<f64>) -> Vector3<f64> {
    let squared = axis.norm_squared();
    if squared == 0.0 {
        return Vector3::y();
    }
    [Vector3::y(), Vector3::x()]
        .into_iter()
        .map(|e| e - axis * (axis.dot(&e) / squared))
        .find(|across| across.norm_squared() > 1e-6)
        .map_or(Vector3::y(), |across| across.normalize())
}
