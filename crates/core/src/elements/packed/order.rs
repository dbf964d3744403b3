//! The order in which springs are summed, and the part of it that a band of particles needs.

use std::ops::Range;

use super::blocks::{BLOCK, Blocks};
use crate::elements::force::ends;
use crate::spring::Spring;

/// Particles of a tile, whose springs follow one another.
const TILE: usize = 256;

/// Springs in blocks, tile by tile. The springs of a tile begin at its particles. First come the
/// first springs of all of them, then the second, and so on: neighbours have no end in common.
#[derive(Debug)]
pub(super) struct Order {
    pub blocks: Blocks,
    /// The particles at the ends of springs, which are numbered in this order here.
    pub particles: Vec<u32>,
    /// The first block of each tile, and the number of blocks.
    tiles: Vec<usize>,
    /// The most by which the numbers of the ends of a spring differ.
    reach: usize,
}

/// A part of the particles with all springs that reach it.
pub(super) struct Stretch {
    /// The particles.
    pub own: Range<usize>,
    /// These and others at the ends of the springs.
    pub all: Range<usize>,
    pub blocks: Range<usize>,
}

impl Order {
    pub fn of(springs: &[Spring]) -> Self {
        let mut particles: Vec<_> = springs.iter().flat_map(ends).collect();
        particles.sort_unstable();
        particles.dedup();
        let mut numbers = vec![0; particles.last().map_or(0, |last| last + 1)];
        for (number, particle) in particles.iter().enumerate() {
            numbers[*particle] = number as u32;
        }
        let mut all: Vec<_> = springs
            .iter()
            .map(|spring| (ends(spring).map(|i| numbers[i]), spring))
            .collect();
        all.sort_by_key(|(ends, _)| *ends);
        // The number of each spring among those that begin at the same particle.
        let mut ranked: Vec<(usize, usize, _)> = Vec::with_capacity(all.len());
        for (k, entry) in all.iter().enumerate() {
            let [i, _] = entry.0;
            let rank = match ranked.last() {
                Some((_, before, _)) if all[k - 1].0[0] == i => before + 1,
                _ => 0,
            };
            ranked.push((i as usize / TILE, rank, entry));
        }
        ranked.sort_by_key(|(tile, rank, (ends, _))| (*tile, *rank, *ends));
        let (mut blocks, mut tiles) = (Blocks::default(), vec![]);
        let count = particles.len().div_ceil(TILE);
        let mut rest = ranked.as_slice();
        for tile in 0..count {
            tiles.push(blocks.len());
            let own;
            (own, rest) = rest.split_at(rest.partition_point(|(of, ..)| *of == tile));
            for chunk in own.chunks(BLOCK) {
                blocks.push(chunk.iter().map(|(_, _, (ends, spring))| (*ends, *spring)));
            }
        }
        tiles.push(blocks.len());
        let reach = all.iter().map(|([i, j], _)| (j - i) as usize).max();
        Self {
            blocks,
            particles: particles.iter().map(|i| *i as u32).collect(),
            tiles,
            reach: reach.unwrap_or(0),
        }
    }

    /// The number of bands, up to the `most`, of which none is much smaller than what its springs
    /// reach beside it.
    pub fn bands(&self, most: usize) -> usize {
        most.min(self.particles.len() / (2 * self.reach.max(1)))
            .max(1)
    }

    /// Band number k of so many.
    pub fn stretch(&self, k: usize, bands: usize) -> Stretch {
        let n = self.particles.len();
        let own = n * k / bands..n * (k + 1) / bands;
        let first = own.start.saturating_sub(self.reach) / TILE;
        let last = own.end.div_ceil(TILE);
        Stretch {
            all: first * TILE..n.min(last * TILE + self.reach),
            blocks: self.tiles[first]..self.tiles[last],
            own,
        }
    }
}
