//! Faces of rigid bodies, past which air streams.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::part::Part;
use crate::geometry::{Shape, normals};

/// Heights above the middle of a round end, over its radius, and shares of its area: the nodes and
/// weights of the Gauss quadrature of order 6.
const BANDS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Number of faces around the axis of a round part.
const AROUND: usize = 16;

/// Number of faces along a capsule, between its ends.
const ALONG: usize = 4;

/// Distance of the point in front of a face that must be outside all other parts, over the radius
/// of the body.
const CLEARANCE: f64 = 1e-6;

/// Longest side of a flat face, over the radius of a body of several parts: longer faces are split,
/// so that a small part hides little more than it covers.
const LONGEST: f64 = 0.5;

/// Piece of the surface of a body, relative to its centre and along the principal axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Face {
    pub middle: Vector3<f64>,
    /// Area (m2) times the normal, which points outwards.
    pub area: Vector3<f64>,
}

/// Lists the faces of a body of that radius (m). A face whose middle is inside another part is left
/// out as a whole.
pub(super) fn faces(parts: &[Part], radius: f64) -> Vec<Face> {
    let longest = if parts.len() > 1 {
        LONGEST * radius
    } else {
        f64::INFINITY
    };
    let of_part = |(k, part): (usize, &Part)| {
        let at = part.at;
        let faces = of_shape(&part.shape, longest).into_iter();
        let placed = faces.map(move |face| Face {
            middle: at + face.middle,
            ..face
        });
        placed.filter(move |face| {
            let front = face.middle + face.area.normalize() * (CLEARANCE * radius);
            let mut others = parts.iter().enumerate().filter(|(other, _)| *other != k);
            others.all(|(_, other)| other.shape.distance(front - other.at) >= 0.0)
        })
    };
    parts.iter().enumerate().flat_map(of_part).collect()
}

/// Lists the faces of a shape. Sides of flat ones are at most `longest` (m).
fn of_shape(shape: &Shape, longest: f64) -> Vec<Face> {
    match shape {
        Shape::Sphere { radius } => round([Vector3::zeros(); 2], *radius),
        Shape::Capsule { ends, radius } => round(*ends, *radius),
        Shape::Box { .. } | Shape::Mesh(_) | Shape::Floor => {
            let simplices = shape.simplices();
            let corners = |t: &[u32; 3]| t.map(|i| simplices.points[i as usize]);
            let mut faces = vec![];
            for triangle in simplices.triangles.iter().map(corners) {
                split(triangle, longest, &mut faces);
            }
            faces
        }
    }
}

/// Adds a triangle to the faces, in quarters while a side is longer than `longest` (m).
fn split([a, b, c]: [Vector3<f64>; 3], longest: f64, faces: &mut Vec<Face>) {
    if [b - a, c - b, a - c]
        .iter()
        .any(|side| side.norm() > longest)
    {
        let [d, e, f] = [[b, c], [c, a], [a, b]].map(|[i, j]| 0.5 * (i + j));
        for quarter in [[a, f, e], [f, b, d], [e, d, c], [d, e, f]] {
            split(quarter, longest, faces);
        }
        return;
    }
    let area = 0.5 * (b - a).cross(&(c - a));
    if area != Vector3::zeros() {
        let middle = (a + b + c) / 3.0;
        faces.push(Face { middle, area });
    }
}

