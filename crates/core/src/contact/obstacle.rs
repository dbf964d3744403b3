//! Obstacles: a shape on a path, with friction.

use super::shape::Shape;
use crate::error::{Error, at_least};
use crate::path::Path;

/// Body that particles stay out of, still or moving.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Obstacle {
    /// What it looks like, seen from its place on the path.
    pub shape: Shape,
    /// Where it is: the centre of a sphere or a box; of a floor, any point of its surface.
    pub path: Path,
    /// Coefficient mu of Coulomb friction; 0 is a smooth surface.
    pub friction: f64,
    /// Thickness of its surface where surfaces touch (m).
    pub thickness: f64,
}

impl Obstacle {
    /// Smooth obstacle of that shape on that path.
    #[must_use]
    pub fn smooth(shape: Shape, path: Path) -> Self {
        Self {
            shape,
            path,
            friction: 0.0,
            thickness: 0.0,
        }
    }

    /// # Errors
    /// The shape has no size, or the friction is negative; or a number is not finite.
    pub(crate) fn check(&self) -> Result<(), Error> {
        self.shape.check()?;
        at_least(0.0, "the friction of an obstacle", self.friction)?;
        at_least(0.0, "the thickness of an obstacle", self.thickness)
    }
}
