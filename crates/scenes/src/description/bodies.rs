//! Bodies: cloths, jellies, meshes, solids, chains, single particles and rigid bodies; and their
//! springs, the wind and the swing.

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::motion::{Pin, Shift, Sine, Triple, Turn, is_default};
use crate::material;

/// Keys of the skin of a body, which say how its surface touches others.
#[derive(Clone, Copy, Default)]
pub(crate) struct SkinKeys {
    pub thickness: Option<f64>,
    pub contact_stiffness: Option<f64>,
    pub friction: f64,
    pub restitution: f64,
}

/// Keys that bodies of several kinds share, to be changed: `None` where a kind lacks one.
#[derive(Default)]
pub(crate) struct SharedKeys<'a> {
    pub pin: Option<&'a mut Vec<Pin>>,
    /// Friction and restitution.
    pub contact: Option<[&'a mut f64; 2]>,
    /// Stiffness of springs by their kinds.
    pub stiffness: Option<&'a mut [f64]>,
    pub damping: Option<&'a mut Option<f64>>,
    pub damping_ratio: Option<&'a mut Option<f64>>,
    pub strain_limit: Option<&'a mut Option<f64>>,
    pub tension_only: Option<&'a mut bool>,
    pub buckling: Option<&'a mut Option<BucklingSpec>>,
}

/// Body of any kind, by the keys that it shares with others. A fluid has none of them.
pub(crate) trait Keys {
    fn skin(&self) -> SkinKeys {
        SkinKeys::default()
    }

    fn pins(&self) -> &[Pin] {
        &[]
    }

    fn shared(&mut self) -> SharedKeys<'_> {
        SharedKeys::default()
    }
}

/// Implements `Keys` for a body that has `pin`, the keys of a skin, and those that are listed.
macro_rules! share_keys {
    ($body:ident $(, $key:ident)*) => {
        impl Keys for $body {
            fn skin(&self) -> SkinKeys {
                SkinKeys {
                    thickness: self.thickness,
                    contact_stiffness: self.contact_stiffness,
                    friction: self.friction,
                    restitution: self.restitution,
                }
            }

            fn pins(&self) -> &[Pin] {
                &self.pin
            }

            fn shared(&mut self) -> SharedKeys<'_> {
                SharedKeys {
                    pin: Some(&mut self.pin),
                    contact: Some([&mut self.friction, &mut self.restitution]),
                    $($key: Some(&mut self.$key),)*
                    ..SharedKeys::default()
                }
            }
        }
    };
}

