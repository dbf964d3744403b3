//! Many single springs, evaluated 64 at a time, which the compiler turns into vectors.
//!
//! Springs between consecutive particles make runs, for which positions are kept in columns. The
//! others make blocks, for which a particle's three numbers lie side by side, so that each end of
//! a spring is one load, and one store of its force. Springs of blocks are in an order in which
//! neighbours have no particle in common, so that no sum waits for the one before. Both stay
//! among a few particles for a while, so that these stay in the cache. The forces on each
//! particle are summed in that order, whatever the number of threads: a thread has a band of
//! particles, and evaluates all springs that reach it.

mod blocks;
mod laws;
mod order;
mod runs;

use std::ops::Range;
use std::sync::{Mutex, TryLockError};

use pulp::Arch;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};

use super::force::At;
use crate::spring::Spring;
use crate::system::Matrix;
use crate::threads::threads;
use blocks::Numbers;
use laws::Quantity;
use order::{Order, Stretch};

/// Number of springs from which on it pays to pack them.
const LEAST: usize = 1024;

/// Time that springs take one by one over that which they take in blocks (docs/performance.md).
pub(super) const SPEED: f64 = 2.0;

/// Springs in runs and in blocks.
#[derive(Debug)]
pub(crate) struct Packed {
    len: usize,
    order: Order,
    is_damped: bool,
    /// Scratch, no part of the value.
    bands: Mutex<Vec<Band>>,
}

/// Scratch of a band: x, v, dx and dv of its particles and of those that their springs reach, and
/// what is summed; by the numbers that all particles have.
#[derive(Debug, Default)]
struct Band {
    /// For runs, in three columns.
    columns: [Vec<f64>; 5],
    /// For blocks, three numbers side by side.
    rows: [Vec<Numbers>; 5],
}

impl Packed {
    /// Springs in blocks, unless there are too few.
    pub fn new(springs: &[Spring]) -> Option<Self> {
        (springs.len() >= LEAST).then(|| Self {
            len: springs.len(),
            order: Order::of(springs),
            is_damped: springs.iter().any(|spring| spring.law.damping > 0.0),
            bands: Mutex::default(),
        })
    }

    /// Number of springs.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Adds the forces to f.
    pub fn add_forces(&self, at: &At, f: &mut [f64]) {
        let v = self.is_damped.then_some(at.v);
        self.add(Quantity::Forces, [Some(at.x), v, None, None], f);
    }

    /// Adds the change of the forces by dx and dv to df.
    pub fn add_differential(&self, at: &At, [dx, dv]: [&[f64]; 2], df: &mut [f64]) {
        let [v, dv] = [at.v, dv].map(|speeds| self.is_damped.then_some(speeds));
        let fields = [Some(at.x), v, Some(dx), dv];
        self.add(Quantity::Differential, fields, df);
    }

    /// Adds the springs' part in the product of a matrix with p to `out`.
    pub fn add_product(&self, matrix: &Matrix, p: &[f64], out: &mut [f64]) {
        let fields = [Some(matrix.x), None, Some(p), None];
        self.add(Quantity::product(matrix), fields, out);
    }

    fn add(&self, quantity: Quantity, fields: [Option<&[f64]>; 4], f: &mut [f64]) {
        let most = threads(self.order.particles.len());
        self.add_in(self.order.bands(most), quantity, fields, f);
    }

    /// Adds to f in so many bands.
    fn add_in(&self, count: usize, quantity: Quantity, fields: [Option<&[f64]>; 4], f: &mut [f64]) {
        self.lend(|bands| {
            if bands.len() < count {
                bands.resize_with(count, Band::default);
            }
            let bands = &mut bands[..count];
            if count == 1 {
                self.sum(&mut bands[0], &self.order.stretch(0, 1), quantity, fields);
            } else {
                bands.par_iter_mut().enumerate().for_each(|(k, band)| {
                    self.sum(band, &self.order.stretch(k, count), quantity, fields);
                });
            }
            for (k, band) in bands.iter().enumerate() {
                self.give(band, self.order.stretch(k, count).own, f);
            }
        });
    }

