//! Multigrid by aggregation: neighbouring particles that move together form aggregates, and so do
//! neighbouring aggregates on the next level. Coarser levels solve for motion over long distances,
//! for which conjugate gradients preconditioned by each particle alone take many iterations. Only
//! couplings are used, so that grids, jellies, meshes and lists of springs are all served.

mod aggregates;
mod level;
mod lists;

use super::tangent::Tangent;
use aggregates::Graph;
use level::Level;

/// Largest number of aggregates on the coarsest level.
const MAX_COARSEST: usize = 16;

/// The coarser levels of a matrix whose pattern was analysed.
pub(super) struct Multigrid {
    levels: Vec<Level>,
    /// Pattern of the couplings, and the free particles.
    pattern: u64,
    free: Vec<f64>,
    /// Version of the tangent whose matrix was prepared.
    version: u64,
}

impl Multigrid {
    /// Creates the levels for the pattern of a tangent; none if the particles form no aggregates.
    pub fn new(tangent: &Tangent) -> Self {
        let ends: Vec<_> = tangent.pairs().collect();
        let mut graph = Graph {
            particles: tangent.particles(),
            // Aggregates depend on the pattern alone: stiffness may depend on positions, and a run
            // that is resumed elsewhere has to form the same aggregates.
            strengths: vec![1.0; ends.len()],
            ends,
        };
        let mut levels: Vec<Level> = vec![];
        while graph.particles > MAX_COARSEST {
            let is_free = |i: u32| !levels.is_empty() || tangent.masses()[i as usize] != 0.0;
            let Some((level, coarser)) = Level::new(&graph, is_free) else {
                break;
            };
            levels.push(level);
            graph = coarser;
        }
        Self { levels, pattern: tangent.pattern(), free: tangent.free().to_vec(), version: 0 }
    }

    /// Returns whether the pattern and the pinned particles are the same.
    pub fn fits(&self, tangent: &Tangent) -> bool {
        self.pattern == tangent.pattern() && self.free == tangent.free()
    }

    /// Prepares the levels for the matrix. Returns whether it has changed.
    pub fn prepare(&mut self, tangent: &Tangent) -> bool {
        if self.version == tangent.version() {
            return false;
        }
        self.version = tangent.version();
        let Some((first, rest)) = self.levels.split_first_mut() else {
            return true;
        };
        first.clear();
        for (i, m) in tangent.masses().iter().enumerate() {
            first.add_own(i, &[*m, *m, *m, 0.0, 0.0, 0.0]);
        }
        let mut coupling = 0;
        tangent.symmetric_blocks(|i, j, block| {
            first.add_coupling(coupling, [i as u32, j as u32], &block);
            coupling += 1;
        });
        first.finish();
        let mut finer = first;
        for level in rest {
            level.clear();
            for (i, own) in finer.own.iter().enumerate() {
                level.add_own(i, own);
            }
            for (k, (ends, coupling)) in finer.ends.iter().zip(&finer.couplings).enumerate() {
                level.add_coupling(k, *ends, coupling);
            }
            level.finish();
            finer = level;
        }
        true
    }

    /// Solves for the motion of aggregates approximately, from residuals r, n x 3. Returns the
    /// scalar product of r and the solution.
    pub fn solve(&mut self, r: &[f64]) -> f64 {
        let Some(first) = self.levels.first_mut() else {
            return 0.0;
        };
        let n = r.len() / 3;
        first.restrict(|i| [r[i], r[n + i], r[2 * n + i]]);
        cycle(&mut self.levels);
        let first = &self.levels[0];
        first.r.as_flattened().iter().zip(first.z.as_flattened()).map(|(r, z)| r * z).sum()
    }

    /// Returns the solution at a particle.
    #[inline]
    pub fn solution(&self, i: usize) -> [f64; 3] {
        self.levels.first().map_or([0.0; 3], |first| first.prolong(i))
    }
}

/// Runs one cycle from fine to coarse and back (a V-cycle).
fn cycle(levels: &mut [Level]) {
    let Some((level, coarser)) = levels.split_first_mut() else {
        return;
    };
    level.descend();
    if let Some(next) = coarser.first_mut() {
        next.restrict(|i| level.left[i]);
        cycle(coarser);
        for (i, z) in level.z.iter_mut().enumerate() {
            let found = coarser[0].prolong(i);
            for (z, found) in z.iter_mut().zip(found) {
                *z += found;
            }
        }
    }
    level.ascend();
}

#[cfg(test)]
mod tests;
