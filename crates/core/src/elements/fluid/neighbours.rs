//! Neighbours of the particles of a fluid. They are found by a grid of cells, and listed until a
//! particle has moved too far. A list is in the order of the particles' numbers and holds every
//! particle that is near enough, so that no sum depends on when or by which thread it was made.
//!
//! Particles of a fluid, and the boxes in which they leave it for good.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::triple::{Triple, squared_distance};
use crate::error::{Error, positive};

/// Distance by which lists go beyond the reach, over the reach. They stay valid until a particle
/// has moved by half of it.
const SKIN: f64 = 0.12;
/// Fraction of that distance that a particle may move: a little less than half, for rounding.
const MAX_MOTION: f64 = 0.499;
/// Number of particles whose lists are made together.
const CHUNK: usize = 256;
/// Largest mean number of neighbours in a chunk that is listed. Neighbours of more crowded
/// particles are looked up in the grid each time.
const MAX_LISTED: usize = 400;
/// Largest distance from the origin, in cells, at which neighbours are found.
const MAX_CELL: f64 = 1e12;

/// Lists of the particles that are near each other.
#[derive(Debug, Default)]
pub(super) struct Neighbours {
    /// Distance up to which lists reach (m).
    reach: f64,
    /// Positions at which the lists were made (m).
    at: Vec<Triple>,
    cells: Cells,
    lists: Vec<List>,
}

/// Neighbours of the particles of a chunk.
#[derive(Debug, Default)]
struct List {
    /// End of the neighbours of each particle.
    ends: Vec<u32>,
    all: Vec<u32>,
    /// Whether there are too many neighbours to be listed.
    crowded: bool,
}

impl Neighbours {
    /// Renews the lists where necessary, so that they hold all pairs of particles at x less than
    /// `reach` (m) apart.
    pub fn cover(&mut self, x: &[Triple], reach: f64, parallel: bool) {
        let most = (MAX_MOTION * SKIN * reach).powi(2);
        let listed = (1.0 + SKIN) * reach;
        let still = |(x, at): (&Triple, &Triple)| squared_distance(x, at) <= most;
        if self.reach == listed && self.at.len() == x.len() && x.iter().zip(&self.at).all(still) {
            return;
        }
        self.reach = listed;
        self.at.clear();
        self.at.extend_from_slice(x);
        self.cells.fill(x, listed);
        self.lists.resize_with(x.len().div_ceil(CHUNK), List::default);
        let (at, cells) = (&self.at, &self.cells);
        let make = |(k, list): (usize, &mut List)| list.fill(k * CHUNK, at, cells);
        if parallel {
            self.lists.par_iter_mut().enumerate().for_each(make);
        } else {
            self.lists.iter_mut().enumerate().for_each(make);
        }
    }

    /// Writes the results of `find` for each particle and those near it, which are in the order of
    /// their numbers, and of which some are a little farther away than the reach.
    pub fn map<R: Send>(
        &self,
        out: &mut [R],
        parallel: bool,
        find: impl Fn(usize, &[u32]) -> R + Sync,
    ) {
        let chunk = |(k, (out, list)): (usize, (&mut [R], &List))| {
            let mut out = out.iter_mut();
            self.visit_chunk(k, list, |i, near| {
                if let Some(out) = out.next() {
                    *out = find(i, near);
                }
            });
        };
        if parallel {
            let chunks = out.par_chunks_mut(CHUNK).zip(&self.lists);
            chunks.enumerate().for_each(chunk);
        } else {
            let chunks = out.chunks_mut(CHUNK).zip(&self.lists);
            chunks.enumerate().for_each(chunk);
        }
    }

