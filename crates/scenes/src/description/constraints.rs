//! Constraints: rods, ropes, wires and joints.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::motion::{Triple, is_default};

/// Constraint: either a `rod` or a `rope` between two particles, or a `point`, a `line`, a
/// `circle` or a `sphere` that one `particle` stays on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ConstraintSpec {
    /// The two particles that a rod joins.
    pub rod: Option<[usize; 2]>,
    /// The two particles that a rope joins: they are no farther apart than its length.
    pub rope: Option<[usize; 2]>,
    /// Length of the rod or the rope (m); if not given, the initial distance of its particles.
    pub length: Option<f64>,
    /// Coefficient of restitution of a rope that tightens; 0 if not given.
    #[serde(skip_serializing_if = "is_default")]
    pub restitution: f64,
    /// The particle that stays on a point, a line, a circle or a sphere.
    pub particle: Option<usize>,
    /// Point that the particle stays at (m).
    pub point: Option<Triple>,
    /// Straight line that the particle stays on.
    pub line: Option<LineSpec>,
    /// Circle that the particle stays on.
    pub circle: Option<CircleSpec>,
    /// Sphere that the particle stays on.
    pub sphere: Option<BallSpec>,
}

/// Straight line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LineSpec {
    /// A point of the line (m).
    pub point: Triple,
    /// Direction, of any length but 0.
    pub direction: Triple,
}

/// Circle in space.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CircleSpec {
    /// Centre (m).
    pub center: Triple,
    /// Normal of the circle's plane, of any length but 0.
    pub normal: Triple,
    /// Radius (m).
    pub radius: f64,
}

/// Surface of a ball.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BallSpec {
    /// Centre (m).
    pub center: Triple,
    /// Radius (m).
    pub radius: f64,
}

/// Joint of a rigid body with another one, or with the world: one of `ball`, `hinge`, `slider` and
/// `fixed`. The two do not touch each other.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct JointSpec {
    /// Number of the rigid body that is joined to the world, counted from 0. An alternative is
    /// `bodies`.
    pub body: Option<usize>,
    /// Numbers of two rigid bodies, of which the second moves relative to the first.
    pub bodies: Option<[usize; 2]>,
    /// Ball joint: the point (m) that both have in common.
    pub ball: Option<Triple>,
    /// Hinge, about whose axis the body turns.
    pub hinge: Option<HingeSpec>,
    /// Slider, along whose axis the body moves without turning.
    pub slider: Option<SliderSpec>,
    /// Whether nothing moves.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub fixed: bool,
}

/// Hinge, with limits and a motor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HingeSpec {
    /// A point of the axis (m).
    pub at: Triple,
    /// Direction of the axis, of any length but 0.
    pub axis: Triple,
    /// Least and largest angle (rad), anticlockwise as seen against the axis. It is 0 where the
    /// bodies are as described.
    #[serde(default)]
    pub limits: Option<[f64; 2]>,
    /// Coefficient of restitution at the limits, from 0 to 1; 0 if not given.
    #[serde(default)]
    pub restitution: Option<f64>,
    /// Torque of a motor (N m), at rest if there is a `speed`.
    #[serde(default)]
    pub torque: Option<f64>,
    /// Speed at which the torque of the motor vanishes (rad/s); if not given, it is constant.
    #[serde(default)]
    pub speed: Option<f64>,
}

/// Slider, with limits and a motor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SliderSpec {
    /// Direction of the axis, of any length but 0.
    pub axis: Triple,
    /// Least and largest displacement (m). It is 0 where the bodies are as described.
    #[serde(default)]
    pub limits: Option<[f64; 2]>,
    /// Coefficient of restitution at the limits, from 0 to 1; 0 if not given.
    #[serde(default)]
    pub restitution: Option<f64>,
    /// Force of a motor (N), at rest if there is a `speed`.
    #[serde(default)]
    pub force: Option<f64>,
    /// Speed at which the force of the motor vanishes (m/s); if not given, it is constant.
    #[serde(default)]
    pub speed: Option<f64>,
}
