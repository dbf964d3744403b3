//! Scenes as text: what a scene file may say, in TOML. `docs/scenes.md` shows it by example.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::bodies::{Chain, Circle, Cloth, Jelly, MeshCloth, Particles};
use crate::fault::Fault;

/// Three numbers: x, y (up), z.
pub type Triple = [f64; 3];

/// A scene: bodies, what acts on them, and how it is run and looked at. Units are m, kg, s, N, rad.
///
/// Particles are numbered through all bodies: those of cloths first, then of jellies, meshes, chains and particles.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Description {
    /// A short name; without it, that of the file.
    pub name: Option<String>,
    /// What it is, in a line.
    pub summary: Option<String>,
    /// Solver to begin with, by letter or name.
    pub solver: Option<String>,
    /// Its step (s), or the relative tolerance of an adaptive solver.
    pub step: Option<f64>,
    /// Simulated seconds, where none are asked for.
    pub duration: Option<f64>,
    /// Gravity (m/s2), such as [0, -9.81, 0]. Without it, there is none.
    pub gravity: Option<Triple>,
    /// Viscous drag on each particle (kg/s).
    pub drag: Option<f64>,
    /// The same over the (mean) mass of a particle (1/s), instead.
    pub drag_per_mass: Option<f64>,
    /// Height of a level floor (m).
    pub floor: Option<f64>,
    /// A hand stretches the springs it holds to this many times their rest length, and then waits for the other end.
    pub reach: Option<f64>,
    /// The particle whose way is drawn.
    pub trail: Option<usize>,
    /// Where it is looked at from.
    pub camera: Option<Camera>,
    /// The wind that key d lets blow, or calms.
    pub wind: Option<WindSpec>,
    /// What key s does to the pins.
    pub swing: Option<SwingSpec>,
    /// One particle of first order on a circle, f = (-y, x, 0), and nothing else.
    pub circle: Option<Circle>,
    /// Rectangular cloths.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cloth: Vec<Cloth>,
    /// Boxes of jelly.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub jelly: Vec<Jelly>,
    /// Cloths of any shape, from files of triangles.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh: Vec<MeshCloth>,
    /// Rows of particles on springs.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub chain: Vec<Chain>,
    /// Particles one by one.
    pub particles: Option<Particles>,
    /// Springs between any particles: [i, j, stiffness (N/m), rest length (m), damping (N s/m)].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub springs: Vec<SpringSpec>,
    /// Rods and wires, which explicit solvers keep exactly.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub constraint: Vec<ConstraintSpec>,
    /// How fast what is off its constraint comes back (1/s); 10 if not given.
    pub feedback: Option<f64>,
    /// Pins of any particles, by number. They come after those of the bodies, and instead of them. Where there is a
    /// `state`, they are where that has them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pin: Vec<Pin>,
    /// Springs break when they are stretched to this many times their rest length. Without it, they do not.
    pub tear: Option<f64>,
    /// Springs that are broken from the beginning: those between two particles each.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub torn: Vec<[usize; 2]>,
    /// Boxes in the way.
    #[serde(rename = "box", skip_serializing_if = "Vec::is_empty")]
    pub boxes: Vec<BoxSpec>,
    /// Capsules in the way: rods with round ends.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub capsule: Vec<CapsuleSpec>,
    /// Spheres in the way.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sphere: Vec<SphereSpec>,
    /// Positions and velocities of all particles to start from, instead of those of the bodies.
    pub state: Option<State>,
}

/// [i, j, stiffness (N/m), rest length (m), damping (N s/m)]
pub type SpringSpec = (usize, usize, f64, f64, f64);

/// Where an eye is, and what it looks at (m).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// In m.
    pub eye: Triple,
    /// In m.
    pub target: Triple,
}

/// A gentle wind in gusts, repeatable by its seed. It pushes each particle by `force` or by `force_per_mass`, or blows with a
/// `velocity` on the triangles of surfaces.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct WindSpec {
    /// Whether it blows from the beginning.
    #[serde(skip_serializing_if = "is_default")]
    pub on: bool,
    /// Another number, other gusts.
    pub seed: u64,
    /// Mean force on each particle (N).
    pub force: Option<Triple>,
    /// The same over the (mean) mass of a particle (m/s2), instead.
    pub force_per_mass: Option<Triple>,
    /// Mean velocity of the air (m/s), instead: it pushes triangles along its flow and across it.
    pub velocity: Option<Triple>,
    /// Density of that air (kg/m3); 1.2 if not given.
    pub density: Option<f64>,
    /// Its drag coefficient; 1.2 if not given.
    pub drag: Option<f64>,
    /// Its lift coefficient; 0.6 if not given.
    pub lift: Option<f64>,
    /// The gusts are those of so much later (s).
    #[serde(skip_serializing_if = "is_default")]
    pub ahead: f64,
}

