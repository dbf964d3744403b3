//! Obstacles and rigid bodies as balls, solids and triangles.

use std::f64::consts::TAU;

use a3_core::contact::{ClosedMesh, Obstacle, Shape};
use a3_core::rigid::{Body, Part};
use a3_core::{Network, Pose, Vector3};
use a3_render::{Ball, Line, STEEL_LOOK, Solid, ramp};

use super::colouring::Colouring;
use super::colours::{BODIES, INK, STEEL};
use super::vectors::{perpendicular, to_f32};
use crate::surfaces::tessellation::parts;

/// Returns the drawn radius of a sphere or a capsule, as a share of its radius: a little smaller
/// where only particles stay out of obstacles, so that the flat triangles between them stay outside
/// too, and the full radius where surfaces touch.
pub fn drawn_radius(network: &Network) -> f32 {
    if network.contact_layer().is_some() { 1.0 } else { 0.965 }
}

/// Draws the obstacles at their places at `time` (s), and returns the height of the floor (m) if
/// there is one.
pub fn draw(
    network: &Network,
    time: f64,
    balls: &mut Vec<Ball>,
    solids: &mut Vec<Solid>,
) -> Option<f32> {
    let mut floor = None;
    for obstacle in network.obstacles() {
        let pose = obstacle.at(time);
        if obstacle.shape == Shape::Floor {
            floor = Some(pose.place.position.y as f32);
        } else {
            let share = drawn_radius(network);
            let paint = Paint::plain(STEEL);
            draw_shape(&obstacle.shape, &pose, share, &paint, balls, solids);
        }
    }
    floor
}

/// Colour of a shape, or vectors whose lengths, from 0 to 1, colour its points.
pub struct Paint {
    pub color: [f32; 4],
    /// Vectors of the points; empty if the shape has a single colour.
    pub values: Vec<[f32; 3]>,
}

impl Paint {
    /// Creates the paint of a single colour.
    pub fn plain(color: [f32; 4]) -> Self {
        Self { color, values: vec![] }
    }

    /// Returns the colour of the first point.
    fn first(&self) -> [f32; 4] {
        let length = |[x, y, z]: &[f32; 3]| x.hypot(*y).hypot(*z);
        let first = self.values.first();
        first.map_or(self.color, |value| ramp(length(value)))
    }

    /// Returns the colours of the eight corners of a box, by the numbers of their points.
    fn corners(&self, points: [usize; 8]) -> [[f32; 4]; 8] {
        if self.values.is_empty() {
            return Solid::PLAIN;
        }
        points.map(|k| Solid::value(self.values[k]))
    }
}

/// Draws a shape at a place, a round one with a share of its radius. Meshes are triangles of the
/// picture and are left out.
pub fn draw_shape(
    shape: &Shape,
    pose: &Pose,
    share: f32,
    paint: &Paint,
    balls: &mut Vec<Ball>,
    solids: &mut Vec<Solid>,
) {
    let place = pose.place.position;
    let inside = |radius: f64| share * radius as f32;
    match shape {
        &Shape::Sphere { radius } => {
            balls.push(Ball {
                center: to_f32(place),
                radius: inside(radius),
                color: paint.first(),
            });
        }
        &Shape::Box { half_extents, axes } => {
            let least = half_extents.min();
            let gap = if share < 1.0 { 0.02 * least } else { 0.0 };
            let round = 0.06 * least;
            solids.push(Solid {
                center: to_f32(place),
                radius: round as f32,
                axes: [0, 1, 2]
                    .map(|k| axis(pose.outwards(axes[k]), half_extents[k] - gap - round)),
                color: paint.color,
                values: paint.corners([0, 1, 2, 3, 4, 5, 6, 7]),
            });
        }
        &Shape::Capsule { ends: [a, b], radius } => {
            let along = pose.outwards(b - a);
            let side = perpendicular(along);
            let y = along.try_normalize(0.0).unwrap_or(Vector3::y());
            solids.push(Solid {
                center: to_f32(pose.of(0.5 * (a + b)).position),
                radius: inside(radius),
                axes: [axis(side, 0.0), axis(y, 0.5 * along.norm()), axis(side.cross(&y), 0.0)],
                color: paint.color,
                values: paint.corners([0, 0, 1, 1, 0, 0, 1, 1]),
            });
        }
        Shape::Mesh(_) | Shape::Floor => {}
    }
}

/// Returns the obstacles that are meshes.
pub fn meshes(network: &Network) -> impl Iterator<Item = (&ClosedMesh, &Obstacle)> {
    let obstacles = network.obstacles().iter();
    obstacles.filter_map(|obstacle| match &obstacle.shape {
        Shape::Mesh(mesh) => Some((&**mesh, obstacle)),
        _ => None,
    })
}

/// Adds the points of meshes at their places at `time` (s), with the look of steel.
pub fn add_points(network: &Network, time: f64, points: &mut Vec<[f32; 4]>) {
    let share = f64::from(drawn_radius(network));
    for (mesh, obstacle) in meshes(network) {
        let pose = obstacle.at(time);
        let [low, high] = extent(mesh);
        let inwards = (1.0 - share) * 0.5 * (high - low).min();
        points.extend(mesh.points().iter().zip(mesh.normals()).map(|(point, normal)| {
            let [x, y, z] = to_f32(pose.of(point - normal * inwards).position);
            [x, y, z, STEEL_LOOK as f32]
        }));
    }
}

