//! Rigid bodies: a centre of mass that is a particle of a network, a rotation, and an angular
//! momentum (Baraff, *An Introduction to Physically Based Modeling: Rigid Body Simulation*, 1997).
//!
//! A body's state is the position x and the velocity v of its centre, the quaternion q that turns
//! its principal axes into the world, and its angular momentum L (kg m2/s) in the world:
//!
//! ```text
//! x' = v,   m v' = F,   q' = w q / 2,   L' = T,   with w = R I^-1 RT L and R = R(q / |q|).
//! ```
//!
//! Rotations read q / |q| only, so nothing projects q, and the order of a method holds. Without a
//! torque, L keeps its bits. The body carries particles that have no mass, its *points*: what acts
//! on them acts on the body.

mod body;
mod flight;
mod mass;
mod rotation;

pub(crate) use body::Moving;
pub use body::{Body, Part};
pub use mass::MassProperties;
pub use rotation::{ROTATION, Rotation};
pub(crate) use rotation::{rotation_vector, turn};
