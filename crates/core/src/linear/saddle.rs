//! The system of an implicit step with constraints: A dv - JT dl = r, J dv = c, for changes of the
//! velocities and of the impulses l of the constraints. The matrix [[A, -JT], [-J, -e]], with a
//! tiny e that makes up for constraints that depend on others, is factorised as L S LT with signs
//! S: the row of a constraint follows those of its particles, so that a chain of n rods takes time
//! proportional to n (Vanderbei, *Symmetric quasidefinite matrices*, SIAM J. Optim. 5, 1995).
//!
//! The factorisation of a matrix by 3 x 3 blocks, one for each particle and each coupling, with its
//! price. Pinned particles keep rows of the identity, so that pinning one changes no pattern.

use nalgebra::Matrix3;

use super::tangent::Tangent;
use crate::cholesky::{Block, BlockPlace, Factor, Pattern};
use crate::held::Joint;

/// The addition e over an upper bound of J A^-1 JT.
const SOFTNESS: f64 = 1e-12;

/// Factorisation of the matrix of a step with constraints.
pub(crate) struct Saddle {
    pattern: Pattern,
    factor: Factor<3, 4>,
    /// Place of the block of each coupling in the matrix.
    places: Vec<BlockPlace>,
    /// Places of the blocks of each constraint: of its ends, and of each end with it.
    ties: Vec<[BlockPlace; 3]>,
    /// Identifier of the pattern of the couplings.
    couplings: u64,
    /// Prices of a factorisation and of a solve, in evaluations of forces spring by spring.
    pub prices: [f64; 2],
}

impl Saddle {
    /// Analyses the pattern of a tangent with constraints; `None` if memory is insufficient.
    pub fn new(tangent: &Tangent, joints: &[Joint]) -> Option<Self> {
        let n = tangent.particles();
        let ends: Vec<_> = joints.iter().map(|joint| joint.ends.map(|end| end as u32)).collect();
        let pattern = Pattern::tied(n, tangent.pairs(), &ends)?;
        let mut factor = Factor::new(&pattern)?;
        (n..n + ends.len()).for_each(|row| factor.set_negative(&pattern, row));
        let ties = ends.iter().zip(n as u32..).map(|([i, j], tie)| {
            [[*i, *j], [*i, tie], [*j, tie]].map(|[row, column]| pattern.place(row, column))
        });
        let couplings = (tangent.couplings() + joints.len()) as f64 + OVERHEAD;
        Some(Self {
            factor,
            places: tangent.pairs().map(|[i, j]| pattern.place(i, j)).collect(),
            ties: ties.collect(),
            couplings: tangent.pattern(),
            prices: prices(&pattern, couplings),
            pattern,
        })
    }

    /// Returns whether the couplings are still those of the pattern.
    pub fn fits(&self, tangent: &Tangent) -> bool {
        self.couplings == tangent.pattern()
    }

