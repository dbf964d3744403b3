//! A rectangular grid of particles: its numbering, its springs, its triangles.

use crate::error::{Error, positive};
use crate::spring::{SpringFamily, SpringKind, SpringLaw};

/// The most particles a scene may have: 2048 x 2048.
pub const MAX_PARTICLES: usize = 2048 * 2048;

/// rows x cols particles, numbered row by row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    rows: usize,
    cols: usize,
}

impl Grid {
    /// # Errors
    /// Less than 2 x 2, or more than [`MAX_PARTICLES`] in all.
    pub fn new(rows: usize, cols: usize) -> Result<Self, Error> {
        let fits = rows.checked_mul(cols).is_some_and(|n| n <= MAX_PARTICLES);
        if rows >= 2 && cols >= 2 && fits {
            Ok(Self { rows, cols })
        } else {
            Err(Error::Invalid(format!(
                "a grid has at least 2x2 and at most {MAX_PARTICLES} particles in all, such as 20x20, and not {rows}x{cols}"
            )))
        }
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of columns.
    #[must_use]
    pub fn cols(&self) -> usize {
        self.cols
    }

    /// Number of particles.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.rows * self.cols
    }

    /// The number of the particle in row i and column j.
    #[must_use]
    #[doc(alias = "indexOf")]
    pub fn index_of(&self, i: usize, j: usize) -> usize {
        debug_assert!(i < self.rows && j < self.cols);
        i * self.cols + j
    }

    /// The six families of cloth springs, at rest in a flat grid of that `spacing` (m):
    /// structural to the next particle, shear across each cell, bend to the next but one.
    ///
    /// `stiffness` (N/m) is for the three kinds in this order; each spring is damped by `damping_time` (s) times its
    /// stiffness.
    ///
    /// # Errors
    /// The spacing is not above 0, or a number is negative or not finite.
    pub fn springs(
        &self,
        spacing: f64,
        stiffness: [f64; 3],
        damping_time: f64,
    ) -> Result<Vec<SpringFamily>, Error> {
        positive("the spacing", spacing)?;
        let [structural, shear, bend] = stiffness;
        [
            (SpringKind::Structural, structural, (0, 1), false),
            (SpringKind::Structural, structural, (1, 0), false),
            (SpringKind::Shear, shear, (1, 1), false),
            (SpringKind::Shear, shear, (1, 1), true),
            (SpringKind::Bend, bend, (0, 2), false),
            (SpringKind::Bend, bend, (2, 0), false),
        ]
        .into_iter()
        .map(|(kind, k, (di, dj), leftwards)| {
            let cells = ((di * di + dj * dj) as f64).sqrt();
            let law = SpringLaw::new(k, spacing * cells, k * damping_time)?;
            Ok(self.family(kind, law, di, dj, leftwards))
        })
        .collect()
    }

    /// The springs from (i, j) to (i + di, j + dj), or to (i + di, j - dj) if `leftwards`.
    fn family(
        &self,
        kind: SpringKind,
        law: SpringLaw,
        di: usize,
        dj: usize,
        leftwards: bool,
    ) -> SpringFamily {
        let rows = self.rows.saturating_sub(di);
        let length = self.cols.saturating_sub(dj);
        let offset = if leftwards {
            di * self.cols - dj
        } else {
            di * self.cols + dj
        };
        let runs = if length == 0 || rows == 0 {
            vec![]
        } else if dj == 0 {
            std::iter::once(0..rows * self.cols).collect()
        } else {
            let first = if leftwards { dj } else { 0 };
            (0..rows)
                .map(|i| i * self.cols + first)
                .map(|start| start..start + length)
                .collect()
        };
        SpringFamily {
            kind,
            law,
            offset,
            runs,
        }
    }

    /// Two triangles a cell, wound alike, all cut along the same diagonal: smooth shading shows where it alternates.
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
