//! Rotation of a rigid body: its orientation and its angular momentum in the state of a system.

use nalgebra::{Matrix3, Quaternion, Vector3};

/// Number of numbers in the state of a body, besides those of its centre: q and L.
pub const ROTATION: usize = 7;

/// Rotation and angular momentum of a body.
///
/// ```
/// use a3_core::{Vector3, rigid::Rotation};
///
/// let quarter = Rotation::about(Vector3::z() * std::f64::consts::FRAC_PI_2);
/// assert!((quarter.matrix() * Vector3::x() - Vector3::y()).norm() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    /// Quaternion from the principal axes to the world, of any length but 0.
    pub q: Quaternion<f64>,
    /// Angular momentum in the world (kg m2/s).
    pub momentum: Vector3<f64>,
}

impl Rotation {
    /// Creates the rotation about a vector by its length (rad), at rest.
    #[must_use]
    pub fn about(vector: Vector3<f64>) -> Self {
        Self { q: turn(vector), momentum: Vector3::zeros() }
    }

    /// Creates the rotation from the numbers of a state: w, x, y and z of q, then L.
    #[must_use]
    pub fn read(numbers: &[f64]) -> Self {
        let [w, x, y, z, lx, ly, lz] = *numbers else {
            unreachable!("a rotation is seven numbers")
        };
        Self { q: Quaternion::new(w, x, y, z), momentum: Vector3::new(lx, ly, lz) }
    }

    /// Writes the numbers of a state.
    pub fn write(&self, numbers: &mut [f64]) {
        let Self { q, momentum: l } = self;
        numbers.copy_from_slice(&[q.w, q.i, q.j, q.k, l.x, l.y, l.z]);
    }

    /// Returns the rotation matrix R(q / |q|), from the principal axes to the world.
    #[must_use]
    pub fn matrix(&self) -> Matrix3<f64> {
        let Quaternion { coords: c } = self.q;
        let (x, y, z, w) = (c.x, c.y, c.z, c.w);
        let s = 2.0 / (w * w + x * x + y * y + z * z);
        Matrix3::new(
            1.0 - s * (y * y + z * z),
            s * (x * y - w * z),
            s * (x * z + w * y),
            s * (x * y + w * z),
            1.0 - s * (x * x + z * z),
            s * (y * z - w * x),
            s * (x * z - w * y),
            s * (y * z + w * x),
            1.0 - s * (x * x + y * y),
        )
    }
}

/// Returns the quaternion of a rotation about a vector by its length (rad).
pub(crate) fn turn(vector: Vector3<f64>) -> Quaternion<f64> {
    let angle = vector.norm();
    if angle == 0.0 {
        return Quaternion::identity();
    }
    let (sin, cos) = libm::sincos(0.5 * angle);
    Quaternion::from_parts(cos, vector * (sin / angle))
}

/// Returns the rotation vector (rad), of at most half a turn, from one orientation to another.
pub(crate) fn rotation_vector(to: Quaternion<f64>, from: Quaternion<f64>) -> Vector3<f64> {
    let by = to * from.conjugate();
    let along = by.imag();
    let length = along.norm();
    if length == 0.0 {
        return Vector3::zeros();
    }
    // The nearer of the two ways round.
    let angle = 2.0 * libm::atan2(length * by.w.signum(), by.w.abs());
    along * (angle / length)
}