/// Returns three great circles through the poles of each sphere that turns, at their places at
/// `time` (s); none where surfaces touch, because the circles would show through a cloth on the
/// sphere.
pub fn meridians(network: &Network, time: f64) -> impl Iterator<Item = Line> {
    let share = f64::from(drawn_radius(network));
    let turning = network.obstacles().iter().filter_map(move |obstacle| {
        match (&obstacle.shape, obstacle.turn) {
            (Shape::Sphere { radius }, Some(turn)) if share < 1.0 => {
                Some((*radius, turn.axis, obstacle.at(time)))
            }
            _ => None,
        }
    });
    turning.flat_map(move |(radius, axis, pose)| great_circles(share * radius, axis, pose, INK))
}

/// Returns lines around an obstacle, by its number, in a colour: great circles of round ones, and
/// else the edges of a box around it.
pub fn outline(network: &Network, k: usize, time: f64, color: [f32; 4]) -> Vec<Line> {
    let share = f64::from(drawn_radius(network));
    let Some(obstacle) = network.obstacles().get(k) else {
        return vec![];
    };
    let pose = obstacle.at(time);
    match &obstacle.shape {
        Shape::Floor => vec![],
        Shape::Sphere { radius } => {
            great_circles(share * radius, Vector3::y(), pose, color).collect()
        }
        Shape::Capsule { ends, radius } => {
            let axis = (ends[1] - ends[0]).try_normalize(0.0);
            let axis = axis.unwrap_or(Vector3::y());
            let circles = ends.iter().flat_map(|end| {
                let place = pose.of(*end);
                great_circles(share * radius, axis, Pose { place, ..pose }, color)
            });
            circles.collect()
        }
        &Shape::Box { half_extents, axes } => {
            box_edges(Vector3::zeros(), half_extents, axes, pose, color).collect()
        }
        Shape::Mesh(mesh) => {
            let [low, high] = extent(mesh);
            let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
            box_edges(0.5 * (low + high), 0.5 * (high - low), axes, pose, color).collect()
        }
    }
}

/// Returns the least and the largest coordinates of a mesh (m).
fn extent(mesh: &ClosedMesh) -> [Vector3<f64>; 2] {
    let corners = mesh.points();
    let low = corners.iter().fold(corners[0], |low, point| low.inf(point));
    let high = corners.iter().fold(low, |high, point| high.sup(point));
    [low, high]
}

/// Returns the edges of a box around a point of a body, in a colour.
fn box_edges(
    middle: Vector3<f64>,
    half_extents: Vector3<f64>,
    axes: [Vector3<f64>; 3],
    pose: Pose,
    color: [f32; 4],
) -> impl Iterator<Item = Line> {
    let corner = move |k: usize| {
        let along = |axis: usize| if k >> axis & 1 == 1 { 1.002 } else { -1.002 };
        let arm = (0..3).map(|axis| axes[axis] * (along(axis) * half_extents[axis]));
        to_f32(pose.of(middle + arm.sum::<Vector3<f64>>()).position)
    };
    edges_of_box(corner, color)
}

/// Returns the edges of a box, whose corners are numbered by their sides along each axis, in a
/// colour.
pub fn edges_of_box(
    corner: impl Fn(usize) -> [f32; 3] + Copy,
    color: [f32; 4],
) -> impl Iterator<Item = Line> {
    (0..3).flat_map(move |axis| {
        let from = (0..8).filter(move |k| k >> axis & 1 == 0);
        from.map(move |k| Line::new(corner(k), corner(k | 1 << axis), 1.6, color))
    })
}

/// Returns three great circles through the poles of a sphere.
pub fn great_circles(
    radius: f64,
    axis: Vector3<f64>,
    pose: Pose,
    color: [f32; 4],
) -> impl Iterator<Item = Line> {
    const CORNERS: usize = 48;
    let radius = radius * 1.002;
    let side = perpendicular(axis);
    (0..3).flat_map(move |circle| {
        let (sin, cos) = (TAU / 6.0 * f64::from(circle)).sin_cos();
        let across = side * cos + axis.cross(&side) * sin;
        let corner = move |k: usize| {
            let (sin, cos) = (TAU / CORNERS as f64 * k as f64).sin_cos();
            to_f32(pose.of((axis * cos + across * sin) * radius).position)
        };
        (0..CORNERS).map(move |k| Line::new(corner(k), corner(k + 1), 1.6, color))
    })
}

/// Returns half an axis of a box, with the length in the last number.
fn axis(direction: Vector3<f64>, half: f64) -> [f32; 4] {
    let [x, y, z] = to_f32(direction);
    [x, y, z, half as f32]
}

/// Draws the bodies in the state y, in colours of their own or by values.
pub fn draw_bodies(
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
            values: points.map(|i| colouring.vector(i)).collect::<Option<_>>().unwrap_or_default(),
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
pub fn meshes_of_bodies(network: &Network) -> impl Iterator<Item = (&ClosedMesh, usize)> {
    let parts = network.bodies().iter().flat_map(first_points);
    parts.filter_map(|(part, first)| match &part.shape {
        Shape::Mesh(mesh) => Some((&**mesh, first)),
        _ => None,
    })
}
