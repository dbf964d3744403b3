//! Conjugate gradients, preconditioned by the inverse of each particle's own 3 x 3 block, filtered as in Baraff and
//! Witkin, *Large Steps in Cloth Simulation*, 1998: what is pinned stays as it is, however many iterations there are.

use super::tangent::Tangent;
use crate::system::Mechanics;

/// Scratch for a system of one size.
pub(crate) struct ConjugateGradients {
    r: Vec<f64>,
    z: Vec<f64>,
    p: Vec<f64>,
    q: Vec<f64>,
    /// The inverse block of each particle: xx, yy, zz, xy, xz, yz.
    inverses: Vec<[f64; 6]>,
}

/// How it ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Solution {
    pub iterations: u64,
    /// |b - A x| / |b|
    pub residual: f64,
    /// The matrix is not positive definite, and x is of no use.
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
            inverses: vec![[0.0; 6]; particles],
        }
    }

    /// Solves A x = b from x = 0 to a relative residual. b has nothing where particles are pinned.
    pub fn solve(
        &mut self,
        mechanics: &dyn Mechanics,
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
        precondition(inverses, r, z);
        p.copy_from_slice(z);
        let mut rz = dot(r, z);
        while solution.iterations < most && solution.residual > tolerance {
            tangent.product(mechanics, p, q);
            let curvature = dot(p, q);
            if !(curvature > 0.0 && rz > 0.0) {
                solution.indefinite = true;
                return solution;
            }
            let step = rz / curvature;
            for (((x, r), p), q) in x.iter_mut().zip(&mut *r).zip(&*p).zip(&*q) {
                *x += step * p;
                *r -= step * q;
            }
            solution.iterations += 1;
            solution.residual = dot(r, r).sqrt() / scale;
            precondition(inverses, r, z);
            let next = dot(r, z);
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
        let blocks = &mut self.inverses;
        for (i, block) in blocks.iter_mut().enumerate() {
            let m = tangent.mass(i);
            *block = [m, m, m, 0.0, 0.0, 0.0];
        }
        for (i, j, block) in tangent.blocks() {
            for end in [i, j] {
                for (sum, part) in blocks[end].iter_mut().zip(block) {
                    *sum += part;
                }
            }
        }
        for (i, block) in blocks.iter_mut().enumerate() {
            *block = if tangent.mass(i) == 0.0 {
                [0.0; 6]
            } else {
                inverse(*block)
            };
        }
    }
}

/// In sixteen sums, which do not wait for one another.
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

/// z = B^-1 r
fn precondition(inverses: &[[f64; 6]], r: &[f64], z: &mut [f64]) {
    let n = inverses.len();
    let (rx, rest) = r.split_at(n);
    let (ry, rz) = rest.split_at(n);
    let (zx, rest) = z.split_at_mut(n);
    let (zy, zz) = rest.split_at_mut(n);
    for (i, [xx, yy, zz_, xy, xz, yz]) in inverses.iter().enumerate() {
        let (a, b, c) = (rx[i], ry[i], rz[i]);
        zx[i] = xx * a + xy * b + xz * c;
        zy[i] = xy * a + yy * b + yz * c;
        zz[i] = xz * a + yz * b + zz_ * c;
    }
}

/// Of a symmetric block; if that is not positive definite, of its diagonal's sizes.
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
