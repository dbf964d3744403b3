//! Conjugate gradients, preconditioned by the inverse of each particle's own 3 x 3 block and by
//! multigrid where that pays; for damping alone, by the masses. They are filtered as in Baraff and
//! Witkin, *Large Steps in Cloth Simulation*, 1998, so that pinned particles stay exactly. The sum
//! of both preconditioners is a preconditioner, too (Bramble, Pasciak, Xu, *Parallel multilevel
//! preconditioners*, 1990), and takes no further product with the matrix.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::array;
use std::ops::Range;

use super::multigrid::Multigrid;
use super::tangent::{Tangent, inverse};
use crate::columns::{columns, columns_mut};
use crate::sums;
use crate::sums::{OnBlock, dot};
use crate::system::Linearized;
use crate::threads::{Columns, threads};

/// Largest number of iterations.
pub(super) const MAX_ITERATIONS: u64 = 10_000;
/// Number of particles in a block, whose numbers fit into the first-level cache.
const BLOCK: usize = 256;

/// Scratch for a system of one size.
pub(crate) struct ConjugateGradients {
    r: Vec<f64>,
    z: Vec<f64>,
    p: Vec<f64>,
    q: Vec<f64>,
    /// Inverse block of each particle, in columns.
    inverses: [Vec<f64>; 6],
    /// Version of the tangent of these blocks.
    version: u64,
}

/// Result of a solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Solution {
    /// Number of iterations.
    pub iterations: u64,
    /// Relative residual |b - A x| / |b|.
    pub residual: f64,
    /// Whether the matrix is not positive definite. x is then meaningless.
    pub indefinite: bool,
}

impl ConjugateGradients {
    pub fn new(particles: usize) -> Self {
        let zeros = || vec![0.0; 3 * particles];
        Self {
            r: zeros(),
            z: zeros(),
            p: zeros(),
            q: zeros(),
            inverses: array::from_fn(|_| vec![0.0; particles]),
            version: 0,
        }
    }

    /// Solves A x = b from x = 0 to a relative residual. b is 0 on pinned particles.
    pub fn solve(
        &mut self,
        system: &dyn Linearized,
        (tangent, mut multigrid): (&Tangent, Option<&mut Multigrid>),
        b: &[f64],
        x: &mut [f64],
        (tolerance, most): (f64, u64),
    ) -> Solution {
        self.prepare(tangent);
        x.fill(0.0);
        self.p.fill(0.0);
        self.q.fill(0.0);
        self.r.copy_from_slice(b);
        let [rr, mut rz] = self.descend(0.0, multigrid.as_deref_mut());
        let scale = rr.sqrt();
        let mut solution = Solution {
            iterations: 0,
            residual: if scale > 0.0 { 1.0 } else { 0.0 },
            indefinite: false,
        };
        self.turn([0.0; 2], x, multigrid.as_deref());
        while solution.iterations < most && solution.residual > tolerance {
            tangent.product(system, &self.p, &mut self.q);
            let curvature = self.curvature();
            if !(curvature > 0.0 && rz > 0.0) {
                solution.indefinite = true;
                return solution;
            }
            let step = rz / curvature;
            let [rr, next] = self.descend(step, multigrid.as_deref_mut());
            solution.iterations += 1;
            solution.residual = rr.sqrt() / scale;
            self.turn([step, next / rz], x, multigrid.as_deref());
            rz = next;
        }
        solution
    }

    /// Inverts the blocks on the diagonal, if they have changed.
    fn prepare(&mut self, tangent: &Tangent) {
        if self.version == tangent.version() {
            return;
        }
        self.version = tangent.version();
        let diagonal = tangent.diagonal();
        for (i, m) in tangent.masses().iter().enumerate() {
            let inverse = if *m == 0.0 {
                [0.0; 6]
            } else if tangent.is_only_damping() {
                let w = 1.0 / m;
                [w, w, w, 0.0, 0.0, 0.0]
            } else {
                inverse(diagonal.map(|column| column[i]))
            };
            for (column, part) in self.inverses.iter_mut().zip(inverse) {
                column[i] = part;
            }
        }
    }

    /// Returns p . q, with q = A p.
    fn curvature(&mut self) -> f64 {
        let Self { p, q, .. } = self;
        let [sum] = add_up(p.len() / 3, [], &Product { p, q });
        sum
    }

