//! The springs that are missing from a sheet, because they broke.

use super::offsets::OFFSETS;
use crate::grid::Grid;
use crate::rows::{PAD, stride};

/// Springs of a grid that are missing, and masks of the rows in which they are.
#[derive(Debug, PartialEq)]
pub(super) struct Missing {
    /// Direction and first end of each spring, in order.
    springs: Vec<(usize, usize)>,
    /// Start of the masks of each row, if springs are missing in it.
    rows: Vec<Option<usize>>,
    /// A column for each of these rows and each direction: 1 where a spring starts, 0 elsewhere.
    masks: Vec<f64>,
    stride: usize,
}

/// The masks of some columns of a row, and the numbers k, k r and c of each direction.
#[derive(Clone, Copy)]
pub(super) struct Masks<'a> {
    pub numbers: [[f64; 3]; OFFSETS.len()],
    columns: &'a [f64],
    stride: usize,
}

impl<'a> Masks<'a> {
    /// Returns the mask of a direction, with the padding on its right.
    pub fn column(self, direction: usize) -> &'a [f64] {
        &self.columns[direction * self.stride..][..self.stride]
    }
}

impl Missing {
    /// Creates the list of springs of these directions and first ends, in order.
    pub fn new(grid: Grid, springs: Vec<(usize, usize)>) -> Self {
        let (cols, stride) = (grid.cols(), stride(grid.cols()));
        let (mut rows, mut masks) = (vec![None; grid.rows()], vec![]);
        for &(direction, first) in &springs {
            let (row, col) = (first / cols, first % cols);
            let start = *rows[row].get_or_insert_with(|| {
                let start = masks.len();
                for (_, down, right) in OFFSETS {
                    let ends = |col: usize| {
                        row + down < grid.rows()
                            && col.checked_add_signed(right).is_some_and(|col| col < cols)
                    };
                    masks.extend((0..stride).map(|k| {
                        let begins = k >= PAD && k < PAD + cols && ends(k - PAD);
                        f64::from(u8::from(begins))
                    }));
                }
                start
            });
            masks[start + direction * stride + PAD + col] = 0.0;
        }
        // Room for vectors that start at the last column.
        masks.resize(masks.len() + stride, 0.0);
        Self { springs, rows, masks, stride }
    }

    /// Returns the direction and the first end of each spring, in order.
    pub fn springs(&self) -> &[(usize, usize)] {
        &self.springs
    }

    /// Returns the masks of a row from column `first` on, if a spring is missing in it.
    pub fn masks(
        &self,
        row: usize,
        first: usize,
        numbers: [[f64; 3]; OFFSETS.len()],
    ) -> Option<Masks<'_>> {
        let start = self.rows[row]?;
        Some(Masks { numbers, columns: &self.masks[start + PAD + first..], stride: self.stride })
    }
}
