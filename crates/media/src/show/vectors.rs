//! Vectors for drawing.

use a3_core::Vector3;

/// Converts a vector to single precision.
pub fn to_f32(v: Vector3<f64>) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

/// Returns a unit vector at a right angle to `along`.
pub fn perpendicular(along: Vector3<f64>) -> Vector3<f64> {
    let up = if along.y.abs() < 0.9 * along.norm() { Vector3::y() } else { Vector3::x() };
    along.cross(&up).try_normalize(0.0).unwrap_or(Vector3::z())
}