    /// Sums a quantity on a band of particles.
    fn sum(
        &self,
        band: &mut Band,
        stretch: &Stretch,
        quantity: Quantity,
        fields: [Option<&[f64]>; 4],
    ) {
        self.take(band, stretch, fields);
        if !stretch.runs.is_empty() {
            Arch::new().dispatch(self.sum_of_runs(band, stretch, quantity));
        }
        if !stretch.blocks.is_empty() {
            Arch::new().dispatch(self.sum_of_blocks(band, stretch, quantity));
        }
    }

    fn sum_of_runs<'a>(
        &'a self,
        band: &'a mut Band,
        of: &Stretch,
        quantity: Quantity,
    ) -> runs::Sum<'a> {
        let [fields @ .., f] = &mut band.columns;
        runs::Sum {
            runs: &self.order.runs,
            which: of.runs.clone(),
            stride: self.order.stride(),
            fields: fields.each_ref().map(Vec::as_slice),
            f,
            is_damped: self.is_damped,
            quantity,
        }
    }

    fn sum_of_blocks<'a>(
        &'a self,
        band: &'a mut Band,
        of: &Stretch,
        quantity: Quantity,
    ) -> blocks::Sum<'a> {
        let [fields @ .., f] = &mut band.rows;
        blocks::Sum {
            blocks: &self.order.blocks,
            which: of.blocks.clone(),
            fields: fields.each_ref().map(Vec::as_slice),
            f,
            is_damped: self.is_damped,
            quantity,
        }
    }

    /// Copies what a band needs of n x 3 matrices to its scratch, whose sums begin at 0.
    fn take(&self, band: &mut Band, stretch: &Stretch, fields: [Option<&[f64]>; 4]) {
        let (stride, all) = (self.order.stride(), &stretch.all);
        let particles = &self.order.particles;
        let of_all = &particles[all.start..all.end.min(particles.len())];
        // After the fields, the sums, which have no source.
        let sources = fields
            .into_iter()
            .map(|field| field.map(Some))
            .chain([Some(None)]);
        for (k, source) in sources.enumerate() {
            let Some(source) = source else { continue };
            if !stretch.runs.is_empty() {
                let columns = &mut band.columns[k];
                columns.resize(3 * stride, 0.0);
                for (axis, column) in columns.chunks_exact_mut(stride).enumerate() {
                    let column = &mut column[all.clone()];
                    let Some(from) = source else {
                        column.fill(0.0);
                        continue;
                    };
                    let from = &from[axis * from.len() / 3..(axis + 1) * from.len() / 3];
                    for (to, i) in column.iter_mut().zip(of_all) {
                        *to = from[*i as usize];
                    }
                }
            }
            if !stretch.blocks.is_empty() {
                let rows = &mut band.rows[k];
                rows.resize(stride, [0.0; 4]);
                let rows = &mut rows[all.clone()];
                let Some(from) = source else {
                    rows.fill([0.0; 4]);
                    continue;
                };
                let n = from.len() / 3;
                for (to, i) in rows.iter_mut().zip(of_all) {
                    let i = *i as usize;
                    *to = [from[i], from[n + i], from[2 * n + i], 0.0];
                }
            }
        }
    }

    /// Adds the sums of a band to the rows of its own particles in an n x 3 matrix.
    fn give(&self, band: &Band, own: Range<usize>, f: &mut [f64]) {
        let (n, stride) = (f.len() / 3, self.order.stride());
        let [.., columns] = &band.columns;
        let [.., rows] = &band.rows;
        for (axis, f) in f.chunks_exact_mut(n).enumerate() {
            let particles = &self.order.particles[own.clone()];
            if !columns.is_empty() {
                let found = &columns[axis * stride..][own.clone()];
                for (i, found) in particles.iter().zip(found) {
                    f[*i as usize] += found;
                }
            }
            if !rows.is_empty() {
                for (i, found) in particles.iter().zip(&rows[own.clone()]) {
                    f[*i as usize] += found[axis];
                }
            }
        }
    }

    /// Lends the scratch; evaluations that run meanwhile bring their own.
    fn lend(&self, run: impl FnOnce(&mut Vec<Band>)) {
        match self.bands.try_lock() {
            Ok(mut bands) => run(&mut bands),
            Err(TryLockError::Poisoned(poisoned)) => run(&mut poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => run(&mut vec![]),
        }
    }
}

#[cfg(test)]
mod tests;
