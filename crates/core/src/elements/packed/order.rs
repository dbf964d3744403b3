//! The order in which springs are summed, and the part of it that a band of particles needs.
//!
//! Runs: springs whose first ends and second ends are consecutive particles, as in a jelly or a
//! cloth. Their numbers are loaded as whole vectors, and none is gathered.
//!
//! Window over the particles: those of a panel and those that their springs reach. It moves on from
//! panel to panel, and stays in the cache.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::blocks::{Blocks, Columns, Numbers, Places, add, copy, copy_rows};
use super::laws;
use super::laws::{Aligned, BLOCK, Each, Factors, Kernels, Laws, Products, Quantity};
use crate::elements::force::ends;
use crate::fused::mul_add;
use crate::spring::Spring;
use crate::threads;

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
pub(super) struct TileStretch {
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
        most.min(self.particles.len() / (2 * self.reach.max(1))).max(1)
    }

    /// Returns band number k of `bands`.
    pub fn stretch(&self, k: usize, bands: usize) -> TileStretch {
        let n = self.particles.len();
        let own = n * k / bands..n * (k + 1) / bands;
        TileStretch {
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
    let mut ranked: Vec<_> = of_particles.flat_map(|chunk| chunk.iter().enumerate()).collect();
    ranked.sort_by_key(|(rank, ([i, _], _))| (*i as usize / TILE, *rank, *i));
    ranked.into_iter().map(|(_, entry)| *entry).collect()
}

/// Springs between consecutive particles. A missing spring is replaced by one without stiffness.
#[derive(Debug, Default)]
pub(super) struct Runs {
    /// Particles at the two ends of the first spring of each block.
    pub places: Vec<[u32; 2]>,
    pub laws: Laws,
}

impl Runs {
    /// Adds springs of consecutive particles, in their order, whose first ends are in one block of
    /// particles. Ends are numbered from the particle `start` on.
    pub fn push(&mut self, springs: &[([u32; 2], &Spring)], start: u32) {
        let [i, j] = springs[0].0;
        let first = i - i % BLOCK as u32;
        self.places.push([first, first + (j - i)].map(|i| i - start));
        let at = |(ends, spring): &([u32; 2], _)| ((ends[0] - first) as usize, *spring);
        self.laws.push(springs.iter().map(at));
    }
}

/// Task that adds the forces of runs at x and v to f, or their differential for dx and dv. All have
/// three columns, `stride` numbers apart.
pub(super) struct OrderedSum<'a> {
    pub runs: &'a Runs,
    pub which: Range<usize>,
    pub stride: usize,
    pub fields: [&'a [f64]; 4],
    pub f: &'a mut [f64],
    pub quantity: Quantity,
    pub is_damped: bool,
}

impl WithSimd for OrderedSum<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (quantity, is_damped) = (self.quantity, self.is_damped);
        self.run(quantity, is_damped);
    }
}

/// Three numbers for each particle of a block.
type Three<'a> = [&'a Each<f64>; 3];

#[inline(always)]
fn at(a: &[f64], stride: usize, first: u32) -> Three<'_> {
    let column = |axis: usize| a[axis * stride + first as usize..].first_chunk().unwrap();
    [column(0), column(1), column(2)]
}

#[inline(always)]
fn apart([a, b]: [Three; 2], m: usize) -> [f64; 3] {
    [a[0][m] - b[0][m], a[1][m] - b[1][m], a[2][m] - b[2][m]]
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    mul_add(a[2], b[2], mul_add(a[1], b[1], a[0] * b[0]))
}

/// Subtracts g from the forces on the first ends, and adds it to those on the second.
#[inline(always)]
fn give(g: &[Aligned; 3], [i, j]: [u32; 2], stride: usize, f: &mut [f64]) {
    for (axis, Aligned(g)) in g.iter().enumerate() {
        let column = &mut f[axis * stride..];
        let first: &mut Each<f64> = column[i as usize..].first_chunk_mut().unwrap();
        for m in 0..BLOCK {
            first[m] -= g[m];
        }
        let second: &mut Each<f64> = column[j as usize..].first_chunk_mut().unwrap();
        for m in 0..BLOCK {
            second[m] += g[m];
        }
    }
}

impl Kernels for OrderedSum<'_> {
    #[inline(always)]
    fn forces<const DAMPED: bool>(self) {
        let (runs, stride) = (self.runs, self.stride);
        let [x, v, ..] = self.fields;
        let mut g = [Aligned::ZERO; 3];
        for block in self.which {
            let law = runs.laws.of(block);
            let [i, j] = runs.places[block];
            let places = [at(x, stride, i), at(x, stride, j)];
            // Without damping, velocities are not loaded.
            let speeds = if DAMPED { [at(v, stride, i), at(v, stride, j)] } else { places };
            for m in 0..BLOCK {
                let d = apart(places, m);
                let of = Products {
                    dd: dot(d, d),
                    wd: if DAMPED { dot(apart(speeds, m), d) } else { 0.0 },
                    ..Products::default()
                };
                let s = laws::force::<DAMPED>(law, m, of);
                for axis in 0..3 {
                    g[axis].0[m] = s * d[axis];
                }
            }
            give(&g, [i, j], stride, self.f);
        }
    }

    #[inline(always)]
    fn changes<const DAMPED: bool, const PRODUCT: bool>(self, factors: Factors) {
        let (runs, stride) = (self.runs, self.stride);
        let mut g = [Aligned::ZERO; 3];
        for block in self.which {
            let law = runs.laws.of(block);
            let [i, j] = runs.places[block];
            let [places, moves] = [0, 2].map(|k| {
                let a = self.fields[k];
                [at(a, stride, i), at(a, stride, j)]
            });
            // Without damping, velocities are not loaded.
            let [speeds, changes] = if DAMPED && !PRODUCT {
                [1, 3].map(|k| {
                    let a = self.fields[k];
                    [at(a, stride, i), at(a, stride, j)]
                })
            } else {
                [places, moves]
            };
            for m in 0..BLOCK {
                let (d, e) = (apart(places, m), apart(moves, m));
                let mut of = Products { dd: dot(d, d), de: dot(d, e), ..Products::default() };
                if DAMPED && !PRODUCT {
                    let w = apart(speeds, m);
                    (of.wd, of.we) = (dot(w, d), dot(w, e));
                    of.gd = dot(apart(changes, m), d);
                }
                let [a, b] = laws::change::<DAMPED, PRODUCT>(law, m, of, factors);
                for axis in 0..3 {
                    g[axis].0[m] = mul_add(a, e[axis], b * d[axis]);
                }
            }
            give(&g, [i, j], stride, self.f);
        }
    }
}

/// x, v, dx and dv of the particles in the window, and the sums on them.
#[derive(Debug, Default)]
pub(super) struct TileWindow {
    /// For runs, in three columns.
    pub columns: [Columns; 5],
    /// For blocks, three numbers side by side.
    pub rows: [Vec<Numbers>; 5],
    /// Number of particles at the end of the window that stay when it moves on.
    stays: usize,
}

impl TileWindow {
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
