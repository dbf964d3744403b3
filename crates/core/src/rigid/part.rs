//! Parts of rigid bodies.

use nalgebra::Vector3;

use crate::geometry::Shape;

/// Part of a body, relative to its centre and along the principal axes.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Shape.
    pub shape: Shape,
    /// Place of the part (m).
    pub at: Vector3<f64>,
}
