//! Blocks of springs, and the sums over them. The plain code here is compiled for SIMD vectors,
//! because it is inlined into `pulp`'s dispatch.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::laws;
use super::laws::{BLOCK, Each, Factors, Kernels, Laws, Products, Quantity};
use crate::fused::mul_add;
use crate::spring::Spring;

/// Three numbers of a particle and a zero, within one cache line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
pub(super) struct Numbers(pub [f64; 4]);

/// Springs in blocks. The last ones of a block that is not full join a particle to itself.
#[derive(Debug, Default)]
pub(super) struct Blocks {
    ends: Vec<Each<[u32; 2]>>,
    pub laws: Laws,
}

impl Blocks {
    /// Returns the number of blocks.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Adds a block of springs with their ends, which are numbered from the particle `start` on.
    pub fn push(&mut self, springs: &[([u32; 2], &Spring)], start: u32) {
        let own = |m: usize| {
            let ends = springs.get(m).map(|(ends, _)| *ends);
            ends.unwrap_or([springs[0].0[0]; 2]).map(|i| i - start)
        };
        self.ends.push(std::array::from_fn(own));
        self.laws.push(springs.iter().map(|(_, spring)| *spring).enumerate());
    }
}

/// Task that adds the forces of blocks of springs at x and v to f, or their differential for dx and
/// dv.
pub(super) struct Sum<'a> {
    pub blocks: &'a Blocks,
    pub which: Range<usize>,
    pub fields: [&'a [Numbers]; 4],
    pub f: &'a mut [Numbers],
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

impl Kernels for Sum<'_> {
    #[inline(always)]
    fn forces<const DAMPED: bool>(self) {
        let Sum { blocks, which, fields, f, .. } = self;
        let [x, v, ..] = fields;
        let mut d = [Numbers::default(); BLOCK];
        let [mut s, mut rate] = [[0.0; BLOCK]; 2];
        for block in which {
            let (ends, law) = (&blocks.ends[block], blocks.laws.of(block));
            for m in 0..BLOCK {
                let ends = pair(ends[m]);
                d[m] = apart(x, ends);
                s[m] = dot(d[m], d[m]);
                if DAMPED {
                    rate[m] = dot(apart(v, ends), d[m]);
                }
            }
            for m in 0..BLOCK {
                let of = Products { dd: s[m], wd: rate[m], ..Products::default() };
                s[m] = laws::force::<DAMPED>(law, m, of);
            }
            for m in 0..BLOCK {
                let [i, j] = pair(ends[m]);
                f[i] = plus(f[i], -s[m], d[m]);
                f[j] = plus(f[j], s[m], d[m]);
            }
        }
    }

    #[inline(always)]
    fn changes<const DAMPED: bool, const PRODUCT: bool>(self, factors: Factors) {
        let Sum { blocks, which, fields, f, .. } = self;
        let [x, v, dx, dv] = fields;
        let [mut d, mut e] = [[Numbers::default(); BLOCK]; 2];
        let [mut dd, mut de, mut wd, mut we, mut gd] = [[0.0; BLOCK]; 5];
        for block in which {
            let (ends, law) = (&blocks.ends[block], blocks.laws.of(block));
            for m in 0..BLOCK {
                let ends = pair(ends[m]);
                (d[m], e[m]) = (apart(x, ends), apart(dx, ends));
                (dd[m], de[m]) = (dot(d[m], d[m]), dot(d[m], e[m]));
                if DAMPED && !PRODUCT {
                    let w = apart(v, ends);
                    (wd[m], we[m]) = (dot(w, d[m]), dot(w, e[m]));
                    gd[m] = dot(apart(dv, ends), d[m]);
                }
            }
            for m in 0..BLOCK {
                let of = Products { dd: dd[m], de: de[m], wd: wd[m], we: we[m], gd: gd[m] };
                [dd[m], de[m]] = laws::change::<DAMPED, PRODUCT>(law, m, of, factors);
            }
            for m in 0..BLOCK {
                let [i, j] = pair(ends[m]);
                let change = plus(Numbers(d[m].0.map(|d| de[m] * d)), dd[m], e[m]);
                f[i] = plus(f[i], -1.0, change);
                f[j] = plus(f[j], 1.0, change);
            }
        }
    }
}

