//! Obstacles that particles stay out of.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::motion::{Shift, Sine, Triple, Turn};

/// Sphere that particles stay out of. It may move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SphereSpec {
    /// Centre (m).
    pub center: Triple,
    /// Radius (m).
    pub radius: f64,
    /// Coefficient of Coulomb friction; 0 if not given.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub friction: f64,
    /// Coefficient of restitution, from 0 to 1; 0 if not given.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub restitution: f64,
    /// Thickness (m), with which edges and triangles of bodies touch it and not only particles.
    #[serde(default)]
    pub thickness: Option<f64>,
    /// Oscillation of the sphere.
    #[serde(default)]
    pub sine: Option<Sine>,
    /// Displacement of the sphere, once.
    #[serde(default)]
    pub shift: Option<Shift>,
    /// Turn of the sphere.
    #[serde(default)]
    pub turn: Option<Turn>,
}

/// Box that particles stay out of. It may move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BoxSpec {
    /// Centre (m).
    pub center: Triple,
    /// Lengths of the edges (m).
    pub size: Triple,
    /// Rotation vector: its direction is the axis, its length the angle (rad).
    #[serde(default)]
    pub rotation: Option<Triple>,
    /// Coefficient of Coulomb friction; 0 if not given.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub friction: f64,
    /// Coefficient of restitution, from 0 to 1; 0 if not given.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub restitution: f64,
    /// Thickness (m), with which edges and triangles of bodies touch it and not only particles.
    #[serde(default)]
    pub thickness: Option<f64>,
    /// Oscillation of the box.
    #[serde(default)]
    pub sine: Option<Sine>,
    /// Displacement of the box, once.
    #[serde(default)]
    pub shift: Option<Shift>,
    /// Turn of the box.
    #[serde(default)]
    pub turn: Option<Turn>,
}

/// Capsule that particles stay out of: all points within `radius` of a line segment. It may move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CapsuleSpec {
    /// One end of the segment (m).
    pub from: Triple,
    /// Other end of the segment (m).
    pub to: Triple,
    /// Radius (m).
    pub radius: f64,
    /// Coefficient of Coulomb friction; 0 if not given.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub friction: f64,
    /// Coefficient of restitution, from 0 to 1; 0 if not given.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub restitution: f64,
    /// Thickness (m), with which edges and triangles of bodies touch it and not only particles.
    #[serde(default)]
    pub thickness: Option<f64>,
    /// Oscillation of the capsule.
    #[serde(default)]
    pub sine: Option<Sine>,
    /// Displacement of the capsule, once.
    #[serde(default)]
    pub shift: Option<Shift>,
    /// Turn of the capsule.
    #[serde(default)]
    pub turn: Option<Turn>,
}

/// Solid that particles stay out of, within a closed surface from a file of triangles. It may move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
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
    /// Coefficient of Coulomb friction; 0 if not given.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub friction: f64,
    /// Coefficient of restitution, from 0 to 1; 0 if not given.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub restitution: f64,
    /// Thickness (m), with which edges and triangles of bodies touch it and not only particles.
    #[serde(default)]
    pub thickness: Option<f64>,
    /// Oscillation of the solid.
    #[serde(default)]
    pub sine: Option<Sine>,
    /// Displacement of the solid, once.
    #[serde(default)]
    pub shift: Option<Shift>,
    /// Turn of the solid.
    #[serde(default)]
    pub turn: Option<Turn>,
}

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde calls it so; on 32 bits clippy lets it"
)]
pub(super) fn is_zero(number: &f64) -> bool {
    *number == 0.0
}
