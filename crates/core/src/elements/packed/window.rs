//! Window over the particles: those of a panel and those that their springs reach. It moves on from
//! panel to panel, and stays in the cache.

use std::ops::Range;

use super::blocks::Numbers;
use super::order::{Order, TILE};
use super::places::{Columns, add, copy, copy_rows};
use crate::threads;

/// x, v, dx and dv of the particles in the window, and the sums on them.
#[derive(Debug, Default)]
pub(super) struct Window {
    /// For runs, in three columns.
    pub columns: [Columns; 5],
    /// For blocks, three numbers side by side.
    pub rows: [Vec<Numbers>; 5],
    /// Number of particles at the end of the window that stay when it moves on.
    stays: usize,
}

impl Window {
    /// Empties the window.
    pub fn clear(&mut self) {
        self.stays = 0;
    }

    /// Moves the window on, so that it starts at the particle `start`: copies the rows of n x 3
    /// matrices that are new in it, and sets the new sums to 0.
    pub fn take(&mut self, order: &Order, start: usize, fields: &[Option<&[f64]>; 4]) {
        let (size, stays) = (order.window(), self.stays);
        let n = order.particles.len();
        let new = n.min(start + stays)..n.min(start + size);
        let places = order.places(new.clone());
        // The sums come after the fields, and have no source.
        let sources = fields.iter().map(|field| field.map(Some));
        for (k, source) in sources.chain([Some(None)]).enumerate() {
            let Some(source) = source else { continue };
            if !order.runs.places.is_empty() {
                let columns = self.columns[k].of_length(size);
                for (axis, column) in columns.chunks_exact_mut(size).enumerate() {
                    column.copy_within(size - stays.., 0);
                    let (taken, beyond) = column[stays..].split_at_mut(new.len());
                    match source {
                        Some(from) => copy(from, axis, places, taken),
                        None => taken.fill(0.0),
                    }
                    // Springs without stiffness go on beyond the last particle.
                    beyond.fill(0.0);
                }
            }
            if order.blocks.len() > 0 {
                let rows = &mut self.rows[k];
                rows.resize(size, Numbers::default());
                rows.copy_within(size - stays.., 0);
                let taken = &mut rows[stays..][..new.len()];
                match source {
                    Some(from) => copy_rows(from, places, taken),
                    None => taken.fill(Numbers::default()),
                }
            }
        }
        self.stays = size - order.panel * TILE;
    }

    /// Adds the sums on some particles of the window, which starts at the number `start`, to
    /// columns that begin at a row: first the sums of runs, then those of blocks.
    pub fn give(
        &self,
        order: &Order,
        start: usize,
        of: Range<usize>,
        (f, row): (&mut threads::Columns<3>, usize),
    ) {
        let [.., columns] = &self.columns;
        let [.., rows] = &self.rows;
        let places = order.places(of.clone());
        let of = of.start - start..of.end - start;
        for (axis, f) in f.iter_mut().enumerate() {
            if !columns.get().is_empty() {
                let column = &columns.get()[axis * order.window()..][of.clone()];
                add(f, row, places, column.iter().copied());
            }
            if !rows.is_empty() {
                let rows = &rows[of.clone()];
                add(f, row, places, rows.iter().map(|row| row.0[axis]));
            }
        }
    }
}
