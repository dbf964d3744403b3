//! Mass properties of solid shapes of uniform density, and pieces of cylinders and balls with the
//! nodes of their quadrature.

use std::f64::consts::TAU;
use std::ops::AddAssign;

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::error::{Error, positive};
use crate::geometry::{Shape, normals};

/// Products of inertia, as a share of the largest moment, up to which they count as zero: the
/// principal axes are then those of the shape.
const ALIGNED_SHARE: f64 = 1e-12;

/// Mass, centre and moments of inertia of a body.
///
/// ```
/// use a3_core::contact::Shape;
/// use a3_core::rigid::MassProperties;
///
/// let ball = MassProperties::of(&Shape::Sphere { radius: 0.5 }, 1000.0)?;
/// // 4/3 pi r^3 rho, and 2/5 m r^2 about any axis.
/// assert!((ball.mass - 523.6).abs() < 0.1);
/// assert!((ball.inertia[(0, 0)] - 0.4 * ball.mass * 0.25).abs() < 1e-9);
/// # Ok::<(), a3_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MassProperties {
    /// Mass (kg).
    pub mass: f64,
    /// Centre of mass (m).
    pub center: Vector3<f64>,
    /// Inertia about the centre of mass (kg m2).
    pub inertia: Matrix3<f64>,
}

impl MassProperties {
    /// Returns the properties of a solid shape of that density (kg/m3).
    ///
    /// # Errors
    /// The shape is a floor or has no size, or the density is not a finite number above 0.
    pub fn of(shape: &Shape, density: f64) -> Result<Self, Error> {
        positive("the density", density)?;
        shape.check()?;
        let pi = std::f64::consts::PI;
        let mut own = match shape {
            Shape::Sphere { radius: r } => {
                let mass = 4.0 / 3.0 * pi * r.powi(3);
                Self {
                    mass,
                    center: Vector3::zeros(),
                    inertia: Matrix3::identity() * (0.4 * mass * r * r),
                }
            }
            Shape::Box { half_extents, axes } => {
                let mass = 8.0 * half_extents.product();
                let squares = half_extents.component_mul(half_extents);
                let along = squares.map(|square| mass / 3.0 * (squares.sum() - square));
                let axes = Matrix3::from_columns(axes);
                Self {
                    mass,
                    center: Vector3::zeros(),
                    inertia: axes * Matrix3::from_diagonal(&along) * axes.transpose(),
                }
            }
            Shape::Capsule { ends, radius } => capsule(*ends, *radius),
            Shape::Mesh(mesh) => of_triangles(mesh.points(), mesh.triangles()),
            Shape::Floor => {
                return Err(Error::Invalid("a floor has no mass".into()));
            }
        };
        own.mass *= density;
        own.inertia *= density;
        Ok(own)
    }

    /// Returns the properties of the same body, moved by a vector (m).
    #[must_use]
    pub fn moved(mut self, by: Vector3<f64>) -> Self {
        self.center += by;
        self
    }

    /// Returns the principal moments of inertia (kg m2), and the rotation matrix from the principal
    /// axes.
    #[must_use]
    pub fn principal(&self) -> (Vector3<f64>, Matrix3<f64>) {
        let largest = self.inertia.diagonal().max();
        let products = [(0, 1), (0, 2), (1, 2)].map(|at| self.inertia[at].abs());
        if products.iter().all(|product| *product <= ALIGNED_SHARE * largest) {
            return (self.inertia.diagonal(), Matrix3::identity());
        }
        let SymmetricEigen { eigenvectors: mut axes, eigenvalues } =
            SymmetricEigen::new(self.inertia);
        if axes.determinant() < 0.0 {
            axes.column_mut(2).neg_mut();
        }
        (eigenvalues, axes)
    }
}

/// Combines two bodies.
impl AddAssign for MassProperties {
    fn add_assign(&mut self, other: Self) {
        let mass = self.mass + other.mass;
        if mass > 0.0 {
            let apart = other.center - self.center;
            let reduced = self.mass * other.mass / mass;
            let across = Matrix3::identity() * apart.norm_squared() - apart * apart.transpose();
            self.inertia += other.inertia + across * reduced;
            self.center += apart * (other.mass / mass);
            self.mass = mass;
        }
    }
}

/// Returns the mass properties of a cylinder with two hemispheres, of density 1.
fn capsule([a, b]: [Vector3<f64>; 2], r: f64) -> MassProperties {
    let pi = std::f64::consts::PI;
    let length = (b - a).norm();
    let (rod, ball) = (pi * r * r * length, 4.0 / 3.0 * pi * r.powi(3));
    // The centre of a hemisphere is 3/8 r from that of the sphere.
    let half = 0.5 * length;
    let across = rod * (r * r / 4.0 + length * length / 12.0)
        + ball * (0.4 * r * r + half * half + 0.75 * half * r);
    let along = rod * r * r / 2.0 + ball * 0.4 * r * r;
    let axis = if length > 0.0 { (b - a) / length } else { Vector3::y() };
    let outer = axis * axis.transpose();
    MassProperties {
        mass: rod + ball,
        center: (a + b) * 0.5,
        inertia: outer * along + (Matrix3::identity() - outer) * across,
    }
}

