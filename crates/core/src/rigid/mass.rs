//! Mass properties of solid shapes of uniform density.

use std::ops::AddAssign;

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::error::{Error, positive};
use crate::geometry::Shape;

/// Products of inertia, as a share of the largest moment, up to which they count as zero: the
/// principal axes are then those of the shape.
const ALIGNED_SHARE: f64 = 1e-12;

/// Mass, centre and moments of inertia of a body.
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
        if products
            .iter()
            .all(|product| *product <= ALIGNED_SHARE * largest)
        {
            return (self.inertia.diagonal(), Matrix3::identity());
        }
        let SymmetricEigen {
            eigenvectors: mut axes,
            eigenvalues,
        } = SymmetricEigen::new(self.inertia);
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
    let axis = if length > 0.0 {
        (b - a) / length
    } else {
        Vector3::y()
    };
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
