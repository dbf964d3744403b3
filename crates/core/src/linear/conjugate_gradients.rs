//! Conjugate gradients, preconditioned by the inverse of each particle's own 3 x 3 block, filtered
//! as in Baraff and Witkin, *Large Steps in Cloth Simulation*, 1998: pinned particles stay, however
//! many iterations there are.

use std::array;

use super::tangent::Tangent;
use crate::columns::columns;
use crate::system::Linearized;

/// Scratch for a system of one size.
pub(crate) struct ConjugateGradients {
    r: Vec<f64>,
    z: Vec<f64>,
    p: Vec<f64>,
    q: Vec<f64>,
    /// The inverse block of each particle, in columns: xx, yy, zz, xy, xz, yz.
    inverses: [Vec<f64>; 6],
}

/// The end of an iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Solution {
    /// Number of iterations.
    pub iterations: u64,
    /// Relative residual |b - A x| / |b|.
    pub residual: f64,
    /// Whether the matrix is not positive definite: x is of no use then.
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
        }
    }

    /// Solves A x = b from x = 0 to a relative residual. b has nothing where particles are pinned.
    pub fn solve(
        &mut self,
        system: &dyn Linearized,
        tangent: &Tangent,
        b: &[f64],
        x: &mut [f64],
        tolerance: f64,
        most: u64,
    ) -> Solution {
        self.prepare(tangent);
        let Self {
            r,
            z,
            p,
            q,
            inverses,
        } = self;
        x.fill(0.0);
        r.copy_from_slice(b);
        let scale = dot(b, b).sqrt();
        let mut solution = Solution {
            iterations: 0,
            residual: if scale > 0.0 { 1.0 } else { 0.0 },
            indefinite: false,
        };
        if scale == 0.0 {
            return solution;
        }
        let mut rz = descend(0.0, [p, q], inverses, [x, r, z]).1;
        p.copy_from_slice(z);
        while solution.iterations < most && solution.residual > tolerance {
            tangent.product(system, p, q);
            let curvature = dot(p, q);
            if !(curvature > 0.0 && rz > 0.0) {
                solution.indefinite = true;
                return solution;
            }
            let (rr, next) = descend(rz / curvature, [p, q], inverses, [x, r, z]);
            solution.iterations += 1;
            solution.residual = rr.sqrt() / scale;
            let turn = next / rz;
            rz = next;
            for (p, z) in p.iter_mut().zip(&*z) {
                *p = z + turn * *p;
            }
        }
        solution
    }

    /// Inverts the blocks on the diagonal.
    fn prepare(&mut self, tangent: &Tangent) {
        let [xx, yy, zz, ..] = &mut self.inverses;
        for diagonal in [xx, yy, zz] {
            diagonal.copy_from_slice(tangent.masses());
        }
        for column in &mut self.inverses[3..] {
            column.fill(0.0);
        }
        tangent.blocks(|i, j, block| {
            let [xx, xy, xz, yx, yy, yz, zx, zy, zz] = block;
            let mean = |a: f64, b: f64| 0.5 * (a + b);
            // The blocks of a particle have a symmetric sum.
            let block = [xx, yy, zz, mean(xy, yx), mean(xz, zx), mean(yz, zy)];
            for (column, part) in self.inverses.iter_mut().zip(block) {
                column[i] += part;
                if j != i {
                    column[j] += part;
                }
            }
        });
        for (i, m) in tangent.masses().iter().enumerate() {
            let block = array::from_fn(|k| self.inverses[k][i]);
            let inverse = if *m == 0.0 { [0.0; 6] } else { inverse(block) };
            for (column, part) in self.inverses.iter_mut().zip(inverse) {
                column[i] = part;
            }
        }
    }
}

/// Number of particles in a block, which stays in the nearest cache.
const BLOCK: usize = 256;

/// Takes a step along p: x += step p, r -= step q, z = B^-1 r. Returns r . r and r . z of the new
/// ones.
fn descend(
    step: f64,
    [p, q]: [&[f64]; 2],
    inverses: &[Vec<f64>; 6],
    [x, r, z]: [&mut [f64]; 3],
) -> (f64, f64) {
    let n = p.len() / 3;
    let (mut rr, mut rz) = (0.0, 0.0);
    for start in (0..n).step_by(BLOCK) {
        let block = start..n.min(start + BLOCK);
        for axis in 0..3 {
            let part = axis * n + block.start..axis * n + block.end;
            let (x, p) = (&mut x[part.clone()], &p[part.clone()]);
            for (x, p) in x.iter_mut().zip(p) {
                *x += step * p;
            }
            let (r, q) = (&mut r[part.clone()], &q[part]);
            for (r, q) in r.iter_mut().zip(q) {
                *r -= step * q;
            }
            rr += dot(r, r);
        }
        let [rx, ry, rw] = columns(r, &block);
        for (axis, k) in [[0, 3, 4], [3, 1, 5], [4, 5, 2]].into_iter().enumerate() {
            let [a, b, c] = k.map(|k| &inverses[k][block.clone()]);
            let z = &mut z[axis * n + block.start..axis * n + block.end];
            let of_r = rx.iter().zip(ry).zip(rw);
            for ((z, ((x, y), w)), ((a, b), c)) in
                z.iter_mut().zip(of_r).zip(a.iter().zip(b).zip(c))
            {
                *z = a * x + b * y + c * w;
            }
            rz += dot([rx, ry, rw][axis], z);
        }
    }
    (rr, rz)
}

/// The scalar product, in sixteen sums that do not wait for one another.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 16];
    let (blocks, rest) = a.as_chunks::<16>();
    let (others, other_rest) = b.as_chunks::<16>();
    for (a, b) in blocks.iter().zip(others) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    let rest = rest.iter().zip(other_rest).map(|(a, b)| a * b);
    sums.into_iter().chain(rest).sum()
}

/// The inverse of a symmetric block; if that is not positive definite, of the absolute values on
/// its diagonal.
fn inverse([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> [f64; 6] {
    let minor = xx * yy - xy * xy;
    let (a, b, c) = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
    let determinant = xx * a + xy * b + xz * c;
    if xx > 0.0 && minor > 0.0 && determinant > 0.0 {
        let d = 1.0 / determinant;
        [
            a * d,
            (xx * zz - xz * xz) * d,
            minor * d,
            b * d,
            c * d,
            (xy * xz - xx * yz) * d,
        ]
    } else {
        let size = |k: f64| 1.0 / k.abs().max(f64::MIN_POSITIVE);
        [size(xx), size(yy), size(zz), 0.0, 0.0, 0.0]
    }
}
