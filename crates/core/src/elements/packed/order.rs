//! The order in which springs are summed, and the part of it that a band of particles needs.

use std::ops::Range;

use super::blocks::Blocks;
use super::laws::BLOCK;
use super::places::Places;
use super::runs::Runs;
use crate::elements::force::ends;
use crate::spring::Spring;

/// Number of particles of a tile. The springs of a tile follow one another.
pub(super) const TILE: usize = 256;

/// Least number of tiles of a panel.
const MIN_PANEL: usize = 8;

/// Least number of springs of a block between consecutive particles.
const MIN_RUN: usize = BLOCK / 2;

/// Springs in runs, and all others in blocks, tile by tile. The springs of a tile have their first
/// ends in it. In the blocks of a tile, the first springs of all particles come first, then the
/// second springs, and so on.
#[derive(Debug)]
pub(super) struct Order {
    pub runs: Runs,
    pub blocks: Blocks,
    /// Particles at the ends of springs. An index into this list is their number here.
    pub particles: Vec<u32>,
    /// First run and first block of each tile, and at the end the numbers of both.
    tiles: Vec<[usize; 2]>,
    /// Largest difference of the numbers of a spring's ends.
    pub reach: usize,
    /// Number of tiles of a panel, which has at least as many particles as `reach`.
    pub panel: usize,
}

/// A band of particles with all springs that reach it.
pub(super) struct Stretch {
    /// Particles of the band.
    pub own: Range<usize>,
    /// Tiles whose springs reach them.
    pub tiles: Range<usize>,
}

/// A spring with its ends as numbered here.
type Entry<'a> = ([u32; 2], &'a Spring);

impl Order {
    pub fn of(springs: &[Spring]) -> Self {
        let mut particles: Vec<_> = springs.iter().flat_map(ends).collect();
        particles.sort_unstable();
        particles.dedup();
        let mut numbers = vec![0; particles.last().map_or(0, |last| last + 1)];
        for (number, particle) in particles.iter().enumerate() {
            numbers[*particle] = number as u32;
        }
        let numbered = |spring| (ends(spring).map(|i| numbers[i]), spring);
        let mut all: Vec<Entry> = springs.iter().map(numbered).collect();
        let reach = all.iter().map(|([i, j], _)| (j - i) as usize).max();
        let reach = reach.unwrap_or(0);
        let (dense, rest) = split(&mut all);
        let rest = by_rank(rest);
        let (mut dense, mut rest) = (dense.as_slice(), rest.as_slice());
        let (mut runs, mut blocks, mut tiles) = (Runs::default(), Blocks::default(), vec![]);
        for tile in 0..particles.len().div_ceil(TILE) {
            tiles.push([runs.places.len(), blocks.len()]);
            let first = (tile * TILE) as u32;
            let own;
            let is_own = |([i, _], _): &Entry| *i as usize / TILE == tile;
            (own, dense) = dense.split_at(dense.partition_point(|run| is_own(&run[0])));
            for run in own {
                runs.push(run, first);
            }
            let own;
            (own, rest) = rest.split_at(rest.partition_point(is_own));
            for chunk in own.chunks(BLOCK) {
                blocks.push(chunk, first);
            }
        }
        tiles.push([runs.places.len(), blocks.len()]);
        runs.laws.end();
        blocks.laws.end();
        Self {
            panel: reach.div_ceil(TILE).max(MIN_PANEL).min(tiles.len() - 1),
            runs,
            blocks,
            particles: particles.iter().map(|i| *i as u32).collect(),
            tiles,
            reach,
        }
    }

    /// Returns the number of particles of a window: those of a panel, those that its springs reach,
    /// and the padding of runs at the end.
    pub fn window(&self) -> usize {
        (self.panel * TILE + self.reach).next_multiple_of(8)
    }

    /// Returns the particles at some places of the order.
    pub fn places(&self, of: Range<usize>) -> Places<'_> {
        let all = &self.particles[of];
        match (all.first(), all.last()) {
            // The particles are in ascending order.
            (Some(first), Some(last)) if (last - first) as usize == all.len() - 1 => {
                Places::From(*first as usize)
            }
            _ => Places::Each(all),
        }
    }

    /// Returns the runs and the blocks of a tile.
    pub fn of_tile(&self, tile: usize) -> [Range<usize>; 2] {
        let (start, end) = (self.tiles[tile], self.tiles[tile + 1]);
        [0, 1].map(|kind| start[kind]..end[kind])
    }

    /// Returns the number of bands, at most `most`, such that none is much smaller than the reach
    /// of its springs.
    pub fn bands(&self, most: usize) -> usize {
        most.min(self.particles.len() / (2 * self.reach.max(1)))
            .max(1)
    }

    /// Returns band number k of `bands`.
    pub fn stretch(&self, k: usize, bands: usize) -> Stretch {
        let n = self.particles.len();
        let own = n * k / bands..n * (k + 1) / bands;
        Stretch {
            tiles: own.start.saturating_sub(self.reach) / TILE..own.end.div_ceil(TILE),
            own,
        }
    }
}

/// Splits springs into those that form dense runs, block by block in the order of tiles, and the
/// others.
fn split<'a>(all: &mut [Entry<'a>]) -> (Vec<Vec<Entry<'a>>>, Vec<Entry<'a>>) {
    let place = |([i, j], _): &Entry| (j - i, *i as usize / BLOCK);
    all.sort_by_key(|entry| (entry.0[1] - entry.0[0], entry.0[0]));
    let (mut dense, mut rest) = (vec![], vec![]);
    for chunk in all.chunk_by(|a, b| place(a) == place(b)) {
        // Of several springs between the same particles, one is in the run.
        let mut run = chunk.to_vec();
        run.dedup_by_key(|entry| entry.0);
        if run.len() < MIN_RUN {
            rest.extend_from_slice(chunk);
            continue;
        }
        let twice = chunk.windows(2).filter(|pair| pair[0].0 == pair[1].0);
        rest.extend(twice.map(|pair| pair[1]));
        dense.push(run);
    }
    dense.sort_by_key(|run| (run[0].0[0] as usize / TILE, place(&run[0])));
    (dense, rest)
}

/// Sorts springs by tiles and, within a tile, by their rank among those with the same first end.
fn by_rank(mut all: Vec<Entry>) -> Vec<Entry> {
    all.sort_by_key(|(ends, _)| *ends);
    let same = |a: &Entry, b: &Entry| a.0[0] == b.0[0];
    let of_particles = all.chunk_by(same);
    let mut ranked: Vec<_> = of_particles
        .flat_map(|chunk| chunk.iter().enumerate())
        .collect();
    ranked.sort_by_key(|(rank, ([i, _], _))| (*i as usize / TILE, *rank, *i));
    ranked.into_iter().map(|(_, entry)| *entry).collect()
}
