//! Faces of rigid bodies, past which air streams, with the nodes of their quadrature.

use nalgebra::Vector3;

use super::body::Part;
use super::mass::{Round, round};
use crate::geometry::Shape;

/// Barycentric coordinate that a node has at two corners of a triangle, and the node's share of the
/// area, for both kinds of nodes: the quadrature of six points that is exact for polynomials of
/// degree 4 (Strang and Fix, *An Analysis of the Finite Element Method*, 1973).
const IN_TRIANGLE: [(f64, f64); 2] = [
    (0.445_948_490_915_965, 0.223_381_589_678_011),
    (0.091_576_213_509_771, 0.109_951_743_655_322),
];

/// Longest side of a flat face, over the radius of its part. Where a body spins in still air, the
/// force grows as the square of the distance from its axis: on halves of the side of a plate, its
/// torque is 0.3 % off.
const LONGEST: f64 = 1.5;

/// Longest side of a flat face with one node, over the distance over which the air varies.
const SMALL: f64 = 0.2;

/// Longest side of a face that is partly inside another part, over the radius of the body.
const SHORTEST: f64 = 0.05;

/// Distance of the point in front of a face that must be outside all other parts, over the radius
/// of the body.
const CLEARANCE: f64 = 1e-6;

/// Piece of the surface of a body, relative to its centre and along the principal axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Face {
    /// Triangle with these corners (m), anticlockwise as seen from outside.
    Flat([Vector3<f64>; 3]),
    Round(Round),
}

impl Face {
    /// Calls `visit` with each node of the quadrature, and its share of the area (m2) times the
    /// normal, which points outwards. Flat faces that are small beside `scale` (m), the distance
    /// over which the air varies, have one node.
    pub fn nodes(&self, scale: f64, visit: &mut impl FnMut(Vector3<f64>, Vector3<f64>)) {
        match self {
            Self::Flat([a, b, c]) if self.length() < SMALL * scale => {
                visit((a + b + c) / 3.0, 0.5 * (b - a).cross(&(c - a)));
            }
            Self::Flat([a, b, c]) => {
                let area = 0.5 * (b - a).cross(&(c - a));
                for (own, share) in IN_TRIANGLE {
                    let rest = own * (a + b + c);
                    for corner in [a, b, c] {
                        visit(rest + corner * (1.0 - 3.0 * own), area * share);
                    }
                }
            }
            Self::Round(round) => round.nodes(visit),
        }
    }

    /// Returns a ball that encloses the face: its middle and radius (m).
    pub fn ball(&self) -> (Vector3<f64>, f64) {
        match self {
            Self::Flat(corners) => {
                let middle = corners.iter().sum::<Vector3<f64>>() / 3.0;
                let distances = corners.map(|corner| (corner - middle).norm());
                (middle, distances.into_iter().fold(0.0, f64::max))
            }
            Self::Round(round) => round.ball(),
        }
    }

    /// Returns the length of the longest side (m).
    pub fn length(&self) -> f64 {
        match self {
            Self::Flat([a, b, c]) => (b - a).norm().max((c - b).norm()).max((a - c).norm()),
            Self::Round(round) => round.length(),
        }
    }

    /// Calls `visit` with pieces of the face whose sides are at most `longest` (m), as far as
    /// balls that enclose them are near.
    pub fn pieces(
        &self,
        longest: f64,
        is_near: &impl Fn(Vector3<f64>, f64) -> bool,
        visit: &mut impl FnMut(&Self),
    ) {
        let (middle, radius) = self.ball();
        if !is_near(middle, radius) {
            return;
        }
        if self.length() <= longest {
            visit(self);
            return;
        }
        for half in self.halves() {
            half.pieces(longest, is_near, visit);
        }
    }

    /// Returns both halves, cut across the longest side.
    fn halves(&self) -> [Self; 2] {
        match *self {
            Self::Flat(corners) => {
                let side = |k: usize| (corners[(k + 1) % 3] - corners[k]).norm();
                let first = (1..3).fold(0, |most, k| if side(k) > side(most) { k } else { most });
                let [a, b, c] = [0, 1, 2].map(|k| corners[(first + k) % 3]);
                let middle = 0.5 * (a + b);
                [[a, middle, c], [middle, b, c]].map(Self::Flat)
            }
            Self::Round(round) => round.halves().map(Self::Round),
        }
    }

