//! Rectangular grid of particles: its numbering and its triangles.

use crate::error::Error;

/// Largest number of particles of a scene: 2048 x 2048.
pub const MAX_PARTICLES: usize = 2048 * 2048;

/// Grid of rows x cols particles, numbered row by row.
///
/// ```
/// let grid = a3_core::Grid::new(3, 4)?;
/// assert_eq!((grid.particles(), grid.index_of(2, 1)), (12, 9));
/// assert_eq!(grid.triangles().count(), 12);
/// assert!(a3_core::Grid::new(1, 4).is_err());
/// # Ok::<(), a3_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    rows: usize,
    cols: usize,
}

impl Grid {
    /// Creates a grid of `rows` x `cols` particles.
    ///
    /// # Errors
    /// There are fewer than 2 rows or columns, or more than [`MAX_PARTICLES`] particles in all.
    pub fn new(rows: usize, cols: usize) -> Result<Self, Error> {
        let fits = rows.checked_mul(cols).is_some_and(|n| n <= MAX_PARTICLES);
        if rows >= 2 && cols >= 2 && fits {
            Ok(Self { rows, cols })
        } else {
            Err(Error::Invalid(format!(
                "a grid has at least 2x2 and at most {MAX_PARTICLES} particles in all, such as 20x20, not {rows}x{cols}"
            )))
        }
    }

    /// Returns the number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Returns the number of columns.
    #[must_use]
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Returns the number of particles.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.rows * self.cols
    }

    /// Returns the index of the particle in row i and column j, both counted from 0.
    #[must_use]
    #[doc(alias = "indexOf")]
    pub fn index_of(&self, i: usize, j: usize) -> usize {
        debug_assert!(i < self.rows && j < self.cols);
        i * self.cols + j
    }

    /// Returns the triangles of the grid as indices of particles: two for each cell, all in the
    /// same winding order. Every cell is cut along the same diagonal, because smooth shading makes
    /// alternating diagonals visible.
    pub fn triangles(&self) -> impl Iterator<Item = [usize; 3]> {
        let grid = *self;
        (0..grid.rows - 1).flat_map(move |i| {
            (0..grid.cols - 1).flat_map(move |j| {
                let [a, b] = [grid.index_of(i, j), grid.index_of(i, j + 1)];
                let [c, d] = [grid.index_of(i + 1, j), grid.index_of(i + 1, j + 1)];
                [[a, c, b], [b, c, d]]
            })
        })
    }
}
