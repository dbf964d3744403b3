//! What the numbers of scene files are under a change of the frame: places, vectors, lengths.

/// Kind of a number or of three, and the power of the unit of length in its unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Place in the world.
    Place,
    /// Height above the ground.
    Height,
    /// Vector.
    Vector(i32),
    /// Vector along an axis about which something turns.
    Axis(i32),
    /// Rotation vector of a body or of an obstacle.
    Rotation,
    /// Place in a rigid body, relative to its origin.
    Inside,
    /// Rotation vector of a part of a rigid body.
    RotationInside,
    /// Springs: stiffness, rest length and damping after the numbers of two particles.
    Springs,
    /// Numbers that depend on no frame.
    Number(i32),
}

use Kind::{Axis, Height, Inside, Number, Place, Rotation, RotationInside, Springs, Vector};

/// Kinds of keys, some with the key of their table. All other numbers are `Number(0)`.
#[rustfmt::skip]
pub const KINDS: &[(&[&str], Kind)] = &[
    (&["parts.at"], Inside),
    (&["parts.rotation"], RotationInside),
    (&["parts.ball", "parts.box", "parts.capsule", "parts.scale"], Number(1)),
    (&["joint.ball"], Place),
    (&["at", "foot", "from", "to", "center", "positions", "point", "about"], Place),
    (&["floor", "height"], Height),
    (&["hinge.axis", "turn.axis"], Axis(0)),
    (&["hinge.torque"], Number(2)),
    (&["slider.axis"], Vector(0)),
    (&["slider.limits", "slider.speed", "slider.force"], Number(1)),
    (&["right", "down", "direction", "normal"], Vector(0)),
    (&["gravity", "velocity", "velocities", "sway", "amplitude", "by"], Vector(1)),
    (&["wind.force", "force_per_mass"], Vector(1)),
    (&["spin"], Axis(0)),
    (&["angular_momenta"], Axis(2)),
    (&["rotation"], Rotation),
    (&["springs"], Springs),
    (&["width", "spacing", "size", "thickness", "rest_length", "length", "radius"], Number(1)),
    (&["scale", "sound", "rolling_friction", "contact_gravity"], Number(1)),
    (&["viscosity", "inertia"], Number(2)),
    (&["bending"], Number(3)),
    (&["pressure", "young"], Number(-1)),
    (&["cloth.density", "mesh.density"], Number(-2)),
    (&["density"], Number(-3)),
];

/// Returns the kind of a key of a table, which is itself under a key.
pub fn kind(table: &str, key: &str) -> Kind {
    let own = format!("{table}.{key}");
    let find = |name: &str| {
        let found = KINDS.iter().find(|(keys, _)| keys.contains(&name));
        found.map(|(_, kind)| *kind)
    };
    find(&own).or_else(|| find(key)).unwrap_or(Number(0))
}