    /// Adds the face to those of a body of that radius (m), in pieces as far as it is outside the
    /// other parts. Returns whether all of it is.
    fn add_outside(&self, others: &[&Part], radius: f64, faces: &mut Vec<Self>) -> bool {
        let (middle, reach) = self.ball();
        let distance = |point: Vector3<f64>| {
            let all = others.iter().map(|other| other.shape.distance(point - other.at));
            all.fold(f64::INFINITY, f64::min)
        };
        let from_middle = distance(middle);
        if from_middle < -reach {
            return false;
        }
        let is_whole = if from_middle > reach {
            true
        } else if self.length() <= SHORTEST * radius {
            let mut normal = Vector3::zeros();
            self.nodes(0.0, &mut |_, area| normal += area);
            distance(middle + normal.normalize() * (CLEARANCE * radius)) >= 0.0
        } else {
            let before = faces.len();
            let halves = self.halves();
            let are_whole = halves.map(|half| half.add_outside(others, radius, faces));
            if are_whole != [true; 2] {
                return false;
            }
            faces.truncate(before);
            true
        };
        if is_whole {
            faces.push(*self);
        }
        is_whole
    }
}

/// Lists the faces of a body of that radius (m), as far as they are outside its other parts.
pub(crate) fn faces(parts: &[Part], radius: f64) -> Vec<Face> {
    let mut faces = vec![];
    for (k, part) in parts.iter().enumerate() {
        let all = parts.iter().enumerate();
        let others: Vec<_> = all.filter(|(other, _)| *other != k).map(|(_, part)| part).collect();
        let longest = LONGEST * extent(part);
        for face in of_part(part) {
            face.pieces(longest, &|_, _| true, &mut |piece| {
                piece.add_outside(&others, radius, &mut faces);
            });
        }
    }
    faces
}

/// Returns the distance (m) of the farthest point of a part from its middle.
fn extent(part: &Part) -> f64 {
    let simplices = part.shape.simplices();
    let middle = simplices.points.iter().sum::<Vector3<f64>>() / simplices.points.len() as f64;
    let distances = simplices.points.iter().map(|point| (point - middle).norm());
    distances.fold(0.0, f64::max) + simplices.radius
}

