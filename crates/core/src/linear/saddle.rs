//! The system of an implicit step with constraints: A dv - JT dl = r, J dv = c, for changes of the
//! velocities and of the impulses l of the constraints. The matrix [[A, -JT], [-J, -e]], with a
//! tiny e that makes up for constraints that depend on others, is factorised as L S LT with signs
//! S: the row of a constraint follows those of its particles, so that a chain of n rods takes time
//! proportional to n (Vanderbei, *Symmetric quasidefinite matrices*, SIAM J. Optim. 5, 1995).

use nalgebra::Matrix3;

use super::direct::{OVERHEAD, fill, prices};
use super::tangent::Tangent;
use crate::cholesky::{Block, Factor, Pattern, Place};
use crate::held::Joint;

/// The addition e over an upper bound of J A^-1 JT.
const SOFTNESS: f64 = 1e-12;

/// Factorisation of the matrix of a step with constraints.
pub(crate) struct Saddle {
    pattern: Pattern,
    factor: Factor<3, 4>,
    /// Place of the block of each coupling in the matrix.
    places: Vec<Place>,
    /// Places of the blocks of each constraint: of its ends, and of each end with it.
    ties: Vec<[Place; 3]>,
    /// Identifier of the pattern of the couplings.
    couplings: u64,
    /// Prices of a factorisation and of a solve, in evaluations of forces spring by spring.
    pub prices: [f64; 2],
}

impl Saddle {
    /// Analyses the pattern of a tangent with constraints; `None` if memory is insufficient.
    pub fn new(tangent: &Tangent, joints: &[Joint]) -> Option<Self> {
        let n = tangent.particles();
        let ends: Vec<_> = joints
            .iter()
            .map(|joint| joint.ends.map(|end| end as u32))
            .collect();
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
        let Self {
            pattern,
            factor,
            places,
            ties,
            ..
        } = self;
        fill(tangent, pattern, factor, places);
        let n = tangent.particles();
        let is_free = |i: usize| tangent.masses()[i] != 0.0;
        let [xx, yy, zz, ..] = tangent.diagonal();
        for (k, ((joint, impulses), ties)) in joints
            .iter()
            .zip(impulses.as_chunks::<3>().0)
            .zip(ties)
            .enumerate()
        {
            let pushes = joint.count > 0 && impulses[joint.count - 1] > 0.0;
            let bent = if pushes && clamped {
                Matrix3::zeros()
            } else {
                joint.turning(impulses) * -a
            };
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
        let Self {
            pattern, factor, ..
        } = self;
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