    /// Factorises the matrix, with the joints' impulses (N s) in steps of length a (s). With
    /// `clamped`, impulses that push are left out of A. Returns whether A is positive definite.
    pub fn factorise(
        &mut self,
        tangent: &Tangent,
        joints: &[Joint],
        impulses: &[f64],
        (a, clamped): (f64, bool),
    ) -> bool {
        let Self { pattern, factor, places, ties, .. } = self;
        fill(tangent, pattern, factor, places);
        let n = tangent.particles();
        let is_free = |i: usize| tangent.masses()[i] != 0.0;
        let [xx, yy, zz, ..] = tangent.diagonal();
        for (k, ((joint, impulses), ties)) in
            joints.iter().zip(impulses.as_chunks::<3>().0).zip(ties).enumerate()
        {
            let pushes = joint.count > 0 && impulses[joint.count - 1] > 0.0;
            let bent =
                if pushes && clamped { Matrix3::zeros() } else { joint.turning(impulses) * -a };
            let mut softness = 0.0;
            for ((i, sign), place) in joint.parts().zip(&ties[1..]) {
                if !is_free(i) {
                    continue;
                }
                softness += 3.0 / (xx[i] + yy[i] + zz[i]).abs();
                add(factor.diagonal_mut(pattern, i), &bent);
                let block = factor.block_mut(*place);
                for (row, gradient) in joint.gradients[..joint.count].iter().enumerate() {
                    for (axis, column) in block[..3].iter_mut().enumerate() {
                        column[row] = -sign * gradient[axis];
                    }
                }
            }
            if joint.ends[0] != joint.ends[1] && joint.ends.iter().all(|end| is_free(*end)) {
                add(factor.block_mut(ties[0]), &-bent);
            }
            let diagonal = factor.diagonal_mut(pattern, n + k);
            for (row, column) in diagonal.iter_mut().enumerate() {
                let holds = row < joint.count && softness > 0.0;
                column[row] = if holds { -SOFTNESS * softness } else { -1.0 };
            }
        }
        factor.factorise(pattern)
    }

    /// Solves with the factor: writes the changes of velocities, n x 3, and of impulses.
    pub fn solve(&mut self, [r, c]: [&[f64]; 2], dv: &mut [f64], dl: &mut [f64]) {
        let Self { pattern, factor, .. } = self;
        let n = r.len() / 3;
        for i in 0..n {
            *factor.unknowns_mut(pattern, i) = [r[i], r[n + i], r[2 * n + i], 0.0];
        }
        for (k, c) in c.as_chunks::<3>().0.iter().enumerate() {
            *factor.unknowns_mut(pattern, n + k) = [-c[0], -c[1], -c[2], 0.0];
        }
        factor.solve(pattern);
        for i in 0..n {
            [dv[i], dv[n + i], dv[2 * n + i], _] = *factor.unknowns_mut(pattern, i);
        }
        for (k, dl) in dl.as_chunks_mut::<3>().0.iter_mut().enumerate() {
            let [x, y, z, _] = *factor.unknowns_mut(pattern, n + k);
            *dl = [x, y, z];
        }
    }
}

/// Adds a matrix to a block.
fn add(block: &mut Block<3, 4>, matrix: &Matrix3<f64>) {
    for (c, column) in block.iter_mut().enumerate() {
        for (r, sum) in column[..3].iter_mut().enumerate() {
            *sum += matrix[(r, c)];
        }
    }
}

/// Prices of a column and of a product of two blocks in a factorisation, in evaluations of forces
/// spring by spring over the number of couplings. Measured on chains and cloths (see the tests).
const FACTORISATION: [f64; 2] = [10.0, 0.9];
/// Prices of a column and of a block below the diagonal in a solve, in the same unit.
const SOLUTION: [f64; 2] = [3.0, 2.0];
/// Largest number of blocks in a factor (48 MB), and largest number for each particle in a larger
/// factor, which any tree meets. Nets with larger factors are solved faster by iterations.
const MAX_BLOCKS: [usize; 2] = [500_000, 2];
/// Fixed overhead of an evaluation, in evaluations of a coupling.
const OVERHEAD: f64 = 10.0;

/// Returns the price of a factorisation with a number of products of blocks for each coupling, in
/// evaluations of forces spring by spring.
pub(super) fn price_of_products(products: f64) -> f64 {
    FACTORISATION[1] * products
}

/// Returns the prices of a factorisation of a pattern, and of a solve with it, in evaluations of
/// forces spring by spring of that many couplings.
pub(super) fn prices(pattern: &Pattern, couplings: f64) -> [f64; 2] {
    let columns = pattern.len() as f64 / couplings;
    [
        FACTORISATION[0] * columns + price_of_products(pattern.products() / couplings),
        SOLUTION[0] * columns + SOLUTION[1] * pattern.size() as f64 / couplings,
    ]
}

