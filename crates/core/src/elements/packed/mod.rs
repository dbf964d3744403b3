//! Many single springs, evaluated 64 at a time, which the compiler turns into vectors.
//!
//! Springs between consecutive particles form runs, for which positions are stored in columns. The
//! others form blocks, for which a particle's three numbers lie side by side, so that each end of a
//! spring is one load, and its force one store. Springs are sorted by tiles of particles, and a
//! window moves over the tiles, so that its numbers stay in the cache. The forces on each
//! particle are summed in that order, whatever the number of threads: a thread has a band of
//! particles, and evaluates all springs that reach it.

mod blocks;
mod laws;
mod order;

use std::ops::Range;

use super::force::At;
use crate::columns::columns_mut;
use crate::coupling::Matrix;
use crate::scratch::Scratch;
use crate::spring::Spring;
use crate::threads::{Columns, split_off, threads};
use crate::vectors::Arch;
use laws::Quantity;
use order::TileWindow;
use order::{Order, TILE};

/// Least number of springs for which packing pays.
const MIN_SPRINGS: usize = 1024;

/// Time of springs one by one, over the time of the same springs packed (docs/performance.md).
pub(super) const SPEED: f64 = 2.0;

/// Many single springs, in runs and in blocks.
#[derive(Debug)]
pub(crate) struct Packed {
    len: usize,
    order: Order,
    is_damped: bool,
    /// A window for each band of particles.
    windows: Scratch<Vec<TileWindow>>,
}

/// A quantity, and the n x 3 matrices that it depends on: x, v, dx and dv, or some of these.
#[derive(Clone, Copy)]
struct Task<'a> {
    quantity: Quantity,
    fields: [Option<&'a [f64]>; 4],
}

impl Packed {
    /// Packs springs; `None` if there are too few.
    pub fn new(springs: &[Spring]) -> Option<Self> {
        (springs.len() >= MIN_SPRINGS).then(|| Self {
            len: springs.len(),
            order: Order::of(springs),
            is_damped: springs.iter().any(|spring| spring.law.damping > 0.0),
            windows: Scratch::default(),
        })
    }

    /// Returns the number of springs.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Adds the forces to f.
    pub fn add_forces(&self, at: &At, f: &mut [f64]) {
        let v = self.is_damped.then_some(at.v);
        self.add(Quantity::Forces, [Some(at.x), v, None, None], f);
    }

    /// Adds the differential of the forces for dx and dv to df.
    pub fn add_differential(&self, at: &At, [dx, dv]: [&[f64]; 2], df: &mut [f64]) {
        let [v, dv] = [at.v, dv].map(|speeds| self.is_damped.then_some(speeds));
        let fields = [Some(at.x), v, Some(dx), dv];
        self.add(Quantity::Differential, fields, df);
    }

    /// Adds the springs' part of the product of a matrix with p to `out`.
    pub fn add_product(&self, matrix: &Matrix, p: &[f64], out: &mut [f64]) {
        let fields = [Some(matrix.x), None, Some(p), None];
        self.add(Quantity::product(matrix), fields, out);
    }

    fn add(&self, quantity: Quantity, fields: [Option<&[f64]>; 4], f: &mut [f64]) {
        let most = threads(self.order.particles.len());
        self.add_in(self.order.bands(most), Task { quantity, fields }, f);
    }

    /// Adds the quantity to f in `count` bands.
    fn add_in(&self, count: usize, task: Task, f: &mut [f64]) {
        self.windows.lend(|windows| {
            if windows.len() < count {
                windows.resize_with(count, TileWindow::default);
            }
            self.fork(&mut windows[..count], [0, count], task, columns_mut(f), 0);
        });
    }

    /// Adds to columns that begin at a row, in as many bands as there are windows. `before` bands
    /// come before these, of `count` in all.
    fn fork(
        &self,
        windows: &mut [TileWindow],
        [before, count]: [usize; 2],
        task: Task,
        mut f: Columns<3>,
        row: usize,
    ) {
        if let [window] = windows {
            self.sum(window, [before, count], task, f, row);
            return;
        }
        let (firsts, others) = windows.split_at_mut(windows.len() / 2);
        let middle = before + firsts.len();
        let at = self.order.particles[self.order.stretch(middle, count).own.start] as usize;
        let above = split_off(&mut f, at - row);
        rayon::join(
            || self.fork(firsts, [before, count], task, above, row),
            || self.fork(others, [middle, count], task, f, at),
        );
    }

    /// Adds the sums on one band of particles, panel by panel.
    fn sum(
        &self,
        window: &mut TileWindow,
        [band, count]: [usize; 2],
        task: Task,
        mut f: Columns<3>,
        row: usize,
    ) {
        let order = &self.order;
        let stretch = order.stretch(band, count);
        let mut tiles = stretch.tiles;
        window.clear();
        while !tiles.is_empty() {
            let panel = tiles.start..tiles.end.min(tiles.start + order.panel);
            let start = panel.start * TILE;
            window.take(order, start, &task.fields);
            for tile in panel.clone() {
                let [runs, blocks] = order.of_tile(tile);
                let offset = tile * TILE - start;
                if !runs.is_empty() {
                    Arch::new().dispatch(self.sum_of_runs(window, runs, offset, task.quantity));
                }
                if !blocks.is_empty() {
                    Arch::new().dispatch(self.sum_of_blocks(window, blocks, offset, task.quantity));
                }
            }
            // The first panel may end before the band starts.
            let of = start.max(stretch.own.start)..(panel.end * TILE).min(stretch.own.end);
            if !of.is_empty() {
                window.give(order, start, of, (&mut f, row));
            }
            tiles.start = panel.end;
        }
    }

    fn sum_of_runs<'a>(
        &'a self,
        window: &'a mut TileWindow,
        which: Range<usize>,
        offset: usize,
        quantity: Quantity,
    ) -> order::OrderedSum<'a> {
        let [fields @ .., f] = &mut window.columns;
        order::OrderedSum {
            runs: &self.order.runs,
            which,
            stride: self.order.window(),
            fields: fields.each_ref().map(|a| a.get().get(offset..).unwrap_or(&[])),
            f: &mut f.get_mut()[offset..],
            is_damped: self.is_damped,
            quantity,
        }
    }

    fn sum_of_blocks<'a>(
        &'a self,
        window: &'a mut TileWindow,
        which: Range<usize>,
        offset: usize,
        quantity: Quantity,
    ) -> blocks::Sum<'a> {
        let [fields @ .., f] = &mut window.rows;
        blocks::Sum {
            blocks: &self.order.blocks,
            which,
            fields: fields.each_ref().map(|a| a.get(offset..).unwrap_or(&[])),
            f: &mut f[offset..],
            is_damped: self.is_damped,
            quantity,
        }
    }
}

#[cfg(test)]
mod tests;
