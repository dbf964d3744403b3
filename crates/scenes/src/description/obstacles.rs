//! Obstacles that particles stay out of, and the level floor of a scene: a height, or a table.

use std::fmt;

use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, de};

use super::motion::{Shift, Sine, Triple, Turn, is_default};
use crate::fault::{beyond, within};

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
        if within(height) {
            Ok(Floor::Height(height))
        } else {
            Err(E::custom(beyond(height)))
        }
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
