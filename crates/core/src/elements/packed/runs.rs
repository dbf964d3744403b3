//! Runs: springs whose first ends and second ends are consecutive particles, as in a jelly or a
//! cloth. Their numbers are loaded as whole vectors, and none is gathered.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::laws::{self, Aligned, BLOCK, Each, Factors, Kernels, Laws, Products, Quantity};
use crate::fused::mul_add;
use crate::spring::Spring;

/// Springs between consecutive particles. A missing spring is replaced by one without stiffness.
#[derive(Debug, Default)]
pub(super) struct Runs {
    /// Particles at the two ends of the first spring of each block.
    pub places: Vec<[u32; 2]>,
    pub laws: Laws,
}

impl Runs {
    /// Adds springs of consecutive particles, in their order, whose first ends are in one block of
    /// particles. Ends are numbered from the particle `start` on.
    pub fn push(&mut self, springs: &[([u32; 2], &Spring)], start: u32) {
        let [i, j] = springs[0].0;
        let first = i - i % BLOCK as u32;
        self.places
            .push([first, first + (j - i)].map(|i| i - start));
        let at = |(ends, spring): &([u32; 2], _)| ((ends[0] - first) as usize, *spring);
        self.laws.push(springs.iter().map(at));
    }
}

/// Task that adds the forces of runs at x and v to f, or their differential for dx and dv. All have
/// three columns, `stride` numbers apart.
pub(super) struct Sum<'a> {
    pub runs: &'a Runs,
    pub which: Range<usize>,
    pub stride: usize,
    pub fields: [&'a [f64]; 4],
    pub f: &'a mut [f64],
    pub quantity: Quantity,
    pub is_damped: bool,
}

impl WithSimd for Sum<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let (quantity, is_damped) = (self.quantity, self.is_damped);
        self.run(quantity, is_damped);
    }
}

/// Three numbers for each particle of a block.
type Three<'a> = [&'a Each<f64>; 3];

#[inline(always)]
fn at(a: &[f64], stride: usize, first: u32) -> Three<'_> {
    let column = |axis: usize| a[axis * stride + first as usize..].first_chunk().unwrap();
    [column(0), column(1), column(2)]
}

#[inline(always)]
fn apart([a, b]: [Three; 2], m: usize) -> [f64; 3] {
    [a[0][m] - b[0][m], a[1][m] - b[1][m], a[2][m] - b[2][m]]
}

#[inline(always)]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    mul_add(a[2], b[2], mul_add(a[1], b[1], a[0] * b[0]))
}

/// Subtracts g from the forces on the first ends, and adds it to those on the second.
#[inline(always)]
fn give(g: &[Aligned; 3], [i, j]: [u32; 2], stride: usize, f: &mut [f64]) {
    for (axis, Aligned(g)) in g.iter().enumerate() {
        let column = &mut f[axis * stride..];
        let first: &mut Each<f64> = column[i as usize..].first_chunk_mut().unwrap();
        for m in 0..BLOCK {
            first[m] -= g[m];
        }
        let second: &mut Each<f64> = column[j as usize..].first_chunk_mut().unwrap();
        for m in 0..BLOCK {
            second[m] += g[m];
        }
    }
}

impl Kernels for Sum<'_> {
    #[inline(always)]
    fn forces<const DAMPED: bool>(self) {
        let (runs, stride) = (self.runs, self.stride);
        let [x, v, ..] = self.fields;
        let mut g = [Aligned::ZERO; 3];
        for block in self.which {
            let law = runs.laws.of(block);
            let [i, j] = runs.places[block];
            let places = [at(x, stride, i), at(x, stride, j)];
            // Without damping, velocities are not loaded.
            let speeds = if DAMPED {
                [at(v, stride, i), at(v, stride, j)]
            } else {
                places
            };
            for m in 0..BLOCK {
                let d = apart(places, m);
                let of = Products {
                    dd: dot(d, d),
                    wd: if DAMPED {
                        dot(apart(speeds, m), d)
                    } else {
                        0.0
                    },
                    ..Products::default()
                };
                let s = laws::force::<DAMPED>(law, m, of);
                for axis in 0..3 {
                    g[axis].0[m] = s * d[axis];
                }
            }
            give(&g, [i, j], stride, self.f);
        }
    }

    #[inline(always)]
    fn changes<const DAMPED: bool, const PRODUCT: bool>(self, factors: Factors) {
        let (runs, stride) = (self.runs, self.stride);
        let mut g = [Aligned::ZERO; 3];
        for block in self.which {
            let law = runs.laws.of(block);
            let [i, j] = runs.places[block];
            let [places, moves] = [0, 2].map(|k| {
                let a = self.fields[k];
                [at(a, stride, i), at(a, stride, j)]
            });
            // Without damping, velocities are not loaded.
            let [speeds, changes] = if DAMPED && !PRODUCT {
                [1, 3].map(|k| {
                    let a = self.fields[k];
                    [at(a, stride, i), at(a, stride, j)]
                })
            } else {
                [places, moves]
            };
            for m in 0..BLOCK {
                let (d, e) = (apart(places, m), apart(moves, m));
                let mut of = Products {
                    dd: dot(d, d),
                    de: dot(d, e),
                    ..Products::default()
                };
                if DAMPED && !PRODUCT {
                    let w = apart(speeds, m);
                    (of.wd, of.we) = (dot(w, d), dot(w, e));
                    of.gd = dot(apart(changes, m), d);
                }
                let [a, b] = laws::change::<DAMPED, PRODUCT>(law, m, of, factors);
                for axis in 0..3 {
                    g[axis].0[m] = mul_add(a, e[axis], b * d[axis]);
                }
            }
            give(&g, [i, j], stride, self.f);
        }
    }
}