/// Writes bodies with their own keys, and then those that all have: a skin and pins. After `with`
/// come the names of own keys that bodies of other kinds have too. Bodies are not indented: the
/// lines of their docs are those of the schema.
macro_rules! bodies {
    ($(
        $(#[$about:meta])*
        pub struct $body:ident { $($own:tt)* }
        $(#[$about_pins:meta])*
        with pin $(, $key:ident)*
    )*) => {$(
    #[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
    #[serde(deny_unknown_fields)]
    $(#[$about])*
    pub struct $body {
        $($own)*
        /// Distance up to which its surface repels others where surfaces touch (m).
        #[serde(default)]
        pub thickness: Option<f64>,
        #[doc = "Stiffness of its surface where surfaces touch (N/m); if not given, that of its springs, or"]
        #[doc = "more if its mass needs that."]
        #[serde(default)]
        pub contact_stiffness: Option<f64>,
        /// Coefficient of Coulomb friction where surfaces touch; 0 if not given.
        #[serde(default, skip_serializing_if = "is_default")]
        pub friction: f64,
        /// Coefficient of restitution where surfaces touch; 0 if not given.
        #[serde(default, skip_serializing_if = "is_default")]
        pub restitution: f64,
        $(#[$about_pins])*
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        pub pin: Vec<Pin>,
    }

    share_keys!($body $(, $key)*);
    )*};
}
/// Returns the schema of the name of a fabric.
fn fabrics(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "string", "enum": material::names(true) })
}

/// Returns the schema of the name of a solid.
fn solids(_: &mut SchemaGenerator) -> Schema {
    json_schema!({ "type": "string", "enum": material::names(false) })
}

/// Says in a schema that a body needs either some keys or a material.
fn or_material(schema: &mut Schema) {
    let Some(Value::Array(required)) = schema.get_mut("required") else {
        return;
    };
    let of_material = |key: &Value| key.as_str().is_some_and(|key| material::KEYS.contains(&key));
    let (given, rest): (Vec<_>, Vec<_>) = required.drain(..).partition(of_material);
    *required = rest;
    let either = json!([{ "required": given }, { "required": ["material"] }]);
    schema.insert("anyOf".into(), either);
}

/// First-order system of one particle whose velocity is its position turned by a right angle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Circle {
    /// Initial position (m).
    pub start: Triple,
}

bodies! {

/// Rectangular cloth: rows x columns of particles at equal spacing, numbered row by row.
#[schemars(transform = or_material)]
pub struct Cloth {
    /// Numbers of rows and columns, each at least 2.
    pub grid: [usize; 2],
    /// Width (m), which is the same for every grid. An alternative is `spacing`.
    pub width: Option<f64>,
    /// Distance between neighbouring particles (m). An alternative is `width`.
    pub spacing: Option<f64>,
    /// Material: a fabric by its name, which gives the keys that are not there.
    #[schemars(schema_with = "fabrics")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Mass per area (kg/m2), in equal shares for all particles. An alternative is `mass`.
    pub density: Option<f64>,
    /// Mass of each particle (kg). An alternative is `density`.
    pub mass: Option<f64>,
    /// Stiffness of structural, shear and bend springs (N/m).
    pub stiffness: [f64; 3],
    /// Damping over stiffness of every spring (s). An alternative is `damping_ratio`.
    pub damping: Option<f64>,
    /// Damping over the critical damping of a particle on a structural spring, which is the same
    /// for every grid. An alternative is `damping`.
    pub damping_ratio: Option<f64>,
    /// Largest length over rest length of structural and shear springs, above 1, such as 1.1: after
    /// each step, longer ones are shortened. If it is not given, there is no limit.
    pub strain_limit: Option<f64>,
    /// Law of bend springs that buckle; under tension they have the stiffness given above.
    pub buckling: Option<BucklingSpec>,
    /// Position of the middle of the first row (m). An alternative is `foot`.
    pub at: Option<Triple>,
    /// Position of the middle of the last row (m). An alternative is `at`.
    pub foot: Option<Triple>,
    /// Direction along the first row; [1, 0, 0] if not given.
    pub right: Option<Triple>,
    /// Direction from row to row, perpendicular to `right`; [0, -1, 0] if not given.
    pub down: Option<Triple>,
    /// Number of folds in which the cloth is gathered.
    #[serde(default)]
    pub folds: f64,
    /// Largest angle by which the rows turn to either side in the folds (rad).
    #[serde(default)]
    pub turn: f64,
    /// Velocity (m/s).
    pub velocity: Option<Triple>,
    /// Velocity of the last row relative to the first (m/s), with the rows between in proportion.
    pub sway: Option<Triple>,
}
/// Pins of this body.
with pin, stiffness, damping, damping_ratio, strain_limit, buckling

/// Box of jelly: a lattice of particles, joined along edges, across faces and across cells.
#[schemars(transform = or_material)]
pub struct Jelly {
    /// Numbers of particles along x, y and z, each at least 2.
    pub grid: [usize; 3],
    /// Lengths of the edges (m).
    pub size: Triple,
    /// Material: a solid by its name, which gives the keys that are not there.
    #[schemars(schema_with = "solids")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Mass per volume (kg/m3). An alternative is `mass`.
    pub density: Option<f64>,
    /// Mass of each particle (kg). An alternative is `density`.
    pub mass: Option<f64>,
    /// Stiffness of structural, shear and bend springs (N/m).
    pub stiffness: [f64; 3],
    /// Damping over stiffness of every spring (s). An alternative is `damping_ratio`.
    pub damping: Option<f64>,
    /// Damping over the critical damping of a particle on a structural spring. An alternative is
    /// `damping`.
    pub damping_ratio: Option<f64>,
    /// Largest length over rest length of structural and shear springs, above 1, such as 1.1: after
    /// each step, longer ones are shortened. If it is not given, there is no limit.
    pub strain_limit: Option<f64>,
    /// Centre (m).
    pub at: Triple,
    /// Rotation vector: its direction is the axis, its length the angle (rad).
    pub rotation: Option<Triple>,
    /// Velocity (m/s).
    pub velocity: Option<Triple>,
}
/// Pins of this body.
with pin, stiffness, damping, damping_ratio, strain_limit

/// Cloth from a file of triangles: particles at their corners, structural springs on their edges,
/// bend springs across these.
#[schemars(transform = or_material)]
pub struct MeshCloth {
    /// A file (.obj, .gltf, .glb, .stl, .ply) in the scene's folder or in one below it.
    pub file: String,
    /// Unit of length of the file (m); 1 if not given.
    pub scale: Option<f64>,
    /// Position of the file's origin (m).
    pub at: Option<Triple>,
    /// Rotation vector: its direction is the axis, its length the angle (rad).
    pub rotation: Option<Triple>,
    /// Material: a fabric by its name, which gives the keys that are not there.
    #[schemars(schema_with = "fabrics")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Mass per area (kg/m2): each particle has a third of the mass of its triangles.
    pub density: f64,
    /// Stiffness of structural and bend springs (N/m).
    pub stiffness: [f64; 2],
    /// Damping over stiffness of every spring (s). An alternative is `damping_ratio`.
    pub damping: Option<f64>,
    /// Damping over the critical damping of a particle of mean mass on a structural spring. An
    /// alternative is `damping`.
    pub damping_ratio: Option<f64>,
    /// Whether its springs only pull, and hang slack if they are shorter than their rest length.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tension_only: bool,
    /// Largest length over rest length of structural springs, above 1, such as 1.1: after each
    /// step, longer ones are shortened. If it is not given, there is no limit.
    pub strain_limit: Option<f64>,
    /// Pressure above that outside in a closed mesh (Pa). An alternative is `fill`.
    pub pressure: Option<f64>,
    /// Amount of air at constant temperature in a closed mesh, over the amount that fills the mesh
    /// of the file at the pressure outside, 101325 Pa. An alternative is `pressure`.
    pub fill: Option<f64>,
    /// Velocity (m/s).
    pub velocity: Option<Triple>,
}
/// Pins of this body. Its `top` and `bottom` are the particles as high as the highest and the
/// lowest one, to a hundredth of the body's height.
with pin, stiffness, damping, damping_ratio, strain_limit, tension_only

/// Elastic solid of tetrahedra: a box, or the mesh of a file.
#[schemars(transform = or_material)]
pub struct Solid {
    /// Numbers of particles of a box along x, y and z, each at least 2. An alternative is `file`.
    pub grid: Option<[usize; 3]>,
    /// Lengths of the edges of a box (m).
    pub size: Option<Triple>,
    /// A file of tetrahedra in the scene file's folder or in one below it: .msh of Gmsh, or .ele of
    /// `TetGen`, whose .node is beside it. An alternative is `grid`.
    pub file: Option<String>,
    /// Unit of length of the file (m); 1 if not given.
    pub scale: Option<f64>,
    /// Material: a solid by its name, which gives the keys that are not there.
    #[schemars(schema_with = "solids")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Mass per volume (kg/m3): each particle has a quarter of the mass of its tetrahedra.
    pub density: f64,
    /// Young's modulus (Pa).
    pub young: f64,
    /// Poisson's ratio, above -1 and below 0.5.
    pub poisson: f64,
    /// Energy: `neo-hookean` if not given, or `st-venant-kirchhoff`.
    #[serde(default)]
    pub model: SolidModel,
    /// Viscosity over stiffness (s); 0 if not given.
    #[serde(default)]
    pub damping: f64,
    /// Centre of a box, or position of the file's origin (m).
    pub at: Triple,
    /// Rotation vector: its direction is the axis, its length the angle (rad).
    pub rotation: Option<Triple>,
    /// Velocity (m/s).
    pub velocity: Option<Triple>,
}
/// Pins of this body. `top`, `bottom`, `left` and `right` of a solid from a file are the
/// particles that are farthest there, to a hundredth of its extent.
with pin

/// Straight row of particles joined by springs.
pub struct Chain {
    /// Number of particles, at least 2.
    pub particles: usize,
    /// Position of the first particle (m).
    pub from: Triple,
    /// Position of the last particle (m).
    pub to: Triple,
    /// Mass of each particle (kg).
    pub mass: f64,
    /// Stiffness of each spring (N/m).
    #[serde(default)]
    pub stiffness: f64,
    /// Whether the particles are joined by rods instead of springs.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub rigid: bool,
    /// Rest length of each spring (m); if not given, its initial length.
    pub rest_length: Option<f64>,
    /// Damping of each spring (N s/m).
    #[serde(default)]
    pub damping: f64,
    /// Whether its springs only pull, and hang slack if they are shorter than their rest length.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tension_only: bool,
    /// Law of buckling bend springs that hold the chain straight, each over two of its links.
    pub buckling: Option<BucklingSpec>,
    /// Velocity (m/s).
    pub velocity: Option<Triple>,
}
/// Pins of this body.
with pin, tension_only, buckling

/// Single particles, with springs between them.
pub struct Particles {
    /// Positions (m).
    pub positions: Vec<Triple>,
    /// Velocities (m/s); if not given, all particles are at rest.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub velocities: Vec<Triple>,
    /// Mass of each particle (kg), if all are the same. An alternative is `masses`.
    pub mass: Option<f64>,
    /// Masses of the particles (kg). An alternative is `mass`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub masses: Vec<f64>,
    /// Springs: [i, j, stiffness (N/m), rest length (m), damping (N s/m)], with the particles
    /// numbered from 0 among these.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub springs: Vec<SpringSpec>,
    /// Whether its springs only pull, and hang slack if they are shorter than their rest length.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tension_only: bool,
}
/// Pins of this body.
with pin, tension_only

}

/// Energy of a solid.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SolidModel {
    /// Stable neo-Hookean energy, by which a tetrahedron that is inside out turns back.
    #[default]
    NeoHookean,
    /// Energy after Saint Venant and Kirchhoff, for moderate strains.
    StVenantKirchhoff,
}

