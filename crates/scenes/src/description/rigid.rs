//! Rigid bodies.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bodies::{Keys, SharedKeys, SkinKeys, share_keys, solids};
use super::motion::{Pin, Triple, is_default};

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
