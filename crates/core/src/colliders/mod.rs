//! One file an obstacle. Contact is frictionless: a particle inside is put on the surface, and the part of its velocity
//! that leads inwards is taken away.

mod floor;
mod sphere;

pub use floor::Floor;
pub use sphere::Sphere;