/// Spring: [i, j, stiffness (N/m), rest length (m), damping (N s/m)].
pub type SpringSpec = (usize, usize, f64, f64, f64);

/// Law of bend springs that buckle: under compression they give way like a strip that bends into an
/// arc, instead of pushing back ever harder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BucklingSpec {
    /// Bending stiffness of the strip (N m2).
    pub bending: f64,
    /// Stiffness under compression while the strip is still straight (N/m).
    pub compression: f64,
}

/// Wind, in gusts that are repeatable by their seed. It pushes each particle by `force` or by
/// `force_per_mass`, or it is air that streams with a `velocity` past the triangles of surfaces.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct WindSpec {
    /// Whether the wind blows from the beginning.
    #[serde(skip_serializing_if = "is_default")]
    pub on: bool,
    /// Seed of the gusts.
    pub seed: u64,
    /// Whether the wind has no gusts.
    #[serde(skip_serializing_if = "is_default")]
    pub steady: bool,
    /// Mean force on each particle (N).
    pub force: Option<Triple>,
    /// Mean force on each particle over the mean mass of a particle (m/s2).
    pub force_per_mass: Option<Triple>,
    /// Mean velocity of the air (m/s), which pushes triangles along its flow and across it.
    pub velocity: Option<Triple>,
    /// Density of the air (kg/m3), for a wind with a `velocity`; 1.2 if not given.
    pub density: Option<f64>,
    /// Drag coefficient of triangles in the air; 1.2 if not given.
    pub drag: Option<f64>,
    /// Lift coefficient of triangles in the air; 0.6 if not given.
    pub lift: Option<f64>,
    /// Time by which the gusts and the motion of the region run ahead of the run (s).
    #[serde(skip_serializing_if = "is_default")]
    pub ahead: f64,
    /// Region in which it blows, as that of a fan; everywhere if not given.
    pub region: Option<RegionSpec>,
}

