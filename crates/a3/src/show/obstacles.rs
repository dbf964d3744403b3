//! Obstacles as balls and solids.

use a3_core::contact::Shape;
use a3_core::{Network, Vector3};
use a3_render::{Ball, Solid};

use super::colours::STEEL;
use super::vectors::{perpendicular, to_f32};

/// Drawn radius of a sphere or a capsule, as a share of its radius.
pub const DRAWN_RADIUS: f32 = 0.965;

/// Draws the obstacles where they are at `time` (s), and returns the height of the floor (m) if
/// there is one.
pub fn draw(
    network: &Network,
    time: f64,
    balls: &mut Vec<Ball>,
    solids: &mut Vec<Solid>,
) -> Option<f32> {
    // Obstacles are drawn a little smaller than they are, so that the flat triangles between the
    // particles on them stay outside.
    let mut floor = None;
    let inside = |radius: f64| DRAWN_RADIUS * radius as f32;
    for obstacle in network.obstacles() {
        let place = obstacle.path.at(time).position;
        match &obstacle.shape {
            &Shape::Sphere { radius } => balls.push(Ball {
                center: to_f32(place),
                radius: inside(radius),
                color: STEEL,
            }),
            &Shape::Box { half_extents, axes } => {
                let least = half_extents.min();
                let (gap, round) = (0.02 * least, 0.06 * least);
                solids.push(Solid {
                    center: to_f32(place),
                    radius: round as f32,
                    axes: [0, 1, 2].map(|k| axis(axes[k], half_extents[k] - gap - round)),
                    color: STEEL,
                });
            }
            &Shape::Capsule {
                ends: [a, b],
                radius,
            } => {
                let (along, side) = (b - a, perpendicular(b - a));
                let y = along.try_normalize(0.0).unwrap_or(Vector3::y());
                solids.push(Solid {
                    center: to_f32(place + 0.5 * (a + b)),
                    radius: inside(radius),
                    axes: [
                        axis(side, 0.0),
                        axis(y, 0.5 * along.norm()),
                        axis(side.cross(&y), 0.0),
                    ],
                    color: STEEL,
                });
            }
            Shape::Mesh(_) => {}
            Shape::Floor => floor = Some(place.y as f32),
        }
    }
    floor
}

/// Half axis of a solid: its direction and its length.
fn axis(direction: Vector3<f64>, half: f64) -> [f32; 4] {
    let [x, y, z] = to_f32(direction);
    [x, y, z, half as f32]
}
