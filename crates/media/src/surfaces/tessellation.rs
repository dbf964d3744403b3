//! Rigid bodies and obstacles as triangles.

use std::f64::consts::{PI, TAU};

use a3_core::contact::Shape;
use a3_core::rigid::{Body, Part};
use a3_core::{Network, Pose, Vector3};

/// Number of meridians of a round shape.
const MERIDIANS: u32 = 24;
/// Number of parallels of a round shape, from pole to pole.
const PARALLELS: u32 = 12;

/// Points of a shape, relative to its centre (m), and the corners of its triangles, anticlockwise
/// as seen from outside. Sides of a box share no points, so that its edges stay sharp.
pub struct Tessellation {
    pub points: Vec<Vector3<f64>>,
    pub triangles: Vec<[u32; 3]>,
}

impl Tessellation {
    /// Tessellates a shape at a place.
    pub fn at(shape: &Shape, pose: &Pose) -> Self {
        let mut placed = Self::of(shape);
        for point in &mut placed.points {
            *point = pose.of(*point).position;
        }
        placed
    }

    fn of(shape: &Shape) -> Self {
        match shape {
            Shape::Sphere { radius } => capsule([Vector3::zeros(); 2], *radius),
            Shape::Capsule { ends, radius } => capsule(*ends, *radius),
            Shape::Mesh(mesh) => {
                Self { points: mesh.points().to_vec(), triangles: mesh.triangles().to_vec() }
            }
            Shape::Box { .. } | Shape::Floor => {
                let simplices = shape.simplices();
                let corners = simplices.triangles.iter().flatten();
                let points: Vec<_> = corners.map(|i| simplices.points[*i as usize]).collect();
                let count = points.len() as u32 / 3;
                Self {
                    points,
                    triangles: (0..count).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
                }
            }
        }
    }
}

/// Tessellates a capsule, the points within a radius (m) of a line segment: parallels around its
/// axis, half of them at either end.
fn capsule([low, high]: [Vector3<f64>; 2], radius: f64) -> Tessellation {
    let axis = (high - low).try_normalize(0.0).unwrap_or(Vector3::y());
    let side = axis.cross(&if axis.x.abs() < 0.5 { Vector3::x() } else { Vector3::z() });
    let side = side.normalize();
    let other = axis.cross(&side);
    let mut points = vec![];
    let rows = PARALLELS + 2;
    for row in 0..rows {
        // There are two equators, one at each end.
        let (end, step) = if row < rows / 2 { (low, row) } else { (high, row - 1) };
        let (up, out) = (-PI / 2.0 + PI * f64::from(step) / f64::from(PARALLELS)).sin_cos();
        for k in 0..MERIDIANS {
            let (sin, cos) = (TAU * f64::from(k) / f64::from(MERIDIANS)).sin_cos();
            points.push(end + (axis * up + (side * cos + other * sin) * out) * radius);
        }
    }
    let mut triangles = vec![];
    for row in 0..rows - 1 {
        for k in 0..MERIDIANS {
            let next = (k + 1) % MERIDIANS;
            let [a, b] = [k, next].map(|k| row * MERIDIANS + k);
            let [c, d] = [a, b].map(|i| i + MERIDIANS);
            triangles.extend([[a, b, d], [a, d, c]]);
        }
    }
    Tessellation { points, triangles }
}

/// Returns the corners of the triangles of all bodies, whose points are numbered from `first` on.
pub fn triangles(network: &Network, first: u32) -> Vec<[u32; 3]> {
    let mut next = first;
    let mut all = vec![];
    for part in network.bodies().iter().flat_map(Body::parts) {
        let Tessellation { points, triangles } = Tessellation::of(&part.shape);
        all.extend(triangles.iter().map(|t| t.map(|i| next + i)));
        next += points.len() as u32;
    }
    all
}

/// Returns the number of points of all bodies.
pub fn count(network: &Network) -> usize {
    let parts = network.bodies().iter().flat_map(Body::parts);
    parts.map(|part| Tessellation::of(&part.shape).points.len()).sum()
}

/// Returns the points of all bodies in the state y (m).
pub fn points(network: &Network, y: &[f64]) -> Vec<Vector3<f64>> {
    placed(network, y).flat_map(|(_, part)| part.points).collect()
}

/// Returns each part of each body, placed as in the state y, with the body's number.
pub fn placed<'a>(
    network: &'a Network,
    y: &'a [f64],
) -> impl Iterator<Item = (usize, Tessellation)> + 'a {
    parts(network, y).map(|(k, part, pose)| (k, Tessellation::at(&part.shape, &pose)))
}

/// Returns each part of each body, with the body's number and the place of the part in the state y.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the volume within triangles, which is negative if they are inside out.
    fn volume(shape: &Shape) -> f64 {
        let Tessellation { points, triangles } = Tessellation::of(shape);
        let of = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| points[i as usize]);
            a.dot(&b.cross(&c)) / 6.0
        };
        triangles.iter().map(of).sum()
    }

    #[test]
    fn tessellations_enclose_their_shapes() {
        let ball = volume(&Shape::Sphere { radius: 1.0 });
        assert!((ball / (4.0 / 3.0 * PI) - 1.0).abs() < 0.03, "{ball}");
        let ends = [Vector3::new(0.3, 0.0, 0.0), Vector3::new(0.3, 2.0, 1.0)];
        let capsule = volume(&Shape::Capsule { ends, radius: 0.5 });
        let exact = PI * 0.25 * 5.0_f64.sqrt() + 4.0 / 3.0 * PI / 8.0;
        assert!((capsule / exact - 1.0).abs() < 0.03, "{capsule} {exact}");
        let half = Vector3::new(1.0, 2.0, 0.5);
        let cuboid = Shape::turned_box(half, Vector3::new(0.1, 0.2, 0.3)).unwrap();
        assert!((volume(&cuboid) - 8.0).abs() < 1e-12);
    }
}