    /// Returns the two particles at x that are nearest to each other, and their distance (m);
    /// `None` if the lists hold no two.
    pub fn nearest(&self, x: &[Triple], parallel: bool) -> Option<([usize; 2], f64)> {
        let mut nearest = vec![(f64::INFINITY, 0); x.len()];
        self.map(&mut nearest, parallel, |i, near| {
            let of = |j: &u32| (squared_distance(&x[i], &x[*j as usize]), *j);
            let smaller = |a: (f64, u32), b: (f64, u32)| if b.0 < a.0 { b } else { a };
            near.iter().map(of).fold((f64::INFINITY, 0), smaller)
        });
        let (i, (square, j)) =
            nearest.into_iter().enumerate().min_by(|(_, (a, _)), (_, (b, _))| a.total_cmp(b))?;
        square.is_finite().then(|| ([i, j as usize], square.sqrt()))
    }

    /// Visits each particle and those near it, in the order of their numbers, as [`map`](Self::map)
    /// does.
    pub fn visit(&self, mut visit: impl FnMut(usize, &[u32])) {
        for (k, list) in self.lists.iter().enumerate() {
            self.visit_chunk(k, list, &mut visit);
        }
    }

    /// Visits the particles of chunk k, whose list this is.
    fn visit_chunk(&self, k: usize, list: &List, mut visit: impl FnMut(usize, &[u32])) {
        let (first, mut found, mut start) = (k * CHUNK, vec![], 0);
        for i in first..self.at.len().min(first + CHUNK) {
            if list.crowded {
                self.cells.find(i, &self.at, &mut found);
                visit(i, &found);
            } else {
                let end = list.ends[i - first] as usize;
                visit(i, &list.all[start..end]);
                start = end;
            }
        }
    }
}

impl List {
    fn fill(&mut self, first: usize, at: &[Triple], cells: &Cells) {
        self.ends.clear();
        self.all.clear();
        self.crowded = false;
        for i in first..at.len().min(first + CHUNK) {
            let start = self.all.len();
            cells.add(i, at, &mut self.all);
            if self.all.len() > MAX_LISTED * CHUNK {
                self.crowded = true;
                self.all.truncate(start);
                return;
            }
            self.ends.push(self.all.len() as u32);
        }
    }
}

/// Grid of cells as wide as the reach, wound around a torus where it would be too large.
#[derive(Debug, Default)]
struct Cells {
    size: f64,
    /// Number of cells along each axis: 1, or at least 3.
    counts: [usize; 3],
    /// Start of each cell's particles in `order`.
    starts: Vec<u32>,
    /// Particles cell by cell, in each cell in the order of their numbers.
    order: Vec<u32>,
    /// Cell of each particle.
    of: Vec<u32>,
}

/// Cell of a particle that is too far away.
const NOWHERE: u32 = u32::MAX;

impl Cells {
    /// Sorts particles at x into cells of a size (m).
    fn fill(&mut self, x: &[Triple], size: f64) {
        self.size = size;
        let mut bounds = [(f64::INFINITY, f64::NEG_INFINITY); 3];
        for x in x {
            if let Some(place) = self.place(x) {
                for ((low, high), at) in bounds.iter_mut().zip(place) {
                    (*low, *high) = (low.min(at), high.max(at));
                }
            }
        }
        let most = 2 * x.len() + 27;
        self.counts = bounds.map(|(low, high)| match high - low {
            0.0 => 1,
            span => (span + 1.0).clamp(3.0, most as f64) as usize,
        });
        while self.counts.iter().map(|c| *c as f64).product::<f64>() > most as f64 {
            if let Some(longest) = self.counts.iter_mut().max() {
                *longest = (*longest / 2).max(3);
            }
        }
        let cells: usize = self.counts.iter().product();
        self.starts.clear();
        self.starts.resize(cells + 1, 0);
        let mut of = std::mem::take(&mut self.of);
        of.clear();
        of.extend(x.iter().map(|x| match self.place(x) {
            Some(place) => self.cell(place) as u32,
            None => NOWHERE,
        }));
        for cell in of.iter().filter(|cell| **cell != NOWHERE) {
            self.starts[*cell as usize] += 1;
        }
        // The starts are counted down from the ends, from the last particle to the first.
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        self.order.clear();
        self.order.resize(end as usize, 0);
        for (i, cell) in of.iter().enumerate().rev() {
            if *cell != NOWHERE {
                let start = &mut self.starts[*cell as usize];
                *start -= 1;
                self.order[*start as usize] = i as u32;
            }
        }
        self.of = of;
    }

