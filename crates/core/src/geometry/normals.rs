//! Directions perpendicular to another.

use nalgebra::Vector3;

/// Returns two unit vectors, perpendicular to a third and to one another.
pub(crate) fn normals(direction: Vector3<f64>) -> [Vector3<f64>; 2] {
    let mut axis = Vector3::zeros();
    axis[direction.iamin()] = 1.0;
    let first = direction.cross(&axis).normalize();
    [first, direction.cross(&first)]
}
