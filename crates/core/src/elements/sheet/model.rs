//! A grid of particles and its springs: one law for each of the six directions.

use std::ops::Range;
use std::sync::Arc;

use super::missing::{Masks, Missing};
use super::offsets::OFFSETS;
use crate::error::{Error, positive};
use crate::grid::Grid;
use crate::spring::{Spring, SpringKind, SpringLaw};

/// A grid of particles and its springs: structural to the next particle, shear across each cell,
/// bend to the next but one. Its particles are numbered row by row, from a first one on.
///
/// ```
/// use a3_core::{Grid, Network, Sheet};
///
/// let sheet = Sheet::new(Grid::new(3, 3)?, 0.1, [100.0, 50.0, 10.0], 0.0)?;
/// // 12 structural springs, 8 across the cells and 6 to the next but one.
/// assert_eq!(sheet.len(), 26);
/// let mut network = Network::new(vec![0.01; 9])?;
/// network.add(sheet)?;
/// # Ok::<(), a3_core::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    first: usize,
    grid: Grid,
    laws: [SpringLaw; 6],
    missing: Option<Arc<Missing>>,
}

impl Sheet {
    /// Creates a sheet at rest in a flat grid of a `spacing` (m), whose particles are the first
    /// ones. `stiffness` (N/m) is that of structural, shear and bend springs; each is damped by
    /// `damping_time` (s) times its stiffness.
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
        for (law, (kind, rows, cols)) in laws.iter_mut().zip(OFFSETS) {
            let k = match kind {
                SpringKind::Structural => structural,
                SpringKind::Shear => shear,
                SpringKind::Bend => bend,
            };
            let cells = ((rows * rows) as f64 + (cols * cols) as f64).sqrt();
            *law = SpringLaw::new(k, spacing * cells, k * damping_time)?;
        }
        Ok(Self { first: 0, grid, laws, missing: None })
    }

    /// Returns the same sheet, of the particles from `first` on.
    #[must_use]
    pub fn starting_at(self, first: usize) -> Self {
        Self { first, ..self }
    }

    /// Returns the rows and columns.
    #[must_use]
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// Returns the numbers of the sheet's particles.
    #[must_use]
    pub fn particles(&self) -> Range<usize> {
        self.first..self.first.saturating_add(self.grid.particles())
    }

    /// Returns the laws of the springs to the right, down, down and right, down and left, two to
    /// the right, two down.
    #[must_use]
    pub fn laws(&self) -> &[SpringLaw; 6] {
        &self.laws
    }

    /// Returns whether any spring is damped.
    pub(crate) fn is_damped(&self) -> bool {
        self.laws.iter().any(|law| law.damping > 0.0)
    }

    /// Returns the sheet with the stiffness and the damping multiplied by these factors.
    pub(crate) fn scaled(&self, stiffness: f64, damping: f64) -> Self {
        let mut sheet = self.clone();
        sheet.scale(stiffness, damping);
        sheet
    }

    /// Multiplies stiffness and damping.
    pub(super) fn scale(&mut self, stiffness: f64, damping: f64) {
        for law in &mut self.laws {
            law.scale(stiffness, damping);
        }
    }

    /// Returns the number of springs.
    #[must_use]
    pub fn len(&self) -> usize {
        let (rows, cols) = (self.grid.rows(), self.grid.cols());
        let of_direction = |(_, down, right): (SpringKind, usize, isize)| {
            rows.saturating_sub(down) * cols.saturating_sub(right.unsigned_abs())
        };
        let whole: usize = OFFSETS.into_iter().map(of_direction).sum();
        whole - self.lost().len()
    }

    /// Returns whether all springs are missing.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the direction and the first end of each missing spring, in order.
    fn lost(&self) -> &[(usize, usize)] {
        self.missing.as_ref().map_or(&[], |missing| missing.springs())
    }

    /// Returns the springs one by one, direction by direction, and within a direction in the order
    /// of their first ends.
    pub fn springs(&self) -> impl Iterator<Item = Spring> {
        let laws = self.laws;
        self.runs().flat_map(move |(direction, begins, further)| {
            begins.map(move |i| Spring {
                kind: OFFSETS[direction].0,
                i,
                j: i + further,
                law: laws[direction],
            })
        })
    }

    /// Returns the springs in runs without gaps, by direction and row: the direction, the
    /// consecutive first ends, and the offset of the second ends.
    pub(super) fn runs(&self) -> impl Iterator<Item = (usize, Range<usize>, usize)> {
        let (first, grid, lost) = (self.first, self.grid, self.lost());
        let rows = (0..OFFSETS.len()).flat_map(move |direction| {
            let (_, down, right) = OFFSETS[direction];
            let cols = grid.cols();
            let from = right.min(0).unsigned_abs();
            let to = cols.saturating_sub(right.max(0).unsigned_abs());
            (0..grid.rows().saturating_sub(down)).map(move |row| {
                let begins = row * cols + from..row * cols + to;
                (direction, begins, (down * cols).wrapping_add_signed(right))
            })
        });
        rows.flat_map(move |(direction, begins, further)| {
            let at = |i: usize| lost.partition_point(|lost| *lost < (direction, i));
            let gaps = &lost[at(begins.start)..at(begins.end.max(begins.start))];
            let from = std::iter::once(begins.start).chain(gaps.iter().map(|(_, i)| i + 1));
            let to = gaps.iter().map(|(_, i)| *i).chain([begins.end]);
            from.zip(to).map(move |(from, to)| (direction, first + from..first + to, further))
        })
    }

    /// Removes the springs between pairs of particles, the lower number of each first.
    pub(super) fn remove(&mut self, pairs: &[[usize; 2]]) {
        let mut lost: Vec<_> = pairs.iter().filter_map(|pair| self.between(*pair)).collect();
        lost.extend(self.lost());
        lost.sort_unstable();
        lost.dedup();
        if lost.len() > self.lost().len() {
            self.missing = Some(Arc::new(Missing::new(self.grid, lost)));
        }
    }

    /// Returns the direction and the first end of the spring between two particles.
    fn between(&self, [i, j]: [usize; 2]) -> Option<(usize, usize)> {
        let particles = self.particles();
        if !particles.contains(&i) || !particles.contains(&j) {
            return None;
        }
        let cols = self.grid.cols();
        let (i, j) = (i - self.first, j - self.first);
        let down = (j / cols).checked_sub(i / cols)?;
        let right = (j % cols) as isize - (i % cols) as isize;
        let direction = OFFSETS.iter().position(|offset| (offset.1, offset.2) == (down, right))?;
        Some((direction, i))
    }

    /// Returns the masks of a row from column `first` on, if a spring is missing in it.
    #[inline]
    pub(super) fn masks(&self, row: usize, first: usize) -> Option<Masks<'_>> {
        let numbers =
            |law: SpringLaw| [law.stiffness, law.stiffness * law.rest_length, law.damping];
        let missing = self.missing.as_ref()?;
        missing.masks(row, first, self.laws.map(numbers))
    }
}