    /// Returns the cell of a position along each axis; `None` if it is too far away.
    fn place(&self, x: &Triple) -> Option<Triple> {
        let place = x.map(|x| (x / self.size).floor());
        place.iter().all(|at| at.abs() < MAX_CELL).then_some(place)
    }

    /// Returns the number of a cell.
    fn cell(&self, place: Triple) -> usize {
        let along =
            |axis: usize| (place[axis] as i64).rem_euclid(self.counts[axis] as i64) as usize;
        (along(2) * self.counts[1] + along(1)) * self.counts[0] + along(0)
    }

    /// Adds the particles less than a cell's size from particle i, in the order of their numbers.
    fn add(&self, i: usize, x: &[Triple], found: &mut Vec<u32>) {
        let (here, start) = (&x[i], found.len());
        let Some([a, b, c]) = self.place(here) else {
            return;
        };
        let most = self.size * self.size;
        let steps = |axis: usize| match self.counts[axis] {
            1 => &[0.0][..],
            _ => &[-1.0, 0.0, 1.0],
        };
        for dz in steps(2) {
            for dy in steps(1) {
                for dx in steps(0) {
                    let cell = self.cell([a + dx, b + dy, c + dz]);
                    let particles = self.starts[cell] as usize..self.starts[cell + 1] as usize;
                    let is_near = |j: &&u32| {
                        **j as usize != i && squared_distance(here, &x[**j as usize]) < most
                    };
                    found.extend(self.order[particles].iter().filter(is_near));
                }
            }
        }
        found[start..].sort_unstable();
    }

    /// Finds the particles less than a cell's size from particle i, in the order of their numbers.
    fn find(&self, i: usize, x: &[Triple], found: &mut Vec<u32>) {
        found.clear();
        self.add(i, x, found);
    }
}

/// Box in which particles of a fluid leave it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outflow {
    /// Centre (m).
    pub at: Vector3<f64>,
    /// Half of the edges (m).
    pub half: Vector3<f64>,
}

impl Outflow {
    /// Returns whether a place (m) is inside, or at most `slack` (m) outside.
    #[must_use]
    pub fn contains(&self, place: &Vector3<f64>, slack: f64) -> bool {
        let from_centre = (place - self.at).abs();
        (0..3).all(|axis| from_centre[axis] <= self.half[axis] + slack)
    }
}

/// Particles of a fluid by their numbers, and those that have left it.
#[derive(Clone, Debug)]
pub struct Members {
    flowing: Vec<u32>,
    drained: Vec<u32>,
    outflows: Vec<Outflow>,
}

impl Members {
    /// Creates a list of particles, given by their numbers in any order.
    ///
    /// # Errors
    /// A particle is named twice.
    pub(super) fn new(mut particles: Vec<u32>) -> Result<Self, Error> {
        particles.sort_unstable();
        let twice = particles.windows(2).find(|pair| pair[0] == pair[1]);
        if let Some([i, ..]) = twice {
            let why = format!("particle {i} is named twice in a fluid");
            return Err(Error::Invalid(why));
        }
        Ok(Self { flowing: particles, drained: vec![], outflows: vec![] })
    }

    /// Sets the boxes in which particles leave.
    ///
    /// # Errors
    /// An edge is not a finite number above 0.
    pub(super) fn set_outflows(&mut self, outflows: Vec<Outflow>) -> Result<(), Error> {
        let mut edges = outflows.iter().flat_map(|outflow| outflow.half.iter());
        edges.try_for_each(|edge| positive("half an edge of an outflow", *edge))?;
        self.outflows = outflows;
        Ok(())
    }

