//! Rigid bodies as balls, solids and triangles.

use a3_core::contact::{ClosedMesh, Shape};
use a3_core::rigid::{Body, Part};
use a3_core::{Network, Vector3};
use a3_render::{Ball, Line, Solid};

use super::colouring::Colouring;
use super::colours::{BODIES, INK};
use super::obstacles::{Paint, draw_shape, great_circles};
use crate::surfaces::tessellation::parts;

/// Draws the bodies in the state y, in colours of their own or by values.
pub fn draw(
    network: &Network,
    y: &[f64],
    colouring: &Colouring,
    balls: &mut Vec<Ball>,
    solids: &mut Vec<Solid>,
    lines: &mut Vec<Line>,
) {
    let firsts = network.bodies().iter().flat_map(first_points);
    for ((k, part, pose), (_, first)) in parts(network, y).zip(firsts) {
        let points = first..first + part.shape.simplices().points.len();
        let paint = Paint {
            color: BODIES[k % BODIES.len()],
            // Values count only if each point has one.
            values: points
                .map(|i| colouring.vector(i))
                .collect::<Option<_>>()
                .unwrap_or_default(),
        };
        draw_shape(&part.shape, &pose, 1.0, &paint, balls, solids);
        if let Shape::Sphere { radius } = part.shape {
            lines.extend(great_circles(radius, Vector3::y(), pose, INK));
        }
    }
}

/// Returns the parts of a body, each with the number of the particle that is its first point.
fn first_points(body: &Body) -> impl Iterator<Item = (&Part, usize)> {
    let mut next = body.points().start;
    body.parts().iter().map(move |part| {
        let first = next;
        next += part.shape.simplices().points.len();
        (part, first)
    })
}

/// Returns the parts that are meshes, each with the number of the particle that is its first point.
pub fn meshes(network: &Network) -> impl Iterator<Item = (&ClosedMesh, usize)> {
    let parts = network.bodies().iter().flat_map(first_points);
    parts.filter_map(|(part, first)| match &part.shape {
        Shape::Mesh(mesh) => Some((&**mesh, first)),
        _ => None,
    })
}
