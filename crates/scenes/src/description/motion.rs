//! What holds, moves and stops bodies: pins and prescribed motions, constraints and joints,
//! obstacles, and the level floor of a scene, which is a height or a table.

use std::fmt;

use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, de};

use crate::fault::{beyond, within};

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

/// Keys that obstacles of all kinds share.
#[derive(Default)]
pub(crate) struct ObstacleKeys {
    pub friction: f64,
    pub restitution: f64,
    pub thickness: Option<f64>,
    pub sine: Option<Sine>,
    pub shift: Option<Shift>,
    pub turn: Option<Turn>,
}

/// Obstacle of any kind, by the keys that all share.
pub(crate) trait Movable {
    fn keys(&self) -> ObstacleKeys;

    fn set(&mut self, keys: ObstacleKeys);
}

/// Writes obstacles with their own keys, and then those that all share, whose docs name what moves.
/// They are not indented: the lines of their docs are those of the schema.
macro_rules! obstacles {
    ($(
        $(#[$about:meta])*
        pub struct $obstacle:ident { $($own:tt)* }
        moves as a $kind:ident
    )*) => {$(
    $(#[$about])*
    #[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    pub struct $obstacle {
        $($own)*
        /// Coefficient of Coulomb friction; 0 if not given.
        #[serde(default, skip_serializing_if = "is_default")]
        pub friction: f64,
        /// Coefficient of restitution, from 0 to 1; 0 if not given.
        #[serde(default, skip_serializing_if = "is_default")]
        pub restitution: f64,
        /// Thickness (m), with which edges and triangles of bodies touch it and not only particles.
        #[serde(default)]
        pub thickness: Option<f64>,
        #[doc = concat!("Oscillation of the ", stringify!($kind), ".")]
        #[serde(default)]
        pub sine: Option<Sine>,
        #[doc = concat!("Displacement of the ", stringify!($kind), ", once.")]
        #[serde(default)]
        pub shift: Option<Shift>,
        #[doc = concat!("Turn of the ", stringify!($kind), ".")]
        #[serde(default)]
        pub turn: Option<Turn>,
    }

    impl Movable for $obstacle {
        fn keys(&self) -> ObstacleKeys {
            ObstacleKeys {
                friction: self.friction,
                restitution: self.restitution,
                thickness: self.thickness,
                sine: self.sine.clone(),
                shift: self.shift.clone(),
                turn: self.turn.clone(),
            }
        }

        fn set(&mut self, keys: ObstacleKeys) {
            (self.friction, self.restitution) = (keys.friction, keys.restitution);
            (self.sine, self.shift, self.turn) = (keys.sine, keys.shift, keys.turn);
            self.thickness = keys.thickness;
        }
    }
    )*};
}

obstacles! {

/// Sphere that particles stay out of. It may move.
pub struct SphereSpec {
    /// Centre (m).
    pub center: Triple,
    /// Radius (m).
    pub radius: f64,
}
moves as a sphere

/// Box that particles stay out of. It may move.
pub struct BoxSpec {
    /// Centre (m).
    pub center: Triple,
    /// Lengths of the edges (m).
    pub size: Triple,
    /// Rotation vector: its direction is the axis, its length the angle (rad).
    #[serde(default)]
    pub rotation: Option<Triple>,
}
moves as a box

/// Capsule that particles stay out of: all points within `radius` of a line segment. It may move.
pub struct CapsuleSpec {
    /// One end of the segment (m).
    pub from: Triple,
    /// Other end of the segment (m).
    pub to: Triple,
    /// Radius (m).
    pub radius: f64,
}
moves as a capsule

/// Solid that particles stay out of, within a closed surface from a file of triangles. It may move.
pub struct ObstacleSpec {
    /// A file (.obj, .gltf, .glb, .stl, .ply) in the scene's folder or in one below it. The
    /// triangles at each edge form pairs with the same winding order.
    pub file: String,
    /// Unit of length of the file (m); 1 if not given.
    #[serde(default)]
    pub scale: Option<f64>,
    /// Position of the file's origin (m), about which it turns.
    #[serde(default)]
    pub at: Option<Triple>,
    /// Rotation vector: its direction is the axis, its length the angle (rad).
    #[serde(default)]
    pub rotation: Option<Triple>,
}
moves as a solid

}

/// Level floor: `floor = -1.0`, or `floor = { height = -1.0, friction = 0.4, restitution = 0.8 }`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Floor {
    /// Height of a smooth floor (m).
    Height(f64),
    /// Floor with friction, restitution or thickness.
    Table(FloorSpec),
}

/// Level floor with its friction, restitution and thickness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FloorSpec {
    /// Height (m).
    pub height: f64,
    /// Coefficient of Coulomb friction on it; 0 if not given.
    #[serde(default)]
    pub friction: f64,
    /// Coefficient of restitution, from 0 to 1; 0 if not given.
    #[serde(default, skip_serializing_if = "is_default")]
    pub restitution: f64,
    /// Thickness (m), with which it repels bodies before they touch it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thickness: Option<f64>,
}

/// Written out, because an untagged enum does not say what is wrong with its table.
impl<'de> Deserialize<'de> for Floor {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(HeightOrTable)
    }
}

struct HeightOrTable;

impl<'de> Visitor<'de> for HeightOrTable {
    type Value = Floor;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a height (m), or a table with the keys `height` and `friction`")
    }

    fn visit_f64<E: de::Error>(self, height: f64) -> Result<Floor, E> {
        let floor = within(height).then_some(Floor::Height(height));
        floor.ok_or_else(|| E::custom(beyond(height)))
    }

    fn visit_i64<E: de::Error>(self, height: i64) -> Result<Floor, E> {
        self.visit_f64(height as f64)
    }

    fn visit_u64<E: de::Error>(self, height: u64) -> Result<Floor, E> {
        self.visit_f64(height as f64)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Floor, A::Error> {
        FloorSpec::deserialize(MapAccessDeserializer::new(map)).map(Floor::Table)
    }
}
