//! Surfaces of bodies.

/// Surface of the bodies that have one, whose particles come first in a scene. Other particles are
/// drawn one by one, with their springs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Surface {
    /// Corners of the triangles, counterclockwise as seen from outside, or from the front of a
    /// cloth.
    pub triangles: Vec<[u32; 3]>,
    /// End of the particles of each body, which begin at the end of the body before. Particles
    /// inside a body are in no triangle.
    pub bodies: Vec<usize>,
}

impl Surface {
    /// Counts the particles of bodies that have a surface.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.bodies.last().copied().unwrap_or(0)
    }
}