/// Lists the faces of a part.
fn of_part(part: &Part) -> Vec<Face> {
    match &part.shape {
        Shape::Sphere { radius } => round([part.at; 2], *radius).map(Face::Round).collect(),
        Shape::Capsule { ends, radius } => {
            round(ends.map(|end| part.at + end), *radius).map(Face::Round).collect()
        }
        Shape::Box { .. } | Shape::Mesh(_) | Shape::Floor => {
            let simplices = part.shape.simplices();
            let corner = |i: u32| part.at + simplices.points[i as usize];
            let triangles = simplices.triangles.iter().map(|t| t.map(corner));
            let has_area = |[a, b, c]: &[Vector3<f64>; 3]| (b - a).cross(&(c - a)).norm() > 0.0;
            triangles.filter(has_area).map(Face::Flat).collect()
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use approx::assert_relative_eq;
    use nalgebra::Matrix3;

    use super::*;
    use crate::geometry::normals;

    /// Lists the nodes of the faces, and their areas (m2).
    fn nodes(faces: &[Face]) -> Vec<[Vector3<f64>; 2]> {
        let mut nodes = vec![];
        for face in faces {
            face.nodes(0.0, &mut |at, area| nodes.push([at, area]));
        }
        nodes
    }

    /// Returns the sum of the areas (m2), and that of the areas as seen along a direction.
    fn areas(faces: &[Face], along: Vector3<f64>) -> [f64; 2] {
        let nodes = nodes(faces);
        let sum = |size: &dyn Fn(&Vector3<f64>) -> f64| nodes.iter().map(|[_, a]| size(a)).sum();
        [sum(&|area| area.norm()), sum(&|area| 0.5 * area.dot(&along).abs())]
    }

    /// Returns the volume (m3) by the divergence theorem.
    fn volume(faces: &[Face]) -> f64 {
        let nodes = nodes(faces).into_iter();
        nodes.map(|[at, area]| at.dot(&area) / 3.0).sum()
    }

    fn part(shape: Shape, at: Vector3<f64>) -> Part {
        Part { shape, at }
    }

    #[test]
    fn round_parts_have_the_areas_of_their_formulas() {
        let (r, ends) = (0.3, [Vector3::new(0.4, -0.1, 0.2), Vector3::new(-0.2, 0.7, 0.9)]);
        let l = (ends[1] - ends[0]).norm();
        let axis = (ends[1] - ends[0]) / l;
        let [side, other] = normals(axis);
        let half = 0.5 * TAU;
        for (shape, l, along) in [
            (Shape::Sphere { radius: r }, 0.0, axis),
            (Shape::Sphere { radius: r }, 0.0, side),
            (Shape::Capsule { ends, radius: r }, l, axis),
            (Shape::Capsule { ends, radius: r }, l, side),
            (Shape::Capsule { ends, radius: r }, l, (side + other * 0.4).normalize()),
        ] {
            let faces = of_part(&part(shape, Vector3::zeros()));
            let [whole, seen] = areas(&faces, along);
            assert_relative_eq!(whole, TAU * r * (2.0 * r + l), max_relative = 1e-12);
            let expected = half * r * r + if along == axis { 0.0 } else { 2.0 * r * l };
            assert_relative_eq!(seen, expected, max_relative = 0.015);
            let closed = nodes(&faces).iter().map(|[_, a]| a).sum::<Vector3<f64>>();
            assert!(closed.norm() < 1e-12);
            let expected = half * r * r * (4.0 / 3.0 * r + l);
            assert_relative_eq!(volume(&faces), expected, max_relative = 1e-12);
            // A sphere has no lift: this matrix is a multiple of 1.
            if l == 0.0 {
                let sum = |[_, a]: &[Vector3<f64>; 2]| a * a.normalize().transpose();
                let all: Matrix3<f64> = nodes(&faces).iter().map(sum).sum();
                let one = Matrix3::identity() * (2.0 * TAU * r * r / 3.0);
                assert_relative_eq!(all, one, epsilon = 1e-12);
            }
        }
    }

    #[test]
    fn faces_between_parts_do_not_count() {
        let cube = Shape::turned_box(Vector3::new(0.5, 0.5, 0.5), Vector3::zeros()).unwrap();
        let at = |x: f64| part(cube.clone(), Vector3::x() * x);
        let long = faces(&[at(-0.5), at(0.5)], 1.2);
        assert_relative_eq!(areas(&long, Vector3::x())[0], 10.0, max_relative = 1e-12);
        assert_relative_eq!(volume(&long), 2.0, max_relative = 1e-12);
        // What is outside stays whole: five sides of two halved triangles each, of both cubes.
        assert_eq!(long.len(), 40);
        // A small part that covers the middle of a triangle hides a small part of it.
        let place = Vector3::new(0.5 / 3.0, 0.9, -0.5 / 3.0);
        let stick = Shape::turned_box(Vector3::new(0.02, 0.5, 0.02), Vector3::zeros()).unwrap();
        let [whole, _] = areas(&faces(&[at(0.0), part(stick, place)], 1.5), Vector3::y());
        assert_relative_eq!(whole, 6.0 + 4.0 * 0.04 * 0.9, max_relative = 0.005);
        // A ball that looks out of a cube by a half has a circle of its side.
        let ball = part(Shape::Sphere { radius: 0.3 }, Vector3::y() * 0.5);
        let all = faces(&[at(0.0), ball], 0.9);
        let circle = 0.5 * TAU * 0.09;
        let [whole, _] = areas(&all, Vector3::y());
        assert_relative_eq!(whole, 6.0 + circle, max_relative = 0.005);
        assert_relative_eq!(volume(&all), 1.0 + circle * 0.2, max_relative = 0.005);
    }

    #[test]
    fn pieces_have_the_area_of_the_face_and_lie_in_their_balls() {
        let ends = [Vector3::new(0.4, -0.1, 0.2), Vector3::new(-0.2, 0.7, 0.9)];
        let cube = Shape::turned_box(Vector3::new(0.5, 0.3, 0.1), Vector3::x()).unwrap();
        for shape in [cube, Shape::Capsule { ends, radius: 0.3 }] {
            let faces = of_part(&part(shape, Vector3::zeros()));
            let mut pieces = vec![];
            for face in &faces {
                face.pieces(0.1, &|_, _| true, &mut |piece| pieces.push(*piece));
            }
            let [whole, cut] = [&faces, &pieces].map(|all| areas(all, Vector3::x())[0]);
            assert_relative_eq!(whole, cut, max_relative = 1e-12);
            for face in faces.iter().chain(&pieces) {
                let (middle, radius) = face.ball();
                face.nodes(0.0, &mut |at, _| assert!((at - middle).norm() <= radius));
            }
        }
    }
}
