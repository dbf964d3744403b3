//! Pins and prescribed motions.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Three numbers: x, y (up), z.
pub type Triple = [f64; 3];

/// Returns whether the value of a key is the one that it has if it is not given.
pub(super) fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Part of a body that can be pinned. A cloth has edges and corners, a jelly and a solid have
/// faces, a chain has ends, a mesh has a top and a bottom.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs, reason = "the names say it")]
pub enum Spot {
    Top,
    Bottom,
    Left,
    Right,
    TopLeft,
    TopRight,
    BottomLeft,
    BottomRight,
    First,
    Last,
}

/// Pinned particles and their motion. Without a motion they stay where they are, or move with a
/// rigid body.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Pin {
    /// Parts of the body, such as `["top-left", "top-right"]`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub at: Vec<Spot>,
    /// Particles, numbered from 0 in their body.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub particles: Vec<usize>,
    /// Number of the rigid body, counted from 0, to which the particles are attached where they
    /// are, in place of a motion. They and the body act on each other.
    pub body: Option<usize>,
    /// Oscillation of the pinned particles.
    pub sine: Option<Sine>,
    /// Displacement of the pinned particles, once; with a turn, that of its axis.
    pub shift: Option<Shift>,
    /// Turn of the pinned particles about an axis, of which `about` gives a point.
    pub turn: Option<Turn>,
    /// Time (s) from which on the particles are free, with the velocities that they have then; if
    /// not given, they are held for good.
    pub until: Option<f64>,
}

/// Oscillation by `amplitude sin(rate t + phase)` about the initial position, or about `center`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sine {
    /// Amplitude (m).
    pub amplitude: Triple,
    /// Angular frequency (rad/s).
    pub rate: f64,
    /// Phase at t = 0 (rad).
    #[serde(default)]
    pub phase: f64,
    /// Centre (m); if not given, the initial position.
    #[serde(default)]
    pub center: Option<Triple>,
}

/// Displacement along a straight line at constant velocity, between two times.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shift {
    /// Displacement (m).
    pub by: Triple,
    /// Time at which the motion begins (s).
    #[serde(default)]
    pub start: f64,
    /// Time at which the motion ends (s), later than `start`.
    pub end: f64,
}

/// Turn about an axis at constant angular velocity, anticlockwise as seen against the axis.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Turn {
    /// Point of the axis (m). Obstacles turn about their own centre if it is not given.
    #[serde(default)]
    pub about: Option<Triple>,
    /// Direction of the axis, of any length.
    pub axis: Triple,
    /// Angular velocity (rad/s). An alternative is `angle`.
    #[serde(default)]
    pub rate: Option<f64>,
    /// Angle by which it has turned at `end` (rad). An alternative is `rate`.
    #[serde(default)]
    pub angle: Option<f64>,
    /// Time at which the turn begins (s).
    #[serde(default)]
    pub start: f64,
    /// Time at which the turn ends (s), later than `start`; if not given, it never does.
    #[serde(default)]
    pub end: Option<f64>,
}
