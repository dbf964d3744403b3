//! Motors: torques about an axis between two rigid bodies, or a body and the world.

use nalgebra::Vector3;

use super::body::Moving;
use crate::error::{Error, finite};

/// Motor that turns a body relative to another one or to the world, about an axis of the body. Its
/// torque is constant; or it falls in proportion to the speed and vanishes at one speed, as that of
/// a DC motor at a constant voltage: T (1 - w / w0). Beyond that speed it brakes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// Number of the body that it turns.
    pub first: usize,
    /// Number of the body that it turns against; `None` for the world.
    pub second: Option<usize>,
    /// Axis along the principal axes of the first body, of length 1.
    pub axis: Vector3<f64>,
    /// Torque at rest (N m).
    pub torque: f64,
    /// Speed at which the torque vanishes (rad/s), of the same sign; `None` for a constant torque.
    pub speed: Option<f64>,
}

impl Motor {
    /// Checks its numbers, among so many bodies.
    pub(crate) fn check(&self, bodies: usize) -> Result<(), Error> {
        finite("the axis of a motor", self.axis)?;
        let right = self.torque.is_finite()
            && self.first < bodies
            && self.second.is_none_or(|k| k < bodies && k != self.first)
            && self
                .speed
                .is_none_or(|speed| speed.is_finite() && speed * self.torque > 0.0);
        if right {
            return Ok(());
        }
        Err(Error::Invalid(
            "a motor needs bodies that exist, a finite torque, and a speed of the same sign".into(),
        ))
    }

    /// Returns the torque on the first body (N m); that on the second is opposite.
    pub(crate) fn torque(&self, first: &Moving, second: Option<&Moving>) -> Vector3<f64> {
        let axis = first.rotation * self.axis;
        let spin = first.spin - second.map_or_else(Vector3::zeros, |second| second.spin);
        let share = self
            .speed
            .map_or(1.0, |speed| 1.0 - axis.dot(&spin) / speed);
        axis * (self.torque * share)
    }
}
