//! Blocks of springs, and what is summed over them. What is plain code here is compiled for the
//! processor's vectors, because it is inlined into `pulp`'s dispatch.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::ops::Range;

use pulp::{Scalar, Simd, WithSimd};

use crate::elements::inverse_root::inverse_root;
use crate::spring::Spring;

/// Springs of a block: what is kept of them between the passes over it stays in the nearest cache.
pub(super) const BLOCK: usize = 64;

/// Three numbers of a particle and a zero.
pub(super) type Numbers = [f64; 4];

/// A number of each spring of a block.
type Each<T> = [T; BLOCK];

/// Springs one after another, each of their numbers in a list of its own, which the processor reads
/// ahead. Blocks that are not full end with springs from a particle to itself, without stiffness.
#[derive(Debug, Default)]
pub(super) struct Blocks {
    ends: Vec<Each<[u32; 2]>>,
    /// k (N/m).
    stiffness: Vec<Each<f64>>,
    /// k r (N).
    push: Vec<Each<f64>>,
    /// c (N s/m).
    damping: Vec<Each<f64>>,
}

impl Blocks {
    /// Number of blocks.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Adds a block of springs with their ends.
    pub fn push<'a>(&mut self, springs: impl ExactSizeIterator<Item = ([u32; 2], &'a Spring)>) {
        let [mut stiffness, mut push, mut damping] = [[0.0; BLOCK]; 3];
        let mut ends = [[0; 2]; BLOCK];
        for (m, (of, spring)) in springs.enumerate() {
            if m == 0 {
                ends = [[of[0]; 2]; BLOCK];
            }
            let law = spring.law;
            ends[m] = of;
            stiffness[m] = law.stiffness;
            push[m] = law.stiffness * law.rest_length;
            damping[m] = law.damping;
        }
        self.ends.push(ends);
        self.stiffness.push(stiffness);
        self.push.push(push);
        self.damping.push(damping);
    }
}

/// The forces of blocks of springs, added to f: of x and v, or their change by dx and dv.
pub(super) struct Sum<'a> {
    pub blocks: &'a Blocks,
    pub which: Range<usize>,
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
        blocks, which, f, ..
    } = sum;
    let [x, v, ..] = sum.fields;
    let mut d = [[0.0; 4]; BLOCK];
    let (mut s, mut rate) = ([0.0; BLOCK], [0.0; BLOCK]);
    for block in which {
        let (ends, stiffness) = (&blocks.ends[block], &blocks.stiffness[block]);
        let (push, damping) = (&blocks.push[block], &blocks.damping[block]);
        for m in 0..BLOCK {
            let ends = pair(ends[m]);
            d[m] = apart(x, ends);
            s[m] = dot(d[m], d[m]);
            if DAMPED {
                rate[m] = dot(apart(v, ends), d[m]);
            }
        }
        for m in 0..BLOCK {
            // Finite for a spring without a length, whose force is a multiple of d.
            let inverse = inverse_root(Scalar::new(), s[m]);
            s[m] = (-push[m]).mul_add(inverse, stiffness[m]);
            if DAMPED {
                s[m] = (damping[m] * rate[m] * inverse).mul_add(inverse, s[m]);
            }
        }
        for m in 0..BLOCK {
            let [i, j] = pair(ends[m]);
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
        blocks, which, f, ..
    } = sum;
    let [x, v, dx, dv] = sum.fields;
    let (mut d, mut e) = ([[0.0; 4]; BLOCK], [[0.0; 4]; BLOCK]);
    let (mut a, mut b) = ([0.0; BLOCK], [0.0; BLOCK]);
    let [mut wd, mut we, mut gd] = [[0.0; BLOCK]; 3];
    for block in which {
        let (ends, stiffness) = (&blocks.ends[block], &blocks.stiffness[block]);
        let (push, damping) = (&blocks.push[block], &blocks.damping[block]);
        for m in 0..BLOCK {
            let ends = pair(ends[m]);
            (d[m], e[m]) = (apart(x, ends), apart(dx, ends));
            (a[m], b[m]) = (dot(d[m], d[m]), dot(d[m], e[m]));
            if DAMPED {
                let w = apart(v, ends);
                (wd[m], we[m]) = (dot(w, d[m]), dot(w, e[m]));
                gd[m] = dot(apart(dv, ends), d[m]);
            }
        }
        for m in 0..BLOCK {
            let (inverse, k) = (inverse(a[m]), stiffness[m]);
            let s = (-push[m]).mul_add(inverse, k);
            let share = b[m] * inverse * inverse;
            (a[m], b[m]) = (s, (k - s) * share);
            if DAMPED {
                let c = damping[m] * inverse * inverse;
                let rate = gd[m] + (-wd[m]).mul_add(share, we[m]);
                a[m] = c.mul_add(wd[m], a[m]);
                b[m] = c.mul_add((-wd[m]).mul_add(share, rate), b[m]);
            }
        }
        for m in 0..BLOCK {
            let [i, j] = pair(ends[m]);
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
fn pair(ends: [u32; 2]) -> [usize; 2] {
    ends.map(|i| i as usize)
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
