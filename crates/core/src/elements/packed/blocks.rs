//! Blocks of springs, and what is summed over them. What is plain code here is compiled for the
//! processor's vectors, because it is inlined into `pulp`'s dispatch.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use pulp::{Scalar, Simd, WithSimd};

use crate::elements::inverse_root::inverse_root;
use crate::spring::Spring;

/// Springs of a block: what is kept of them between the passes over it stays in the nearest cache.
pub(super) const BLOCK: usize = 64;

/// Three numbers of a particle and a zero.
pub(super) type Numbers = [f64; 4];

/// Springs one after another. A block that is not full ends with springs from a particle to itself,
/// without stiffness.
#[derive(Clone, Debug)]
pub(super) struct Block {
    ends: [[u32; 2]; BLOCK],
    /// k (N/m).
    stiffness: [f64; BLOCK],
    /// k r (N).
    push: [f64; BLOCK],
    /// c (N s/m).
    damping: [f64; BLOCK],
}

impl Block {
    /// Block of no springs at that particle.
    pub fn empty(particle: u32) -> Self {
        Self {
            ends: [[particle; 2]; BLOCK],
            stiffness: [0.0; BLOCK],
            push: [0.0; BLOCK],
            damping: [0.0; BLOCK],
        }
    }

    /// Makes spring m that one, between these particles.
    pub fn set(&mut self, m: usize, ends: [u32; 2], spring: &Spring) {
        let law = spring.law;
        self.ends[m] = ends;
        self.stiffness[m] = law.stiffness;
        self.push[m] = law.stiffness * law.rest_length;
        self.damping[m] = law.damping;
    }

    /// The ends of spring m among the particles from the `first` on.
    #[inline(always)]
    fn ends(&self, m: usize, first: usize) -> [usize; 2] {
        self.ends[m].map(|i| (i as usize).wrapping_sub(first))
    }
}

/// The forces of blocks of springs, added to f: of x and v, or their change by dx and dv. All are
/// of the particles from the `first` on.
pub(super) struct Sum<'a> {
    pub blocks: &'a [Block],
    pub first: usize,
    pub fields: [&'a [Numbers]; 4],
    pub f: &'a mut [Numbers],
    pub is_damped: bool,
    pub is_differential: bool,
}

impl WithSimd for Sum<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        match (self.is_differential, self.is_damped) {
            (false, false) => forces::<false>(self),
            (false, true) => forces::<true>(self),
            (true, false) => differential::<false>(self),
            (true, true) => differential::<true>(self),
        }
    }
}

/// With d = xi - xj and w = vi - vj, the force on i is -s d with s = k - k r / L + c (w . d) / L^2.
#[inline(always)]
fn forces<const DAMPED: bool>(sum: Sum) {
    let Sum {
        blocks, first, f, ..
    } = sum;
    let [x, v, ..] = sum.fields;
    let mut d = [[0.0; 4]; BLOCK];
    let (mut s, mut rate) = ([0.0; BLOCK], [0.0; BLOCK]);
    for block in blocks {
        for m in 0..BLOCK {
            let ends = block.ends(m, first);
            d[m] = apart(x, ends);
            s[m] = dot(d[m], d[m]);
            if DAMPED {
                rate[m] = dot(apart(v, ends), d[m]);
            }
        }
        for m in 0..BLOCK {
            let inverse = inverse(s[m]);
            s[m] = (-block.push[m]).mul_add(inverse, block.stiffness[m]);
            if DAMPED {
                s[m] = (block.damping[m] * rate[m] * inverse).mul_add(inverse, s[m]);
            }
        }
        for m in 0..BLOCK {
            let [i, j] = block.ends(m, first);
            f[i] = plus(f[i], -s[m], d[m]);
            f[j] = plus(f[j], s[m], d[m]);
        }
    }
}

/// With e = dxi - dxj, dw = dvi - dvj and p = (e - d (d . e) / L^2) / L, the change of the force on
/// i is -(s e + (k - s) d (d . e) / L^2) - c (((dw . d) / L + w . p) d + (w . d) p) / L, where s is
/// k - k r / L; that is -(a e + b d).
#[inline(always)]
fn differential<const DAMPED: bool>(sum: Sum) {
    let Sum {
        blocks, first, f, ..
    } = sum;
    let [x, v, dx, dv] = sum.fields;
    let (mut d, mut e) = ([[0.0; 4]; BLOCK], [[0.0; 4]; BLOCK]);
    let (mut a, mut b) = ([0.0; BLOCK], [0.0; BLOCK]);
    let [mut wd, mut we, mut gd] = [[0.0; BLOCK]; 3];
    for block in blocks {
        for m in 0..BLOCK {
            let ends = block.ends(m, first);
            (d[m], e[m]) = (apart(x, ends), apart(dx, ends));
            (a[m], b[m]) = (dot(d[m], d[m]), dot(d[m], e[m]));
            if DAMPED {
                let w = apart(v, ends);
                (wd[m], we[m]) = (dot(w, d[m]), dot(w, e[m]));
                gd[m] = dot(apart(dv, ends), d[m]);
            }
        }
        for m in 0..BLOCK {
            let (inverse, k) = (inverse(a[m]), block.stiffness[m]);
            let s = (-block.push[m]).mul_add(inverse, k);
            let share = b[m] * inverse * inverse;
            (a[m], b[m]) = (s, (k - s) * share);
            if DAMPED {
                let c = block.damping[m] * inverse * inverse;
                let rate = gd[m] + (-wd[m]).mul_add(share, we[m]);
                a[m] = c.mul_add(wd[m], a[m]);
                b[m] = c.mul_add((-wd[m]).mul_add(share, rate), b[m]);
            }
        }
        for m in 0..BLOCK {
            let [i, j] = block.ends(m, first);
            let change = plus(d[m].map(|d| b[m] * d), a[m], e[m]);
            f[i] = plus(f[i], -1.0, change);
            f[j] = plus(f[j], 1.0, change);
        }
    }
}

/// 1 / sqrt(q), or 0 at 0: a spring without a length has no direction.
#[inline(always)]
fn inverse(q: f64) -> f64 {
    let root = inverse_root(Scalar::new(), q);
    if q == 0.0 { 0.0 } else { root }
}

#[inline(always)]
fn apart(a: &[Numbers], [i, j]: [usize; 2]) -> Numbers {
    let (a, b) = (&a[i], &a[j]);
    [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
}

#[inline(always)]
fn dot(a: Numbers, b: Numbers) -> f64 {
    a[2].mul_add(b[2], a[1].mul_add(b[1], a[0] * b[0]))
}

/// a + s b.
#[inline(always)]
fn plus(a: Numbers, s: f64, b: Numbers) -> Numbers {
    [
        s.mul_add(b[0], a[0]),
        s.mul_add(b[1], a[1]),
        s.mul_add(b[2], a[2]),
        s.mul_add(b[3], a[3]),
    ]
}
