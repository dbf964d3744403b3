//! One file an obstacle. Contact is frictionless: a particle inside is put on the surface, and the part of its velocity
//! that leads inwards is taken away.

mod capsule;
mod cuboid;
mod floor;
mod sphere;

pub use capsule::Capsule;
pub use cuboid::Cuboid;
pub use floor::Floor;
pub use sphere::Sphere;

use nalgebra::Vector3;

use crate::path::Place;

/// The nearest point of a surface (m), and the unit normal there.
struct Nearest {
    point: Vector3<f64>,
    normal: Vector3<f64>,
}

/// Puts particles that are inside on the surface. `surface` looks from the obstacle's place to a particle, and answers
/// from there, if the particle is inside.
fn push_out(
    place: &Place,
    x: &mut [f64],
    v: &mut [f64],
    surface: impl Fn(Vector3<f64>) -> Option<Nearest>,
) {
    let c = place.position;
    let n = x.len() / 3;
    for i in 0..n {
        let d = Vector3::new(x[i] - c.x, x[n + i] - c.y, x[2 * n + i] - c.z);
        let Some(Nearest { point, normal }) = surface(d) else {
            continue;
        };
        let velocity = Vector3::new(v[i], v[n + i], v[2 * n + i]) - place.velocity;
        let inwards = velocity.dot(&normal).min(0.0);
        for axis in 0..3 {
            x[axis * n + i] = c[axis] + point[axis];
            v[axis * n + i] -= inwards * normal[axis];
        }
    }
}
