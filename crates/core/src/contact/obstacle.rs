//! Obstacles: a shape on a path, with friction and restitution; and the course of a particle.

use nalgebra::Vector3;

use crate::error::{Error, at_least, share};
use crate::geometry::Shape;
use crate::path::{Path, Pose, Turn};

/// Body that particles stay out of, still or moving.
///
/// ```
/// use a3_core::contact::{Obstacle, Shape};
/// use a3_core::{Path, Vector3};
///
/// let ball = Obstacle {
///     friction: 0.5,
///     ..Obstacle::smooth(Shape::Sphere { radius: 1.0 }, Path::Still(Vector3::zeros()))
/// };
/// assert_eq!(ball.depth(0.0, Vector3::new(0.0, 0.75, 0.0)), 0.25);
/// assert_eq!(ball.depth(0.0, Vector3::new(0.0, 3.0, 0.0)), -2.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// Shape in the obstacle's own frame, before it turned.
    pub shape: Shape,
    /// Position over time: of the centre of a sphere or a box; of a floor, of any point of its
    /// surface.
    pub path: Path,
    /// Rotation about its place, if it has one. Floors do not turn.
    pub turn: Option<Turn>,
    /// Coefficient mu of Coulomb friction; 0 is a smooth surface.
    pub friction: f64,
    /// Coefficient e of restitution, from 0 to 1: the speed along the normal after an impact, over
    /// that before it.
    pub restitution: f64,
    /// Thickness of its surface where surfaces touch (m).
    pub thickness: f64,
}

impl Obstacle {
    /// Creates a smooth obstacle of that shape on that path.
    #[must_use]
    pub fn smooth(shape: Shape, path: Path) -> Self {
        Self {
            shape,
            path,
            turn: None,
            friction: 0.0,
            restitution: 0.0,
            thickness: 0.0,
        }
    }

    /// Returns the place and orientation at time t (s), which determine the positions of the
    /// obstacle's points.
    #[must_use]
    pub fn at(&self, t: f64) -> Pose {
        Pose {
            place: self.path.at(t),
            orientation: self.turn.map(|turn| turn.orientation(t)),
        }
    }

    /// Returns the depth (m) of a place (m) inside at time t (s); below 0 outside.
    #[must_use]
    pub fn depth(&self, t: f64, place: Vector3<f64>) -> f64 {
        let pose = self.at(t);
        let seen = pose.inwards(place - pose.place.position);
        -self.shape.separation(seen).distance
    }

    /// Returns whether it neither moves nor turns.
    #[must_use]
    pub fn is_still(&self) -> bool {
        matches!(self.path, Path::Still(_)) && self.turn.is_none()
    }

    /// Checks the numbers of the obstacle.
    ///
    /// # Errors
    /// The shape has no size, the friction is negative, or the restitution is not from 0 to 1; or a
    /// number is not finite.
    pub(crate) fn check(&self) -> Result<(), Error> {
        self.shape.check()?;
        at_least(0.0, "the friction of an obstacle", self.friction)?;
        share("the restitution of an obstacle", self.restitution)?;
        at_least(0.0, "the thickness of an obstacle", self.thickness)
    }
}

/// Returns the velocity (m/s) of a point of an obstacle, relative to its place, in a pose.
pub(super) fn velocity(pose: &Pose, point: Vector3<f64>) -> Vector3<f64> {
    let along = pose.place.velocity;
    let turned = pose.orientation;
    turned.map_or(along, |turned| along + turned.spin.cross(&point))
}

/// Course of a particle in a step of h (s): the cubic with the positions (m) and velocities (m/s)
/// at both ends.
#[derive(Debug)]
pub(crate) struct Course {
    pub x: [Vector3<f64>; 2],
    pub v: [Vector3<f64>; 2],
    pub h: f64,
}

impl Course {
    /// Returns the position at a share s of the step (m).
    pub fn position(&self, s: f64) -> Vector3<f64> {
        let ([x0, x1], [v0, v1]) = (self.x, self.v.map(|v| v * self.h));
        let left = 1.0 - s;
        let line = x0 + (x1 - x0) * s;
        line + (v0 * left - v1 * s + (x1 - x0) * (s - left)) * (s * left)
    }

    /// Returns the velocity at a share s of the step (m/s).
    pub fn velocity(&self, s: f64) -> Vector3<f64> {
        let ([x0, x1], [v0, v1]) = (self.x, self.v);
        let left = 1.0 - s;
        let mean = (x1 - x0) / self.h;
        v0 * left + v1 * s + (mean * 2.0 - v0 - v1) * (3.0 * s * left)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_course_is_the_cubic_and_its_slope() {
        let v = |x: f64| Vector3::new(x, -2.0 * x, 0.5);
        // x(t) = t3 - 2 t2 + 3 t + 1 from t = 1 to 1.5.
        let (position, speed) = (
            |t: f64| t * t * t - 2.0 * t * t + 3.0 * t + 1.0,
            |t: f64| 3.0 * t * t - 4.0 * t + 3.0,
        );
        let slope = |x: f64| Vector3::new(x, -2.0 * x, 0.0);
        let course = Course {
            x: [1.0, 1.5].map(|t| v(position(t))),
            v: [1.0, 1.5].map(|t| slope(speed(t))),
            h: 0.5,
        };
        for s in [0.0, 0.2, 0.7, 1.0] {
            let t = 1.0 + 0.5 * s;
            assert!((course.position(s) - v(position(t))).norm() < 1e-14);
            assert!((course.velocity(s) - slope(speed(t))).norm() < 1e-13);
        }
    }
}
