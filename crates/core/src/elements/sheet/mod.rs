//! The springs of a grid: one law for each of the six ways that they go.

pub(crate) mod kernel;

use crate::error::{Error, positive};
use crate::grid::Grid;
use crate::spring::{Spring, SpringKind, SpringLaw};

/// What the springs are for, and how many rows down and columns right they go.
pub(crate) const WAYS: [(SpringKind, usize, isize); 6] = [
    (SpringKind::Structural, 0, 1),
    (SpringKind::Structural, 1, 0),
    (SpringKind::Shear, 1, 1),
    (SpringKind::Shear, 1, -1),
    (SpringKind::Bend, 0, 2),
    (SpringKind::Bend, 2, 0),
];

/// A grid of particles and its springs: structural to the next particle, shear across each cell, bend to the next but one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sheet {
    grid: Grid,
    laws: [SpringLaw; 6],
}

impl Sheet {
    /// At rest in a flat grid of that `spacing` (m). `stiffness` (N/m) is for structural, shear and bend springs; each is
    /// damped by `damping_time` (s) times its stiffness.
    ///
    /// # Errors
    /// The spacing is not above 0, or a number is negative or not finite.
    pub fn new(
        grid: Grid,
        spacing: f64,
        stiffness: [f64; 3],
        damping_time: f64,
    ) -> Result<Self, Error> {
        positive("the spacing", spacing)?;
        let [structural, shear, bend] = stiffness;
        let mut laws = [SpringLaw::new(0.0, 0.0, 0.0)?; 6];
        for (law, (kind, rows, cols)) in laws.iter_mut().zip(WAYS) {
            let k = match kind {
                SpringKind::Structural => structural,
                SpringKind::Shear => shear,
                SpringKind::Bend => bend,
            };
            let cells = ((rows * rows) as f64 + (cols * cols) as f64).sqrt();
            *law = SpringLaw::new(k, spacing * cells, k * damping_time)?;
        }
        Ok(Self { grid, laws })
    }

    /// Where the particles are.
    #[must_use]
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// Of the springs to the right, down, down and right, down and left, two to the right, two down.
    #[must_use]
    pub fn laws(&self) -> &[SpringLaw; 6] {
        &self.laws
    }

    /// Whether any spring is.
    pub(crate) fn is_damped(&self) -> bool {
        self.laws.iter().any(|law| law.damping > 0.0)
    }

    /// With springs so many times as stiff, and so many times as damped.
    pub(crate) fn scaled(&self, stiffness: f64, damping: f64) -> Self {
        let mut sheet = *self;
        for law in &mut sheet.laws {
            law.stiffness *= stiffness;
            law.damping *= damping;
        }
        sheet
    }

    pub(crate) fn laws_mut(&mut self) -> &mut [SpringLaw; 6] {
        &mut self.laws
    }

    /// Each spring by itself, way by way, each in the order of its first end.
    pub fn springs(&self) -> impl Iterator<Item = Spring> {
        let Self { grid, laws } = *self;
        WAYS.into_iter()
            .zip(laws)
            .flat_map(move |((kind, down, right), law)| {
                (0..grid.rows().saturating_sub(down)).flat_map(move |row| {
                    let cols = grid.cols() as isize;
                    let first = (-right).max(0);
                    (first..cols.min(cols - right)).map(move |col| Spring {
                        kind,
                        i: grid.index_of(row, col as usize),
                        j: grid.index_of(row + down, (col + right) as usize),
                        law,
                    })
                })
            })
    }
}
