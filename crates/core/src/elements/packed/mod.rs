//! Many single springs, evaluated in blocks that the compiler turns into vectors.
//!
//! A particle's three numbers lie side by side here, so that each end of a spring is one load, and
//! one store of its force. Springs are in an order in which neighbours have no particle in common,
//! so that no sum waits for the one before, and which stays among a few particles for a while, so
//! that these stay in the cache. The forces on each particle are summed in that order, whatever the
//! number of threads: a thread has a band of particles, and evaluates all springs that reach it.

mod blocks;
mod order;

use std::sync::{Mutex, TryLockError};

use pulp::Arch;
use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};

use super::force::At;
use crate::spring::Spring;
use crate::threads::threads;
use blocks::{Numbers, Sum};
use order::{Order, Stretch};

/// Number of springs from which on it pays to pack them.
const LEAST: usize = 1024;

/// Time that springs take one by one over that which they take in blocks (docs/performance.md).
pub(super) const SPEED: f64 = 1.8;

/// Springs in blocks.
#[derive(Debug)]
pub(super) struct Packed {
    order: Order,
    is_damped: bool,
    /// Scratch, no part of the value.
    bands: Mutex<Vec<Band>>,
}

/// Scratch of a band: x, v, dx and dv of its particles and of those that their springs reach, and
/// what is summed, by the numbers that all particles have.
#[derive(Debug, Default)]
struct Band {
    fields: [Vec<Numbers>; 4],
    f: Vec<Numbers>,
}

impl Packed {
    /// Springs in blocks, unless there are too few.
    pub fn new(springs: &[Spring]) -> Option<Self> {
        (springs.len() >= LEAST).then(|| Self {
            order: Order::of(springs),
            is_damped: springs.iter().any(|spring| spring.law.damping > 0.0),
            bands: Mutex::default(),
        })
    }

    /// Adds the forces to f.
    pub fn add_forces(&self, at: &At, f: &mut [f64]) {
        let v = self.is_damped.then_some(at.v);
        self.add([Some(at.x), v, None, None], f);
    }

    /// Adds the change of the forces by dx and dv to df.
    pub fn add_differential(&self, at: &At, [dx, dv]: [&[f64]; 2], df: &mut [f64]) {
        let [v, dv] = [at.v, dv].map(|speeds| self.is_damped.then_some(speeds));
        self.add([Some(at.x), v, Some(dx), dv], df);
    }

    fn add(&self, fields: [Option<&[f64]>; 4], f: &mut [f64]) {
        let most = threads(self.order.particles.len());
        self.add_in(self.order.bands(most), fields, f);
    }

    /// Adds to f in so many bands.
    fn add_in(&self, count: usize, fields: [Option<&[f64]>; 4], f: &mut [f64]) {
        self.lend(|bands| {
            if bands.len() < count {
                bands.resize_with(count, Band::default);
            }
            let bands = &mut bands[..count];
            if count == 1 {
                self.sum(&mut bands[0], &self.order.stretch(0, 1), fields);
            } else {
                bands.par_iter_mut().enumerate().for_each(|(k, band)| {
                    self.sum(band, &self.order.stretch(k, count), fields);
                });
            }
            for (k, band) in bands.iter().enumerate() {
                let own = self.order.stretch(k, count).own;
                give(&self.order.particles[own.clone()], &band.f[own], f);
            }
        });
    }

    /// Sums the forces on a band of particles.
    fn sum(&self, band: &mut Band, stretch: &Stretch, fields: [Option<&[f64]>; 4]) {
        let all = &stretch.all;
        let reserve = |a: &mut Vec<Numbers>| {
            if a.len() < all.end {
                a.resize(all.end, [0.0; 4]);
            }
        };
        for (to, from) in band.fields.iter_mut().zip(fields) {
            if let Some(from) = from {
                reserve(to);
                take(
                    &self.order.particles[all.clone()],
                    from,
                    &mut to[all.clone()],
                );
            }
        }
        reserve(&mut band.f);
        band.f[all.clone()].fill([0.0; 4]);
        Arch::new().dispatch(self.sum_of(band, stretch, fields[2].is_some()));
    }

    fn sum_of<'a>(
        &'a self,
        band: &'a mut Band,
        stretch: &Stretch,
        is_differential: bool,
    ) -> Sum<'a> {
        Sum {
            blocks: &self.order.blocks,
            which: stretch.blocks.clone(),
            fields: band.fields.each_ref().map(Vec::as_slice),
            f: &mut band.f,
            is_damped: self.is_damped,
            is_differential,
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

/// Takes rows of an n x 3 matrix.
fn take(particles: &[u32], from: &[f64], to: &mut [Numbers]) {
    let n = from.len() / 3;
    let (x, y, z) = (&from[..n], &from[n..2 * n], &from[2 * n..]);
    for (i, to) in particles.iter().zip(to) {
        let i = *i as usize;
        *to = [x[i], y[i], z[i], 0.0];
    }
}

/// Adds to rows of an n x 3 matrix.
fn give(particles: &[u32], found: &[Numbers], f: &mut [f64]) {
    let n = f.len() / 3;
    let (x, f) = f.split_at_mut(n);
    let (y, z) = f.split_at_mut(n);
    for (i, found) in particles.iter().zip(found) {
        let i = *i as usize;
        x[i] += found[0];
        y[i] += found[1];
        z[i] += found[2];
    }
}

#[cfg(test)]
mod tests;