/// Lists the faces of a capsule between the middles of its ends, or of a sphere.
fn round([first, last]: [Vector3<f64>; 2], radius: f64) -> Vec<Face> {
    let length = (last - first).norm();
    let axis = if length > 0.0 {
        (last - first) / length
    } else {
        Vector3::y()
    };
    let [side, other] = normals(axis);
    let mut faces = vec![];
    for k in 0..AROUND {
        let angle = TAU * (k as f64 + 0.5) / AROUND as f64;
        let outwards = side * libm::cos(angle) + other * libm::sin(angle);
        let mut add = |middle: Vector3<f64>, normal: Vector3<f64>, size: f64| {
            faces.push(Face {
                middle: middle + normal * radius,
                area: normal * (size * radius * TAU / AROUND as f64),
            });
        };
        for (height, share) in BANDS {
            let across = outwards * (1.0 - height * height).sqrt();
            add(first, across - axis * height, share * radius);
            add(last, across + axis * height, share * radius);
        }
        for piece in (0..ALONG).filter(|_| length > 0.0) {
            let share = (piece as f64 + 0.5) / ALONG as f64;
            let middle = first + (last - first) * share;
            add(middle, outwards, length / ALONG as f64);
        }
    }
    faces
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use nalgebra::Matrix3;

    use super::*;

    /// Returns the sum of the areas (m2), and that of the areas as seen along a direction.
    fn areas(faces: &[Face], along: Vector3<f64>) -> [f64; 2] {
        let sum = |size: &dyn Fn(&Face) -> f64| faces.iter().map(size).sum();
        [
            sum(&|face| face.area.norm()),
            sum(&|face| 0.5 * face.area.dot(&along).abs()),
        ]
    }

    /// Returns the volume (m3) by the divergence theorem.
    fn volume(faces: &[Face]) -> f64 {
        faces.iter().map(|f| f.middle.dot(&f.area) / 3.0).sum()
    }

    #[test]
    fn round_parts_have_the_areas_of_their_formulas() {
        let (r, ends) = (
            0.3,
            [Vector3::new(0.4, -0.1, 0.2), Vector3::new(-0.2, 0.7, 0.9)],
        );
        let l = (ends[1] - ends[0]).norm();
        let axis = (ends[1] - ends[0]) / l;
        let [side, other] = normals(axis);
        let half = 0.5 * TAU;
        for (shape, l, along) in [
            (Shape::Sphere { radius: r }, 0.0, axis),
            (Shape::Sphere { radius: r }, 0.0, side),
            (Shape::Capsule { ends, radius: r }, l, axis),
            (Shape::Capsule { ends, radius: r }, l, side),
            (
                Shape::Capsule { ends, radius: r },
                l,
                (side + other * 0.4).normalize(),
            ),
        ] {
            let faces = of_shape(&shape, f64::INFINITY);
            let [whole, seen] = areas(&faces, along);
            assert_relative_eq!(whole, TAU * r * (2.0 * r + l), max_relative = 1e-12);
            let expected = half * r * r + if along == axis { 0.0 } else { 2.0 * r * l };
            assert_relative_eq!(seen, expected, max_relative = 0.015);
            let closed = faces.iter().map(|face| face.area).sum::<Vector3<f64>>();
            assert!(closed.norm() < 1e-12);
            let expected = half * r * r * (4.0 / 3.0 * r + l);
            assert_relative_eq!(volume(&faces), expected, max_relative = 1e-12);
            // A sphere has no lift: this matrix is a multiple of 1.
            if l == 0.0 {
                let sum = |f: &Face| f.area * f.area.normalize().transpose();
                let all: Matrix3<f64> = faces.iter().map(sum).sum();
                let one = Matrix3::identity() * (2.0 * TAU * r * r / 3.0);
                assert_relative_eq!(all, one, epsilon = 1e-12);
            }
        }
    }

    #[test]
    fn faces_between_parts_do_not_count() {
        let cube = Shape::turned_box(Vector3::new(0.5, 0.5, 0.5), Vector3::zeros()).unwrap();
        let at = |x: f64| Part {
            shape: cube.clone(),
            at: Vector3::x() * x,
        };
        let long = faces(&[at(-0.5), at(0.5)], 1.2);
        assert_relative_eq!(areas(&long, Vector3::x())[0], 10.0, max_relative = 1e-12);
        assert_relative_eq!(volume(&long), 2.0, max_relative = 1e-12);
        assert_eq!(faces(&[at(0.0)], 0.9).len(), 12);
        // A small part that covers the middle of a triangle hides a small part of it.
        let stick = Part {
            shape: Shape::turned_box(Vector3::new(0.02, 0.5, 0.02), Vector3::zeros()).unwrap(),
            at: Vector3::new(0.5 / 3.0, 0.9, -0.5 / 3.0),
        };
        let [whole, _] = areas(&faces(&[at(0.0), stick], 1.5), Vector3::y());
        assert_relative_eq!(whole, 6.0 + 4.0 * 0.04 * 0.9, max_relative = 0.03);
    }
}