    /// Sets which particles have left: these, given in order. All others flow.
    pub(super) fn set_drained(&mut self, drained: &[u32]) {
        let mut all = std::mem::take(&mut self.flowing);
        all.append(&mut self.drained);
        all.sort_unstable();
        let is_drained = |i: &u32| drained.binary_search(i).is_ok();
        (self.drained, self.flowing) = all.into_iter().partition(is_drained);
    }

    /// Returns the numbers of the particles that have not left, in order.
    #[must_use]
    pub fn flowing(&self) -> &[u32] {
        &self.flowing
    }

    /// Returns the numbers of the particles that have left, in order.
    #[must_use]
    pub fn drained(&self) -> &[u32] {
        &self.drained
    }

    /// Returns the boxes in which particles leave.
    #[must_use]
    pub fn outflows(&self) -> &[Outflow] {
        &self.outflows
    }

    /// Returns whether particle i has left.
    #[must_use]
    pub fn has_left(&self, i: usize) -> bool {
        self.drained.binary_search(&(i as u32)).is_ok()
    }

    /// Returns whether particle i is one of these, or has left.
    #[must_use]
    pub fn contains(&self, i: usize) -> bool {
        self.flowing.binary_search(&(i as u32)).is_ok() || self.has_left(i)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix;

    /// Finds all pairs less than `reach` apart, one by one.
    fn oracle(x: &[Triple], reach: f64) -> Vec<Vec<u32>> {
        let of = |i: usize| {
            let near = |j: &usize| *j != i && squared_distance(&x[i], &x[*j]) < reach * reach;
            (0..x.len()).filter(near).map(|j| j as u32).collect()
        };
        (0..x.len()).map(of).collect()
    }

    fn found(neighbours: &Neighbours, x: &[Triple], reach: f64, parallel: bool) -> Vec<Vec<u32>> {
        let mut all = vec![vec![]; x.len()];
        neighbours.map(&mut all, parallel, |i, near| {
            let is_near = |j: &&u32| squared_distance(&x[i], &x[**j as usize]) < reach * reach;
            near.iter().filter(is_near).copied().collect()
        });
        all
    }

    fn cloud(n: usize, size: [f64; 3]) -> Vec<Triple> {
        let mut random = SplitMix(9);
        (0..n).map(|_| size.map(|size| size * random.between(-1.0, 1.0))).collect()
    }

    /// In a flat cloud, a long one that is wound around the torus, and a crowd.
    #[test]
    #[cfg_attr(miri, ignore = "takes hours there")]
    fn the_grid_finds_what_all_pairs_show() {
        let far = [1e300, f64::NAN, 0.0];
        for (n, size) in
            [(1500, [1.0, 1.0, 0.0]), (700, [1e9, 0.2, 0.2]), (2000, [0.5; 3]), (1200, [0.01; 3])]
        {
            let mut x = cloud(n, size);
            x[7] = far;
            let expected = oracle(&x, 0.1);
            for parallel in [false, true] {
                let mut neighbours = Neighbours::default();
                neighbours.cover(&x, 0.1, parallel);
                assert!(found(&neighbours, &x, 0.1, parallel) == expected, "{size:?}");
            }
        }
    }

    /// Lists that were made a few small motions ago are as good as new ones.
    #[test]
    #[cfg_attr(miri, ignore = "takes hours there")]
    fn lists_hold_while_particles_move() {
        let mut x = cloud(800, [0.4; 3]);
        let mut random = SplitMix(3);
        let mut neighbours = Neighbours::default();
        let mut made = 0;
        for _ in 0..20 {
            let before = neighbours.at.clone();
            neighbours.cover(&x, 0.1, false);
            made += usize::from(neighbours.at != before);
            assert_eq!(found(&neighbours, &x, 0.1, false), oracle(&x, 0.1));
            for x in x.as_flattened_mut() {
                *x += random.between(-1e-3, 1e-3);
            }
        }
        assert!((2..15).contains(&made), "{made}");
    }
}
