//! Surfaces of bodies.

/// Surface of the first particles of a scene. Other particles are drawn one by one, with their
/// springs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Surface {
    /// Corners of the triangles, counterclockwise as seen from outside, or from the front of a
    /// cloth.
    pub triangles: Vec<[u32; 3]>,
    /// Ends of the bodies: each body has the particles from the end of the one before up to its
    /// own. Particles inside a body are in no triangle.
    pub bodies: Vec<usize>,
}

impl Surface {
    /// Number of particles of bodies that have a surface.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.bodies.last().copied().unwrap_or(0)
    }
}
