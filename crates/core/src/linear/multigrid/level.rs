//! A level of multigrid: the matrix of aggregates and of the couplings between them, formed from
//! the matrix of particles or of smaller aggregates.

use rayon::iter::{IndexedParallelIterator, IntoParallelRefMutIterator, ParallelIterator};

use super::super::tangent::{Block, inverse};
use super::aggregates::{Aggregates, Graph, NONE};
use super::lists::Lists;
use crate::threads::threads;

/// Factor by which couplings of aggregates that move as one are stiffer than those of aggregates
/// with smoothed motion. For springs between neighbours it is two for aggregates of two particles
/// in a row, and three for those of three; less for longer springs (Braess, *Towards algebraic
/// multigrid for elliptic problems of second order*, 1995).
const STIFFNESS_RATIO: f64 = 2.0;

/// Least number of aggregates for each thread.
const MIN_PER_THREAD: usize = 256;

/// The matrix of aggregates, with its relation to the finer level.
pub(super) struct Level {
    /// Aggregate of each finer particle.
    of: Vec<u32>,
    /// Weights of aggregates in the motion of each finer particle, and the same by aggregate.
    shares: Lists<(u32, f32)>,
    shared: Lists<(u32, f32)>,
    /// Coupling that contains each finer coupling; `NONE` for one within an aggregate.
    part_of: Vec<u32>,
    /// Ends of the couplings.
    pub ends: Vec<[u32; 2]>,
    /// Own block of each aggregate: its mass, and its couplings to pinned particles.
    pub own: Vec<Block>,
    /// Blocks of the couplings.
    pub couplings: Vec<Block>,
    /// Inverse of each block on the diagonal.
    inverses: Vec<Block>,
    /// Each aggregate's neighbours before it, and after it, with their couplings.
    before: Lists<(u32, u32)>,
    after: Lists<(u32, u32)>,
    /// Right-hand side, solution, and residual.
    pub r: Vec<[f64; 3]>,
    pub z: Vec<[f64; 3]>,
    pub left: Vec<[f64; 3]>,
}

impl Level {
    /// Forms the aggregates of a graph's particles, and the graph of these aggregates; `None` if
    /// hardly any can be formed.
    pub fn new(graph: &Graph, is_free: impl Fn(u32) -> bool) -> Option<(Self, Graph)> {
        let Aggregates { count, of, shares } = Aggregates::new(graph, is_free);
        if count == 0 || 3 * count > 2 * graph.particles {
            return None;
        }
        let (ends, part_of) = join(&graph.ends, &of, count);
        let mut strengths = vec![0.0; ends.len()];
        for (part_of, strength) in part_of.iter().zip(&graph.strengths) {
            if *part_of != NONE {
                strengths[*part_of as usize] += strength;
            }
        }
        let numbered = ends.iter().enumerate();
        let level = Self {
            shared: Lists::new(count, shares.all().map(|(i, (a, share))| (a, (i, share)))),
            shares,
            part_of,
            own: vec![[0.0; 6]; count],
            couplings: vec![[0.0; 6]; ends.len()],
            inverses: vec![[0.0; 6]; count],
            before: Lists::new(count, numbered.clone().map(|(k, e)| (e[1], (e[0], k as u32)))),
            after: Lists::new(count, numbered.map(|(k, e)| (e[0], (e[1], k as u32)))),
            r: vec![[0.0; 3]; count],
            z: vec![[0.0; 3]; count],
            left: vec![[0.0; 3]; count],
            ends: ends.clone(),
            of,
        };
        let graph = Graph { particles: count, ends, strengths };
        Some((level, graph))
    }

    /// Begins a new matrix, with all blocks zero.
    pub fn clear(&mut self) {
        self.own.fill([0.0; 6]);
        self.couplings.fill([0.0; 6]);
    }

    /// Adds the own block of a finer particle.
    pub fn add_own(&mut self, i: usize, block: &Block) {
        if let Some(own) = self.own.get_mut(self.of[i] as usize) {
            add(own, block);
        }
    }

    /// Adds the block of a finer coupling.
    pub fn add_coupling(&mut self, coupling: usize, [i, j]: [u32; 2], block: &Block) {
        let part_of = self.part_of[coupling];
        if part_of != NONE {
            add(&mut self.couplings[part_of as usize], block);
        } else if i == j {
            self.add_own(i as usize, block);
        } else {
            // A coupling to a pinned end. Those within an aggregate do not change as it moves.
            match [i, j].map(|i| self.of[i as usize]) {
                [NONE, a] | [a, NONE] if a != NONE => add(&mut self.own[a as usize], block),
                _ => {}
            }
        }
    }

