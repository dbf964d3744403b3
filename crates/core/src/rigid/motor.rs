//! Motors: torques about an axis, or forces along it, between two rigid bodies, or a body and the
//! world.

use nalgebra::Vector3;

use super::body::Moving;
use crate::error::{Error, finite};

/// Motion that a motor drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Drive {
    /// Rotation about the axis, by a torque.
    Rotary,
    /// Displacement along the axis, by a force.
    Linear,
}

/// Motor that moves a body relative to another one or to the world, about or along an axis of the
/// body. Its torque or force is constant; or it falls in proportion to the speed and vanishes at
/// one speed, as that of a DC motor at a constant voltage: T (1 - w / w0). Beyond that speed it
/// brakes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motor {
    /// What it drives.
    pub drive: Drive,
    /// Number of the body that it moves.
    pub first: usize,
    /// Number of the body that it moves against; `None` for the world.
    pub second: Option<usize>,
    /// Axis along the principal axes of the first body, of length 1.
    pub axis: Vector3<f64>,
    /// Torque (N m) or force (N) at rest.
    pub effort: f64,
    /// Speed at which that vanishes (rad/s or m/s), of the same sign; `None` for a constant one.
    pub speed: Option<f64>,
}

impl Motor {
    /// Checks its numbers, among so many bodies.
    pub(crate) fn check(&self, bodies: usize) -> Result<(), Error> {
        finite("the axis of a motor", self.axis)?;
        let right = self.effort.is_finite()
            && self.first < bodies
            && self.second.is_none_or(|k| k < bodies && k != self.first)
            && self
                .speed
                .is_none_or(|speed| speed.is_finite() && speed * self.effort > 0.0);
        if right {
            return Ok(());
        }
        Err(Error::Invalid(
            "a motor needs bodies that exist, a finite torque or force, and a speed of the same sign".into(),
        ))
    }

    /// Returns the force (N) and the torque (N m) on the first body, and the torque on the second,
    /// whose force is opposite. A force acts at the centre of the first.
    pub(crate) fn load(&self, first: &Driven, second: Option<&Driven>) -> [Vector3<f64>; 3] {
        let axis = first.moving.rotation * self.axis;
        let still = Vector3::zeros();
        let arm = second.map_or(still, |second| first.place - second.place);
        let spin = second.map_or(still, |second| second.moving.spin);
        let rate = match self.drive {
            Drive::Rotary => first.moving.spin - spin,
            Drive::Linear => {
                let velocity = second.map_or(still, |second| second.velocity);
                first.velocity - velocity - spin.cross(&arm)
            }
        };
        let share = self
            .speed
            .map_or(1.0, |speed| 1.0 - axis.dot(&rate) / speed);
        let effort = axis * (self.effort * share);
        match self.drive {
            Drive::Rotary => [still, effort, -effort],
            Drive::Linear => [effort, still, -arm.cross(&effort)],
        }
    }
}

/// Body on one side of a motor in a state.
pub(crate) struct Driven {
    pub moving: Moving,
    /// Place (m) and velocity (m/s) of its centre.
    pub place: Vector3<f64>,
    pub velocity: Vector3<f64>,
}