/// Factorisation of a matrix whose pattern was analysed.
pub(super) struct Direct {
    pattern: Pattern,
    factor: Factor<3, 4>,
    /// Place of the block of each coupling in the matrix.
    places: Vec<BlockPlace>,
    /// Identifier of the pattern of the couplings.
    couplings: u64,
    /// Price of a factorisation, in evaluations of forces spring by spring.
    pub factorisation: f64,
    /// Price of a solve with the factor, in evaluations of forces spring by spring.
    pub solution: f64,
}

impl Direct {
    /// Analyses the pattern of a tangent; `None` if the factor would be too large.
    pub fn new(tangent: &Tangent) -> Option<Self> {
        let n = tangent.particles();
        let pattern = Pattern::new(n, tangent.pairs(), MAX_BLOCKS[0].max(MAX_BLOCKS[1] * n))?;
        let couplings = tangent.couplings() as f64 + OVERHEAD;
        let [factorisation, solution] = prices(&pattern, couplings);
        Some(Self {
            factor: Factor::new(&pattern)?,
            places: tangent.pairs().map(|[i, j]| pattern.place(i, j)).collect(),
            couplings: tangent.pattern(),
            factorisation,
            solution,
            pattern,
        })
    }

    /// Returns whether the couplings are still those of the pattern.
    pub fn fits(&self, tangent: &Tangent) -> bool {
        self.couplings == tangent.pattern()
    }

    /// Factorises A. Returns whether it is positive definite.
    pub fn factorise(&mut self, tangent: &Tangent) -> bool {
        fill(tangent, &self.pattern, &mut self.factor, &self.places);
        self.factor.factorise(&self.pattern)
    }

    /// Solves A x = b with the factor.
    pub fn solve(&mut self, b: &[f64], x: &mut [f64]) {
        let Self { pattern, factor, .. } = self;
        let n = pattern.len();
        for i in 0..n {
            *factor.unknowns_mut(pattern, i) = [b[i], b[n + i], b[2 * n + i], 0.0];
        }
        factor.solve(pattern);
        for i in 0..n {
            [x[i], x[n + i], x[2 * n + i], _] = *factor.unknowns_mut(pattern, i);
        }
    }
}

/// Writes the blocks of a tangent to their places in a factor that is otherwise zero.
pub(super) fn fill(
    tangent: &Tangent,
    pattern: &Pattern,
    factor: &mut Factor<3, 4>,
    places: &[BlockPlace],
) {
    factor.clear();
    let masses = tangent.masses();
    for (i, m) in masses.iter().enumerate() {
        let m = if *m == 0.0 { 1.0 } else { *m };
        let diagonal = factor.diagonal_mut(pattern, i);
        for (axis, column) in diagonal.iter_mut().enumerate() {
            column[axis] = m;
        }
    }
    let mut places = places.iter();
    tangent.blocks(|i, j, block| {
        let Some(place) = places.next().filter(|_| i != j) else {
            return;
        };
        let at = |row: usize, column: usize| block[3 * row + column];
        for end in [i, j] {
            if masses[end] != 0.0 {
                // The sum of the blocks of a particle is symmetric.
                let half = |r, c| 0.5 * (at(r, c) + at(c, r));
                add_by(factor.diagonal_mut(pattern, end), half);
            }
        }
        if masses[i] != 0.0 && masses[j] != 0.0 {
            let block = factor.block_mut(*place);
            if place.transposed {
                add_by(block, |r, c| -at(c, r));
            } else {
                add_by(block, |r, c| -at(r, c));
            }
        }
    });
}

/// Adds numbers by row and column to a block.
fn add_by(block: &mut Block<3, 4>, number: impl Fn(usize, usize) -> f64) {
    for (c, column) in block.iter_mut().enumerate() {
        for (r, sum) in column[..3].iter_mut().enumerate() {
            *sum += number(r, c);
        }
    }
}
