//! Rigid bodies as balls, solids and triangles.

use a3_core::contact::{ClosedMesh, Shape};
use a3_core::rigid::Part;
use a3_core::{Network, Pose, Vector3};
use a3_render::{Ball, Line, Solid};

use super::colours::BODIES;
use super::obstacles::{draw_shape, great_circles};

/// Each part of each body, with the body's number and where the part is in the state y.
pub fn parts<'a>(
    network: &'a Network,
    y: &'a [f64],
) -> impl Iterator<Item = (usize, &'a Part, Pose)> {
    (0..network.bodies().len()).flat_map(move |k| {
        let pose = network.pose(k, y);
        let parts = network.bodies()[k].parts().iter();
        parts.map(move |part| {
            let place = pose.of(part.at);
            (k, part, Pose { place, ..pose })
        })
    })
}

/// Draws the bodies as they are in the state y.
pub fn draw(
    network: &Network,
    y: &[f64],
    balls: &mut Vec<Ball>,
    solids: &mut Vec<Solid>,
    lines: &mut Vec<Line>,
) {
    for (k, part, pose) in parts(network, y) {
        draw_shape(
            &part.shape,
            &pose,
            1.0,
            BODIES[k % BODIES.len()],
            balls,
            solids,
        );
        if let Shape::Sphere { radius } = part.shape {
            lines.extend(great_circles(radius, Vector3::y(), pose));
        }
    }
}

/// Parts that are meshes, with the numbers of the particles that are their first points.
pub fn meshes(network: &Network) -> impl Iterator<Item = (&ClosedMesh, usize)> {
    network.bodies().iter().flat_map(|body| {
        let mut next = body.points().start;
        body.parts().iter().filter_map(move |part| {
            let first = next;
            next += part.shape.simplices().points.len();
            match &part.shape {
                Shape::Mesh(mesh) => Some((&**mesh, first)),
                _ => None,
            }
        })
    })
}