/// Returns the mass properties of the solid enclosed by a closed surface of triangles, of density
/// 1. They are sums of exact integrals over signed tetrahedra.
fn of_triangles(points: &[Vector3<f64>], triangles: &[[u32; 3]]) -> MassProperties {
    // Relative to one of the points, so that no digits are lost far from the origin.
    let origin = points[0];
    let (mut mass, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
    for corners in triangles {
        let [a, b, c] = corners.map(|i| points[i as usize] - origin);
        let volume = a.dot(&b.cross(&c)) / 6.0;
        let sum = a + b + c;
        mass += volume;
        first += sum * (volume / 4.0);
        let squares = a * a.transpose() + b * b.transpose() + c * c.transpose();
        second += (squares + sum * sum.transpose()) * (volume / 20.0);
    }
    let center = first / mass;
    let about_center = second - center * center.transpose() * mass;
    MassProperties {
        mass,
        center: origin + center,
        inertia: Matrix3::identity() * about_center.trace() - about_center,
    }
}

/// Places between 0 and 1, and shares of the length: the Gauss quadrature of order 6.
const NODES: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// Number of faces around the axis of a round part.
const AROUND: usize = 8;

/// Piece of a cylinder or of a ball, whose area is its height times its angle times the radius.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Round {
    /// Point on the axis at height 0 (m); of a ball, its middle.
    middle: Vector3<f64>,
    /// Unit vectors along the axis, and across it at the angles 0 and 90 degrees.
    axes: [Vector3<f64>; 3],
    radius: f64,
    /// Whether it is a piece of a ball.
    is_ball: bool,
    /// From where to where it reaches along the axis (m).
    heights: [f64; 2],
    /// From where to where it reaches around the axis (rad).
    angles: [f64; 2],
}

impl Round {
    /// Calls `visit` with each node of the quadrature, and its share of the area (m2) times the
    /// normal, which points outwards.
    pub fn nodes(&self, visit: &mut impl FnMut(Vector3<f64>, Vector3<f64>)) {
        let ([low, high], [from, to]) = (self.heights, self.angles);
        let area = self.radius * (high - low) * (to - from);
        for (along, share) in NODES {
            for (around, part) in NODES {
                let (height, angle) = (low + along * (high - low), from + around * (to - from));
                let (point, normal) = self.point(height, angle);
                visit(point, normal * (area * share * part));
            }
        }
    }

    /// Returns a ball that encloses the piece: its middle and radius (m).
    pub fn ball(&self) -> (Vector3<f64>, f64) {
        let [height, angle] = [self.heights, self.angles].map(|[a, b]| 0.5 * (a + b));
        let [along, around] = self.sides();
        (self.point(height, angle).0, along + 0.5 * around)
    }

    /// Returns the length of the longest side (m).
    pub fn length(&self) -> f64 {
        let [along, around] = self.sides();
        along.max(around)
    }

    /// Returns both halves, cut across the longest side.
    pub fn halves(self) -> [Self; 2] {
        let [along, around] = self.sides();
        let halves = |[a, b]: [f64; 2]| [[a, 0.5 * (a + b)], [0.5 * (a + b), b]];
        if along > around {
            halves(self.heights).map(|heights| Self { heights, ..self })
        } else {
            halves(self.angles).map(|angles| Self { angles, ..self })
        }
    }

    /// Returns the point at a height (m) and an angle (rad), and the normal there.
    fn point(&self, height: f64, angle: f64) -> (Vector3<f64>, Vector3<f64>) {
        let [axis, side, other] = self.axes;
        let outwards = side * libm::cos(angle) + other * libm::sin(angle);
        if !self.is_ball {
            return (self.middle + axis * height + outwards * self.radius, outwards);
        }
        let normal = axis * (height / self.radius) + outwards * (self.across(height) / self.radius);
        (self.middle + normal * self.radius, normal)
    }

    /// Returns the distance from the axis at a height (m).
    fn across(&self, height: f64) -> f64 {
        if self.is_ball {
            (self.radius * self.radius - height * height).max(0.0).sqrt()
        } else {
            self.radius
        }
    }

    /// Returns the lengths along and around the axis (m).
    fn sides(&self) -> [f64; 2] {
        let [low, high] = self.heights;
        let along = if self.is_ball {
            let angle = |height: f64| libm::atan2(height, self.across(height));
            self.radius * (angle(high) - angle(low))
        } else {
            high - low
        };
        let widest = self.across(low).max(self.across(high));
        [along, widest * (self.angles[1] - self.angles[0])]
    }
}

/// Lists the faces of a capsule between the middles of its ends, or of a sphere.
pub(super) fn round([first, last]: [Vector3<f64>; 2], radius: f64) -> impl Iterator<Item = Round> {
    let length = (last - first).norm();
    let axis = if length > 0.0 { (last - first) / length } else { Vector3::y() };
    let [side, other] = normals(axis);
    let half = 0.5 * length;
    let pieces = [
        (first, true, [-radius, 0.0]),
        (first, false, [0.0, half]),
        (first, false, [half, length]),
        (last, true, [0.0, radius]),
    ];
    let pieces = pieces.into_iter().filter(|(_, _, [low, high])| low < high);
    let around = move |(middle, is_ball, heights)| {
        let angle = |k: usize| TAU * k as f64 / AROUND as f64;
        (0..AROUND).map(move |k| Round {
            middle,
            axes: [axis, side, other],
            radius,
            is_ball,
            heights,
            angles: [angle(k), angle(k + 1)],
        })
    };
    pieces.flat_map(around)
}