/// To and fro by `amplitude` (m), at `rate` (rad/s).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SwingSpec {
    /// In m.
    pub amplitude: Triple,
    /// In rad/s.
    pub rate: f64,
}

/// Places of a body that can be pinned. A cloth has edges and corners, a jelly its faces, a chain its ends; a mesh has a
/// top and a bottom.
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

/// Pinned particles, and how they move. Without a motion they stay where they are.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Pin {
    /// Places of the body, such as `["top-left", "top-right"]`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub at: Vec<Spot>,
    /// Particles, numbered from 0 in their body.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub particles: Vec<usize>,
    /// To and fro.
    pub sine: Option<Sine>,
    /// Once, from here to there.
    pub shift: Option<Shift>,
}

/// What holds particles without springs: a `rod` between two, or a `point`, a `line`, a `circle` or a `sphere` that one
/// `particle` stays on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ConstraintSpec {
    /// Two particles.
    pub rod: Option<[usize; 2]>,
    /// Of the rod (m); without it, the distance that they have.
    pub length: Option<f64>,
    /// The particle that stays on one of what follows.
    pub particle: Option<usize>,
    /// A point (m).
    pub point: Option<Triple>,
    /// A straight line.
    pub line: Option<LineSpec>,
    /// A circle.
    pub circle: Option<CircleSpec>,
    /// A sphere.
    pub sphere: Option<BallSpec>,
}

/// A straight line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LineSpec {
    /// One of its points (m).
    pub point: Triple,
    /// Of any length but 0.
    pub direction: Triple,
}

/// A circle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CircleSpec {
    /// In m.
    pub center: Triple,
    /// Of its plane, of any length but 0.
    pub normal: Triple,
    /// In m.
    pub radius: f64,
}

/// The surface of a ball.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BallSpec {
    /// In m.
    pub center: Triple,
    /// In m.
    pub radius: f64,
}

/// `amplitude sin(rate t + phase)` from where it is, or from `center`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sine {
    /// In m.
    pub amplitude: Triple,
    /// In rad/s.
    pub rate: f64,
    /// In rad.
    #[serde(default)]
    pub phase: f64,
    /// In m.
    #[serde(default)]
    pub center: Option<Triple>,
}

/// By so much in a straight line between two times.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shift {
    /// In m.
    pub by: Triple,
    /// In s.
    #[serde(default)]
    pub start: f64,
    /// In s, later than `start`.
    pub end: f64,
}

/// A sphere that particles stay out of. It may move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereSpec {
    /// In m.
    pub center: Triple,
    /// In m.
    pub radius: f64,
    /// To and fro.
    #[serde(default)]
    pub sine: Option<Sine>,
    /// Once, from here to there.
    #[serde(default)]
    pub shift: Option<Shift>,
}

/// A box that particles stay out of. It may move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxSpec {
    /// Its middle (m).
    pub center: Triple,
    /// Edges (m).
    pub size: Triple,
    /// Turned about this axis by its length (rad).
    #[serde(default)]
    pub rotation: Option<Triple>,
    /// To and fro.
    #[serde(default)]
    pub sine: Option<Sine>,
    /// Once, from here to there.
    #[serde(default)]
    pub shift: Option<Shift>,
}

/// A capsule that particles stay out of: all that is within `radius` of the way from one point to another. It may move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CapsuleSpec {
    /// In m.
    pub from: Triple,
    /// In m.
    pub to: Triple,
    /// In m.
    pub radius: f64,
    /// To and fro.
    #[serde(default)]
    pub sine: Option<Sine>,
    /// Once, from here to there.
    #[serde(default)]
    pub shift: Option<Shift>,
}

/// Bend springs that buckle: pressed, they give way as a strip does that bends into an arc, instead of pushing ever more.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BucklingSpec {
    /// Stiffness of the strip against bending (N m2).
    pub bending: f64,
    /// Its stiffness while it is pressed and still straight (N/m).
    pub compression: f64,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// A state, a line for each particle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct State {
    /// In m.
    pub positions: Vec<Triple>,
    /// In m/s; without them, all are at rest.
    #[serde(default)]
    pub velocities: Vec<Triple>,
}

impl Description {
    /// Reads TOML.
    ///
    /// # Errors
    /// It is not TOML, a key is unknown or missing, a value is of the wrong kind, or a number is not finite.
    pub fn parse(text: &str) -> Result<Self, Fault> {
        toml::from_str(text).map_err(|error| Fault::of_toml(text, &error))
    }

    /// Writes TOML that [`parse`](Self::parse) reads as the same.
    ///
    /// # Errors
    /// None that is known of.
    pub fn to_toml(&self) -> Result<String, a3_core::Error> {
        toml::to_string(self).map_err(|e| a3_core::Error::Invalid(e.to_string()))
    }

    /// The JSON Schema of scene files, by which editors complete and check them.
    #[must_use]
    pub fn schema() -> String {
        let schema = schemars::schema_for!(Self);
        serde_json::to_string_pretty(&schema).unwrap_or_default()
    }
}
