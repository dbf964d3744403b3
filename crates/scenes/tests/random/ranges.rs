//! Ranges of the values of each key, which are mostly realistic.

use crate::chance::Range;

/// Places and directions (m), angles (rad), and shares.
const PLACE: Range = (-1.0, 1.0, false);
const ANGLE: Range = (-3.0, 3.0, false);
const SHARE: Range = (0.0, 1.0, false);
/// Lengths (m), masses (kg), times (s) and the like.
const LENGTH: Range = (0.05, 1.0, true);
const MASS: Range = (0.01, 10.0, true);
const STIFFNESS: Range = (0.1, 1e5, true);
const DAMPING: Range = (1e-3, 10.0, true);

/// Numbers of each key. A key that is meant in one table only is prefixed by the name of that
/// table.
pub const NUMBERS: &[(&[&str], Range)] = &[
    (&["Jelly.damping", "Cloth.damping"], (1e-5, 0.1, true)),
    (&["Shift.start", "Turn.start"], (0.0, 1.0, false)),
    (&["MeshCloth.damping", "Solid.damping"], (1e-5, 0.1, true)),
    (&["JointSpec.ball"], PLACE),
    (&["Fluid.strain"], (-2.0, 2.0, false)),
    (&["Cloth.turn", "Turn.angle"], (0.0, 1.0, false)),
    (&["Fluid.density"], (10.0, 3000.0, true)),
    (&["WindSpec.density"], (0.1, 10.0, true)),
    (&["at", "center", "from", "to", "point"], PLACE),
    (&["positions", "start"], PLACE),
    (&["floor", "height"], (-2.5, -1.0, false)),
    (&["about", "foot", "eye", "target"], PLACE),
    (&["right", "down", "direction", "normal"], PLACE),
    (&["axis", "by"], PLACE),
    (&["velocity", "velocities", "spin", "amplitude"], PLACE),
    (&["angular_momenta", "orientations"], PLACE),
    (&["rotation", "phase"], ANGLE),
    (&["friction", "restitution", "damping_ratio"], SHARE),
    (&["ahead"], SHARE),
    (&["folds", "sway"], (0.0, 0.3, false)),
    (&["radius", "size", "ball", "box", "capsule"], LENGTH),
    (&["length", "rest_length", "width", "scale"], LENGTH),
    (&["thickness"], (1e-4, 0.01, true)),
    (&["limits"], (0.1, 2.0, true)),
    (&["torque", "force", "speed"], (1e-3, 10.0, true)),
    (&["pressure"], (-100.0, 1000.0, false)),
    (&["fill"], (0.9, 1.1, true)),
    (&["rolling_friction"], (1e-4, 0.1, true)),
    (&["spacing"], (0.08, 0.3, true)),
    (&["mass", "masses"], MASS),
    (&["inertia"], (0.1, 0.19, true)),
    (&["density"], (0.1, 3000.0, true)),
    (&["stiffness", "contact_stiffness"], STIFFNESS),
    (&["bending"], (1e-7, 1e-3, true)),
    (&["compression"], (10.0, 1e5, true)),
    (&["young"], (1e2, 1e8, true)),
    (&["poisson"], (-0.5, 0.49, false)),
    (&["damping", "viscosity", "drag", "lift"], DAMPING),
    (&["drag_per_mass"], DAMPING),
    (&["strain_limit"], (1.01, 1.5, true)),
    (&["tear", "reach"], (1.05, 4.0, true)),
    (&["gravity", "force", "force_per_mass"], (-20.0, 20.0, false)),
    (&["rate", "feedback"], (0.1, 50.0, true)),
    (&["sound"], (1.0, 50.0, true)),
    (&["end", "duration"], (1.01, 2.0, true)),
    (&["until"], (1e-3, 0.5, true)),
    (&["max_step", "step"], (1e-5, 0.1, true)),
    (&["springs"], (0.1, 100.0, true)),
];