    /// Updates the residual after a step along p, r -= step q. Returns r . r and r . z, where z is
    /// the preconditioned residual.
    fn descend(&mut self, step: f64, multigrid: Option<&mut Multigrid>) -> [f64; 2] {
        let Self { r, z, q, inverses, .. } = self;
        let ([a, b, c], [d, e, f]) = (columns_mut(r), columns_mut(z));
        let task = Descent { step, q, inverses };
        let [rr, rz] = add_up(q.len() / 3, [a, b, c, d, e, f], &task);
        [rr, rz + multigrid.map_or(0.0, |multigrid| multigrid.solve(r))]
    }

    /// Takes a step, x += step p, and forms the next direction, p = z + turn p.
    fn turn(&mut self, [step, turn]: [f64; 2], x: &mut [f64], multigrid: Option<&Multigrid>) {
        let Self { z, p, .. } = self;
        let ([a, b, c], [d, e, f]) = (columns_mut(x), columns_mut(p));
        let task = TurnTask { step, share: turn, z, multigrid };
        add_up(z.len() / 3, [a, b, c, d, e, f], &task);
    }
}

/// Runs a task on blocks of particles, each with its part of the columns, and adds up its results.
fn add_up<const N: usize, const M: usize>(
    particles: usize,
    columns: Columns<N>,
    task: &impl OnBlock<N, M>,
) -> [f64; M] {
    sums::add_up(threads(particles), 0..particles, BLOCK, columns, task)
}

struct Product<'a> {
    p: &'a [f64],
    q: &'a [f64],
}

impl OnBlock<0, 1> for Product<'_> {
    #[inline(always)]
    fn run(&self, particles: Range<usize>, []: Columns<0>) -> [f64; 1] {
        let [p, q] = [self.p, self.q].map(|a| columns(a, &particles));
        [p.into_iter().zip(q).map(|(p, q)| dot(p, q)).sum()]
    }
}

struct Descent<'a> {
    step: f64,
    q: &'a [f64],
    inverses: &'a [Vec<f64>; 6],
}

impl OnBlock<6, 2> for Descent<'_> {
    #[inline(always)]
    fn run(&self, particles: Range<usize>, [a, b, c, d, e, f]: Columns<6>) -> [f64; 2] {
        let (mut r, mut z) = ([a, b, c], [d, e, f]);
        for (r, q) in r.iter_mut().zip(columns(self.q, &particles)) {
            for (r, q) in r.iter_mut().zip(q) {
                *r -= self.step * q;
            }
        }
        let r = r.each_ref().map(|r| &**r);
        precondition(self.inverses, &particles, r, &mut z);
        let rr = r.iter().map(|r| dot(r, r)).sum();
        [rr, r.iter().zip(&z).map(|(r, z)| dot(r, z)).sum()]
    }
}

struct TurnTask<'a> {
    step: f64,
    /// Factor of the old direction in the new one.
    share: f64,
    z: &'a [f64],
    multigrid: Option<&'a Multigrid>,
}

impl OnBlock<6, 0> for TurnTask<'_> {
    #[inline(always)]
    fn run(&self, particles: Range<usize>, [a, b, c, d, e, f]: Columns<6>) -> [f64; 0] {
        let (x, mut p, z) = ([a, b, c], [d, e, f], columns(self.z, &particles));
        for ((x, p), z) in x.into_iter().zip(&mut p).zip(z) {
            for ((x, p), z) in x.iter_mut().zip(&mut **p).zip(z) {
                *x += self.step * *p;
                *p = z + self.share * *p;
            }
        }
        if let Some(multigrid) = self.multigrid {
            for (k, i) in particles.enumerate() {
                for (p, z) in p.iter_mut().zip(multigrid.solution(i)) {
                    p[k] += z;
                }
            }
        }
        []
    }
}

/// Writes z = B^-1 r on a block of particles.
#[inline(always)]
fn precondition(
    inverses: &[Vec<f64>; 6],
    block: &Range<usize>,
    [rx, ry, rz]: [&[f64]; 3],
    z: &mut [&mut [f64]; 3],
) {
    for (z, k) in z.iter_mut().zip([[0, 3, 4], [3, 1, 5], [4, 5, 2]]) {
        let [a, b, c] = k.map(|k| &inverses[k][block.clone()]);
        let of_r = rx.iter().zip(ry).zip(rz);
        for ((z, ((x, y), w)), ((a, b), c)) in z.iter_mut().zip(of_r).zip(a.iter().zip(b).zip(c)) {
            *z = a * x + b * y + c * w;
        }
    }
}