/// Ellipsoid in which a wind blows: as it says at the centre, and fading towards the surface. A
/// region that turns turns the wind with it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionSpec {
    /// Its centre (m).
    pub at: Triple,
    /// Radius across the wind (m).
    pub radius: f64,
    /// Radius along the mean wind (m); if not given, the same.
    #[serde(default)]
    pub length: Option<f64>,
    /// Oscillation.
    #[serde(default)]
    pub sine: Option<Sine>,
    /// Displacement.
    #[serde(default)]
    pub shift: Option<Shift>,
    /// Turn.
    #[serde(default)]
    pub turn: Option<Turn>,
}

/// Swing of all pins together: `amplitude sin(rate t)`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SwingSpec {
    /// Amplitude (m).
    pub amplitude: Triple,
    /// Angular frequency (rad/s).
    pub rate: f64,
}

/// Rigid body of one or several parts.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RigidBody {
    /// Parts of which the body is made, seen from its origin. Where parts overlap, mass counts
    /// twice.
    pub parts: Vec<PartSpec>,
    /// Material: a solid by its name, which gives the density, unless that or the mass is there.
    #[schemars(schema_with = "solids")]
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// Mass per volume (kg/m3). An alternative is `mass`.
    pub density: Option<f64>,
    /// Mass of the body (kg). An alternative is `density`.
    pub mass: Option<f64>,
    /// Moments of inertia about the axes of the body through its centre of mass (kg m2), in place
    /// of those of its parts.
    pub inertia: Option<Triple>,
    /// Position of the origin (m); [0, 0, 0] if not given.
    pub at: Option<Triple>,
    /// Rotation vector about the origin: its direction is the axis, its length the angle (rad).
    pub rotation: Option<Triple>,
    /// Velocity of the centre of mass (m/s).
    pub velocity: Option<Triple>,
    /// Angular velocity (rad/s), along the axis about which it turns.
    pub spin: Option<Triple>,
    /// Distance up to which its surface repels others (m); a fiftieth of its smallest part if not
    /// given.
    #[serde(default)]
    pub thickness: Option<f64>,
    /// Stiffness of its surface where surfaces touch (N/m); if not given, what its mass needs.
    #[serde(default)]
    pub contact_stiffness: Option<f64>,
    /// Coefficient of Coulomb friction; 0 if not given.
    #[serde(default, skip_serializing_if = "is_default")]
    pub friction: f64,
    /// Coefficient of rolling friction (m): the largest torque that resists its turn where it
    /// touches, over the force along the normal; 0 if not given.
    #[serde(default, skip_serializing_if = "is_default")]
    pub rolling_friction: f64,
    /// Coefficient of restitution, from 0 to 1; 0 if not given.
    #[serde(default, skip_serializing_if = "is_default")]
    pub restitution: f64,
    /// Pins of this body: only of its particle 0, the centre of mass, about which it still turns.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub pin: Vec<Pin>,
}

share_keys!(RigidBody);

/// Part of a rigid body: one of a box, a ball, a capsule and a mesh.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PartSpec {
    /// Lengths of the edges of a box (m).
    #[serde(rename = "box")]
    pub cuboid: Option<Triple>,
    /// Radius of a ball (m).
    pub ball: Option<f64>,
    /// Length of the axis of a capsule, along y, and its radius (m).
    pub capsule: Option<[f64; 2]>,
    /// A file (.obj, .gltf, .glb, .stl, .ply) in the scene's folder or in one below it. The
    /// triangles at each edge form pairs with the same winding order.
    pub file: Option<String>,
    /// Unit of length of the file (m); 1 if not given.
    pub scale: Option<f64>,
    /// Position of its centre, or of the file's origin (m); [0, 0, 0] if not given.
    pub at: Option<Triple>,
    /// Rotation vector: its direction is the axis, its length the angle (rad).
    pub rotation: Option<Triple>,
}
