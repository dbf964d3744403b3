//! Signed distances of points from shapes.

use nalgebra::Vector3;

use super::closest::{Separation, along_axis};
use super::shape::Shape;

impl Shape {
    /// Returns the distance of a point from the surface (m), below 0 inside.
    #[must_use]
    pub fn distance(&self, point: Vector3<f64>) -> f64 {
        self.separation(point).distance
    }

    /// Returns the separation of a point d, in the shape's own frame.
    pub(crate) fn separation(&self, d: Vector3<f64>) -> Separation {
        match self {
            Self::Sphere { radius } => around(d, *radius),
            Self::Box { half_extents, axes } => of_box(d, *half_extents, *axes),
            Self::Capsule { ends: [a, b], radius } => {
                let (axis, share) = along_axis([*a, *b], d);
                around(d - (a + axis * share), *radius)
            }
            Self::Mesh(mesh) => mesh.separation(d),
            Self::Floor => Separation { distance: d.y, normal: Vector3::y() },
        }
    }

    /// Returns whether the surface consists of flat faces.
    pub(crate) fn is_faceted(&self) -> bool {
        matches!(self, Self::Floor | Self::Box { .. } | Self::Mesh(_))
    }

    /// Returns the normal acceleration (m/s2) of a point d that moves along the surface at velocity
    /// v (m/s), towards the inside.
    pub(crate) fn curving(&self, d: Vector3<f64>, v: Vector3<f64>) -> f64 {
        let (from_axis, across) = match self {
            Self::Sphere { .. } => (d, v),
            Self::Capsule { ends: [a, b], .. } => {
                let (axis, share) = along_axis([*a, *b], d);
                let is_beside = 0.0 < share && share < 1.0;
                let along = axis.try_normalize(0.0).filter(|_| is_beside);
                let across = along.map_or(v, |along| v - along * v.dot(&along));
                (d - (a + axis * share), across)
            }
            Self::Floor | Self::Box { .. } | Self::Mesh(_) => return 0.0,
        };
        let distance = from_axis.norm();
        if distance == 0.0 {
            return 0.0;
        }
        let outwards = from_axis.dot(&across) / distance;
        (across.norm_squared() - outwards * outwards) / distance
    }

    /// Returns whether the shape is convex: then the tangent plane at the nearest point is a lower
    /// bound of the distance.
    pub(crate) fn is_convex(&self) -> bool {
        !matches!(self, Self::Mesh(_))
    }

    /// Returns the depth (m) of the deepest point inside, half of the least width; 0 for a mesh,
    /// because it is unknown.
    pub(crate) fn greatest_depth(&self) -> f64 {
        match self {
            Self::Sphere { radius } | Self::Capsule { radius, .. } => *radius,
            Self::Box { half_extents, .. } => half_extents.min(),
            Self::Mesh(_) => 0.0,
            Self::Floor => f64::INFINITY,
        }
    }

    /// Returns the radius (m) of a sphere around the place that contains the shape; infinite for a
    /// floor.
    #[must_use]
    pub fn reach(&self) -> f64 {
        match self {
            Self::Sphere { radius } => *radius,
            Self::Box { half_extents, .. } => half_extents.norm(),
            Self::Capsule { ends: [a, b], radius } => a.norm().max(b.norm()) + radius,
            Self::Mesh(mesh) => mesh.reach(),
            Self::Floor => f64::INFINITY,
        }
    }
}

/// Returns the separation of d from a sphere of that radius (m) around the origin.
fn around(d: Vector3<f64>, radius: f64) -> Separation {
    let distance = d.norm();
    Separation {
        distance: distance - radius,
        normal: d.try_normalize(0.0).unwrap_or_else(Vector3::y),
    }
}

/// Returns the separation of d from a box around the origin.
fn of_box(d: Vector3<f64>, half_extents: Vector3<f64>, axes: [Vector3<f64>; 3]) -> Separation {
    let local = axes.map(|axis| axis.dot(&d));
    let beyond: [f64; 3] = std::array::from_fn(|k| local[k].abs() - half_extents[k]);
    let sign = |k: usize| if local[k] < 0.0 { -1.0 } else { 1.0 };
    let outside = (0..3).filter(|k| beyond[*k] > 0.0);
    let offset = outside.fold(Vector3::zeros(), |sum, k| sum + axes[k] * (sign(k) * beyond[k]));
    if let Some(normal) = offset.try_normalize(0.0) {
        return Separation { distance: offset.norm(), normal };
    }
    let k = (1..3).fold(0, |k, other| if beyond[other] > beyond[k] { other } else { k });
    Separation { distance: beyond[k], normal: axes[k] * sign(k) }
}
