//! Obstacles: a shape on a path, with friction and restitution.

use nalgebra::Vector3;

use crate::error::{Error, at_least, share};
use crate::geometry::Shape;
use crate::path::{Path, Pose, Turn};

/// Body that particles stay out of, still or moving.
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