#[inline(always)]
fn pair(ends: [u32; 2]) -> [usize; 2] {
    ends.map(|i| i as usize)
}

#[inline(always)]
fn apart(a: &[Numbers], [i, j]: [usize; 2]) -> Numbers {
    let (a, b) = (&a[i].0, &a[j].0);
    Numbers([a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]])
}

#[inline(always)]
fn dot(Numbers(a): Numbers, Numbers(b): Numbers) -> f64 {
    mul_add(a[2], b[2], mul_add(a[1], b[1], a[0] * b[0]))
}

/// Returns a + s b.
#[inline(always)]
fn plus(Numbers(a): Numbers, s: f64, Numbers(b): Numbers) -> Numbers {
    Numbers([
        mul_add(s, b[0], a[0]),
        mul_add(s, b[1], a[1]),
        mul_add(s, b[2], a[2]),
        mul_add(s, b[3], a[3]),
    ])
}

/// Size of a cache line (bytes).
const LINE: usize = 64;

/// Three columns of numbers, aligned for SIMD vectors.
#[derive(Debug, Default)]
pub(super) struct Columns(Vec<f64>);

impl Columns {
    fn start(&self) -> usize {
        self.0.as_ptr().align_offset(LINE)
    }

    /// Resizes each column to a length, and returns the columns.
    pub fn of_length(&mut self, len: usize) -> &mut [f64] {
        self.0.resize(3 * len + LINE / size_of::<f64>(), 0.0);
        let start = self.start();
        &mut self.0[start..start + 3 * len]
    }

    pub fn get(&self) -> &[f64] {
        let start = self.start().min(self.0.len());
        &self.0[start..]
    }

    pub fn get_mut(&mut self) -> &mut [f64] {
        let start = self.start();
        &mut self.0[start..]
    }
}

/// Rows of an n x 3 matrix.
#[derive(Clone, Copy)]
pub(super) enum Places<'a> {
    /// Consecutive rows, from this one on.
    From(usize),
    /// Rows in ascending order.
    Each(&'a [u32]),
}

/// Adds numbers to rows of a column, which begins at the row `start`.
pub(super) fn add(
    column: &mut [f64],
    start: usize,
    places: Places,
    sums: impl Iterator<Item = f64>,
) {
    match places {
        Places::From(first) => {
            for (f, sum) in column[first - start..].iter_mut().zip(sums) {
                *f += sum;
            }
        }
        Places::Each(places) => {
            for (i, sum) in places.iter().zip(sums) {
                column[*i as usize - start] += sum;
            }
        }
    }
}

/// Copies rows of a column of an n x 3 matrix.
pub(super) fn copy(from: &[f64], axis: usize, places: Places, to: &mut [f64]) {
    let n = from.len() / 3;
    let from = &from[axis * n..][..n];
    match places {
        Places::From(first) => to.copy_from_slice(&from[first..][..to.len()]),
        Places::Each(places) => {
            for (to, i) in to.iter_mut().zip(places) {
                *to = from[*i as usize];
            }
        }
    }
}

/// Copies rows of an n x 3 matrix.
pub(super) fn copy_rows(from: &[f64], places: Places, to: &mut [Numbers]) {
    let [x, y, z] = [0, 1, 2].map(|axis| &from[axis * (from.len() / 3)..][..from.len() / 3]);
    match places {
        Places::From(first) => {
            let [x, y, z] = [x, y, z].map(|column| &column[first..][..to.len()]);
            for (i, to) in to.iter_mut().enumerate() {
                *to = Numbers([x[i], y[i], z[i], 0.0]);
            }
        }
        Places::Each(places) => {
            for (to, i) in to.iter_mut().zip(places) {
                let i = *i as usize;
                *to = Numbers([x[i], y[i], z[i], 0.0]);
            }
        }
    }
}