/// Numbers that make sense for hardly any key.
pub const ODD: [f64; 10] = [0.0, -0.0, -1.0, 1e-9, 1e-5, 1e3, 1e6, 1e9, -1e9, 1e13];

/// Whole numbers of each key: smallest and largest.
pub const COUNTS: &[(&[&str], usize, usize)] = &[
    (&["Cloth.grid"], 2, 5),
    (&["Jelly.grid", "Solid.grid"], 2, 3),
    (&["Chain.particles"], 2, 6),
    (&["RigidBody.pin.particles"], 0, 0),
    (&["Fluid.dimensions"], 2, 3),
    (&["particles", "particle", "rod", "rope"], 0, 1),
    (&["springs", "torn", "trail", "seed"], 0, 7),
    (&["Pin.body", "JointSpec.body", "bodies"], 0, 0),
];

/// Texts of keys that are not a choice among names.
pub const WORDS: &[(&str, &[&str])] = &[
    ("MeshCloth.file", &["solid.obj", "square.obj"]),
    ("Solid.file", &["two.msh"]),
    ("file", &["solid.obj"]),
    ("name", &["chance"]),
    ("summary", &["A scene by chance."]),
    ("solver", &["v"]),
];

/// Kinds of constraints.
const CONSTRAINTS: &[&str] = &["rod", "rope", "point", "line", "circle", "sphere"];

/// Keys that exclude one another: each table has exactly one key of its list.
pub const ONE: &[(&str, &[&str])] = &[
    ("Cloth", &["width", "spacing"]),
    ("Cloth", &["density", "mass"]),
    ("Jelly", &["density", "mass"]),
    ("RigidBody", &["density", "mass"]),
    ("Particles", &["mass", "masses"]),
    ("Solid", &["grid", "file"]),
    ("Turn", &["rate", "angle"]),
    ("WindSpec", &["force", "force_per_mass", "velocity"]),
    ("PartSpec", &["box", "ball", "capsule", "file"]),
    ("ConstraintSpec", CONSTRAINTS),
    ("JointSpec", &["body", "bodies"]),
    ("JointSpec", &["ball", "hinge", "slider", "fixed"]),
];

/// Keys of which a table has at most one.
pub const ALTERNATIVES: &[&[&str]] = &[
    &["damping", "damping_ratio"],
    &["drag", "drag_per_mass"],
    &["at", "foot"],
    &["pressure", "fill"],
    &["sine", "shift"],
    &["sine", "turn"],
    &["body", "sine"],
    &["body", "shift"],
    &["body", "turn"],
];

/// Keys that a table has if and only if it has another one.
pub const TOGETHER: &[(&str, &str, &str)] =
    &[("Solid", "size", "grid"), ("ConstraintSpec", "particle", "point line circle sphere")];

/// Keys that a table has only if it has another one.
pub const NEEDS: &[(&str, &str, &str)] = &[
    ("Solid", "scale", "file"),
    ("PartSpec", "scale", "file"),
    ("ConstraintSpec", "length", "rod rope"),
    ("ConstraintSpec", "restitution", "rope"),
    ("WindSpec", "density", "velocity"),
    ("WindSpec", "drag", "velocity"),
    ("WindSpec", "lift", "velocity"),
    ("HingeSpec", "speed", "torque"),
    ("HingeSpec", "restitution", "limits"),
    ("SliderSpec", "speed", "force"),
    ("SliderSpec", "restitution", "limits"),
    ("", "step", "solver"),
];

/// Spots of each kind of body.
pub const SPOTS: &[(&str, &[&str])] = &[
    ("Cloth", &SIDES),
    ("Jelly", &["top", "bottom", "left", "right"]),
    ("Solid", &["top", "bottom", "left", "right"]),
    ("MeshCloth", &["top", "bottom"]),
    ("Chain", &["first", "last"]),
];

/// Spots of a cloth.
#[rustfmt::skip]
const SIDES: [&str; 8] = [
    "top", "bottom", "left", "right", "top-left", "top-right", "bottom-left", "bottom-right",
];
