//! Rigid bodies: a centre of mass that is a particle of a network, a rotation, and an angular
//! momentum (Baraff, *An Introduction to Physically Based Modeling: Rigid Body Simulation*, 1997).
//!
//! A body's state is the position x and the velocity v of its centre, the quaternion q that rotates
//! its principal axes into the world frame, and its angular momentum L (kg m2/s) in the world
//! frame:
//!
//! ```text
//! x' = v,   m v' = F,   q' = w q / 2,   L' = T,   with w = R I^-1 RT L and R = R(q / |q|).
//! ```
//!
//! Rotations depend on q / |q| only, so q is never normalised, and a method keeps its order.
//! Without torque, L is conserved exactly. The particles at the body's *points* have no mass:
//! forces on them act on the body.

mod body;
mod faces;
mod flight;
mod mass;
mod rotation;

pub use body::Body;
pub(crate) use body::Driven;
pub(crate) use body::Moving;
pub use body::Part;
pub use body::{Drive, Motor};
pub(crate) use faces::{Face, faces};
pub use mass::MassProperties;
pub use rotation::{ROTATION, Rotation};
pub(crate) use rotation::{rotation_vector, turn};
