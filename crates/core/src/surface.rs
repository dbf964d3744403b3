//! The skin of bodies that are drawn as a surface.

use crate::grid::Grid;

/// Triangles over the first particles of a scene; the others are drawn one by one, with their springs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Surface {
    /// Corners, wound alike: seen against the clock from outside, or from the front of a cloth.
    pub triangles: Vec<[u32; 3]>,
    /// Where the particles of each body end. Those inside a body are in no triangle.
    pub bodies: Vec<usize>,
}

impl Surface {
    /// Of a cloth.
    #[must_use]
    pub fn of_grid(grid: Grid) -> Self {
        Self {
            triangles: grid.triangles().map(|t| t.map(|i| i as u32)).collect(),
            bodies: vec![grid.particles()],
        }
    }

    /// How many particles belong to bodies that have a surface.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.bodies.last().copied().unwrap_or(0)
    }
}