    /// Finishes a new matrix: reduces its couplings, and inverts its diagonal blocks.
    pub fn finish(&mut self) {
        self.inverses.copy_from_slice(&self.own);
        for (ends, coupling) in self.ends.iter().zip(&mut self.couplings) {
            *coupling = coupling.map(|k| k / STIFFNESS_RATIO);
            for end in ends {
                add(&mut self.inverses[*end as usize], coupling);
            }
        }
        for block in &mut self.inverses {
            *block = inverse(*block);
        }
    }

    /// Restricts a finer right-hand side to this level.
    pub fn restrict(&mut self, finer: impl Fn(usize) -> [f64; 3] + Sync) {
        let shared = &self.shared;
        let take_up = |(aggregate, r): (usize, &mut [f64; 3])| {
            *r = [0.0; 3];
            for (i, share) in shared.of(aggregate) {
                add_scaled(r, f64::from(*share), finer(*i as usize));
            }
        };
        if threads(self.of.len()) > 1 {
            let all = self.r.par_iter_mut().with_min_len(MIN_PER_THREAD);
            all.enumerate().for_each(take_up);
        } else {
            self.r.iter_mut().enumerate().for_each(take_up);
        }
    }

    /// Returns the solution at a finer particle.
    #[inline]
    pub fn prolong(&self, i: usize) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (aggregate, share) in self.shares.of(i) {
            add_scaled(&mut sum, f64::from(*share), self.z[*aggregate as usize]);
        }
        sum
    }

    /// Takes the forward half of a symmetric Gauss-Seidel iteration from z = 0, and forms the
    /// residual.
    pub fn descend(&mut self) {
        for i in 0..self.z.len() {
            let sum = self.pulled(self.r[i], self.before.of(i));
            self.z[i] = times(&self.inverses[i], sum);
        }
        for i in 0..self.z.len() {
            self.left[i] = self.pulled([0.0; 3], self.after.of(i));
        }
    }

    /// Takes the backward half of the iteration.
    pub fn ascend(&mut self) {
        for i in (0..self.z.len()).rev() {
            let sum = self.pulled(self.r[i], self.before.of(i));
            let sum = self.pulled(sum, self.after.of(i));
            self.z[i] = times(&self.inverses[i], sum);
        }
    }

    /// Adds the pull of neighbours.
    #[inline]
    fn pulled(&self, mut sum: [f64; 3], neighbours: &[(u32, u32)]) -> [f64; 3] {
        for (j, coupling) in neighbours {
            let pull = times(&self.couplings[*coupling as usize], self.z[*j as usize]);
            add_scaled(&mut sum, 1.0, pull);
        }
        sum
    }
}

/// Returns the couplings between aggregates, and the one that contains each finer coupling.
fn join(finer: &[[u32; 2]], of: &[u32], count: usize) -> (Vec<[u32; 2]>, Vec<u32>) {
    let between = finer.iter().enumerate().filter_map(|(k, ends)| {
        let [a, b] = ends.map(|end| of[end as usize]);
        let joins = a != b && a != NONE && b != NONE;
        joins.then_some((a.min(b), (a.max(b), k as u32)))
    });
    let by_aggregate = Lists::new(count, between);
    let (mut ends, mut part_of) = (vec![], vec![NONE; finer.len()]);
    // The last coupling of each aggregate to one before it.
    let mut last = vec![NONE; count];
    for a in 0..count as u32 {
        for (b, k) in by_aggregate.of(a as usize) {
            let coupling = &mut last[*b as usize];
            if ends.get(*coupling as usize).is_none_or(|e: &[u32; 2]| e[0] != a) {
                *coupling = ends.len() as u32;
                ends.push([a, *b]);
            }
            part_of[*k as usize] = *coupling;
        }
    }
    (ends, part_of)
}

fn add(sum: &mut Block, block: &Block) {
    for (sum, part) in sum.iter_mut().zip(block) {
        *sum += part;
    }
}

#[inline]
fn add_scaled(sum: &mut [f64; 3], share: f64, of: [f64; 3]) {
    for (sum, part) in sum.iter_mut().zip(of) {
        *sum += share * part;
    }
}

#[inline]
fn times([xx, yy, zz, xy, xz, yz]: &Block, [x, y, z]: [f64; 3]) -> [f64; 3] {
    [xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z]
}
