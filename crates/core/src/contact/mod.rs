//! Contact of particles with obstacles: one phase after every step.
//!
//! A particle that ends a step inside an obstacle is put on the surface, and the part of its velocity that leads inwards
//! is taken away. With friction, Coulomb's law limits what is taken of its motion along the surface, both of its
//! velocity, |dv_t| <= mu |dv_n|, and of its way since it touched the surface, |dx_t| <= mu |dx_n|: what would move less
//! than that stays where it is on the obstacle.

mod obstacle;
mod resolve;
mod shape;

pub use obstacle::Obstacle;
pub use resolve::{Contact, Statistics, Step, resolve};
pub use shape::Shape;
