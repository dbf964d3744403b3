//! A box, turned as one likes, still or moving.

use nalgebra::Vector3;

use super::{Nearest, push_out};
use crate::error::{Error, finite, positive};
use crate::path::Path;

/// Keeps particles out of a box.
#[derive(Clone, Copy, Debug, PartialEq)]
#[doc(alias = "Box")]
pub struct Cuboid {
    /// Of the centre.
    pub path: Path,
    /// Half its length along each of the axes (m).
    pub half_extents: Vector3<f64>,
    /// The directions of its edges: unit vectors, each across the others.
    pub axes: [Vector3<f64>; 3],
}

impl Cuboid {
    /// Turned from the upright about the vector `turn` by its length (rad).
    ///
    /// # Errors
    /// A half extent is not above 0, or a number is not finite.
    pub fn new(path: Path, half_extents: Vector3<f64>, turn: Vector3<f64>) -> Result<Self, Error> {
        for &half in &half_extents {
            positive("half the extent of a box", half)?;
        }
        finite("the turn of a box", turn)?;
        // Rodrigues' formula.
        let angle = turn.norm();
        let (sin, cos) = libm::sincos(angle);
        let about = if angle > 0.0 {
            turn / angle
        } else {
            Vector3::zeros()
        };
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()]
            .map(|e| e * cos + about.cross(&e) * sin + about * (about.dot(&e) * (1.0 - cos)));
        Ok(Self {
            path,
            half_extents,
            axes,
        })
    }

    pub(crate) fn push_out(&self, t: f64, x: &mut [f64], v: &mut [f64]) {
        push_out(&self.path.at(t), x, v, |d| self.nearest(d));
    }

    /// On the face that is nearest.
    fn nearest(&self, d: Vector3<f64>) -> Option<Nearest> {
        let local = self.axes.map(|axis| axis.dot(&d));
        let depth = |k: usize| self.half_extents[k] - local[k].abs();
        if !(0..3).all(|k| depth(k) > 0.0) {
            return None;
        }
        let k = (1..3).fold(
            0,
            |k, other| if depth(other) < depth(k) { other } else { k },
        );
        let normal = if local[k] < 0.0 {
            -self.axes[k]
        } else {
            self.axes[k]
        };
        Some(Nearest {
            point: d + normal * depth(k),
            normal,
        })
    }
}
