//! Constraints: rods, ropes and wires.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::motion::Triple;
use super::obstacles::is_zero;

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
    #[serde(skip_serializing_if = "is_zero")]
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
