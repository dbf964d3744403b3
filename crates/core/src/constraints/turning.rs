//! Rotation of rigid bodies under the forces of constraints at their points.

use nalgebra::{Matrix3, Vector3};

/// Rotational state of a rigid body.
pub(crate) struct Turning {
    /// Position of its centre (m).
    pub center: Vector3<f64>,
    /// Rotation matrix from its principal axes to the world.
    pub rotation: Matrix3<f64>,
    /// Angular velocity (rad/s).
    pub spin: Vector3<f64>,
    /// Angular acceleration without constraints (rad/s2).
    pub acceleration: Vector3<f64>,
    /// Inverses of the principal moments of inertia (1/kg m2).
    pub inverse_inertia: Vector3<f64>,
}

impl Turning {
    /// Returns the rotation matrix, and angular velocity (rad/s).
    pub(super) fn turned(&self) -> (Matrix3<f64>, Vector3<f64>) {
        (self.rotation, self.spin)
    }
}

/// Lever of a point of a rigid body.
pub(super) struct Lever {
    /// From the centre to the point (m).
    arm: Vector3<f64>,
    rotation: Matrix3<f64>,
    /// Acceleration of the point by the spin alone (m/s2).
    pub(super) inwards: Vector3<f64>,
}

impl Lever {
    pub(super) fn new(turning: &Turning, point: Vector3<f64>) -> Self {
        let arm = point - turning.center;
        Self {
            arm,
            rotation: turning.rotation,
            inwards: turning.spin.cross(&turning.spin.cross(&arm)),
        }
    }

    /// Returns the torque of a force at the point, along the principal axes.
    pub(super) fn of(&self, force: Vector3<f64>) -> Vector3<f64> {
        self.rotation.tr_mul(&self.arm.cross(&force))
    }
}
