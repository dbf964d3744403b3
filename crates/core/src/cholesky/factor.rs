//! Numeric factorisation.

#![expect(
    clippy::inline_always,
    clippy::needless_range_loop,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found; zipped iterators are not"
)]

use pulp::{Simd, WithSimd};

use super::pattern::{BlockPlace, Pattern};
use crate::fused::mul_add;
use crate::vectors::Arch;

/// Columns of a matrix of B x B numbers, each padded with zeros to the length P.
pub(crate) type Block<const B: usize, const P: usize> = [[f64; P]; B];

/// Marks the end of a linked list of columns.
const NONE: u32 = u32::MAX;

/// A factor of B x B blocks, initially the matrix.
#[derive(Debug)]
pub(crate) struct Factor<const B: usize, const P: usize> {
    /// Blocks on the diagonal; after factorisation, their own diagonals are inverted.
    pub(super) diagonal: Vec<Block<B, P>>,
    /// Blocks below the diagonal.
    pub(super) blocks: Vec<Block<B, P>>,
    /// Right-hand side, and later the solution.
    unknowns: Vec<[f64; P]>,
    /// Index of each row's block in the current column.
    places: Vec<u32>,
    /// Linked lists of the columns that contribute to a column: the first one and, for each column,
    /// the next one in the same list and its block there.
    first: Vec<u32>,
    next: Vec<u32>,
    reached: Vec<u32>,
    /// Whether the block of each column on the diagonal of the matrix that is left when the column
    /// is reached is negative definite.
    negative: Vec<bool>,
}

impl<const B: usize, const P: usize> Factor<B, P> {
    /// Creates room for a factor; `None` if memory is insufficient.
    pub fn new(pattern: &Pattern) -> Option<Self> {
        let (n, size) = (pattern.len(), pattern.size());
        let mut blocks = vec![];
        blocks.try_reserve_exact(size).ok()?;
        blocks.resize(size, [[0.0; P]; B]);
        Some(Self {
            diagonal: vec![[[0.0; P]; B]; n],
            blocks,
            unknowns: vec![[0.0; P]; n],
            places: vec![0; n],
            first: vec![NONE; n],
            next: vec![NONE; n],
            reached: vec![0; n],
            negative: vec![false; n],
        })
    }

    /// Sets all blocks to zero.
    pub fn clear(&mut self) {
        self.diagonal.fill([[0.0; P]; B]);
        self.blocks.fill([[0.0; P]; B]);
    }

    /// Returns the columns of the block of a row of the matrix on the diagonal.
    pub fn diagonal_mut(&mut self, pattern: &Pattern, i: usize) -> &mut Block<B, P> {
        &mut self.diagonal[pattern.ranks[i] as usize]
    }

    /// Returns the columns of a block below the diagonal.
    pub fn block_mut(&mut self, place: BlockPlace) -> &mut Block<B, P> {
        &mut self.blocks[place.block as usize]
    }

    /// Makes the factorisation A = L S LT one in which the sign of a row of the matrix in S is -1.
    pub fn set_negative(&mut self, pattern: &Pattern, i: usize) {
        self.negative[pattern.ranks[i] as usize] = true;
    }

    /// Factorises the matrix in the blocks. Returns whether it is positive definite, or has the
    /// signs that were set.
    pub fn factorise(&mut self, pattern: &Pattern) -> bool {
        let factor = self;
        Arch::new().dispatch(Factorise { factor, pattern })
    }

    /// Factorises the matrix without vector instructions.
    #[cfg(test)]
    pub fn factorise_by_numbers(&mut self, pattern: &Pattern) -> bool {
        let factor = self;
        Factorise { factor, pattern }.with_simd(pulp::Scalar::new())
    }

    /// Returns the least square of a number on the diagonal of the factor.
    pub fn least_square(&self) -> f64 {
        let inverses = |block: &Block<B, P>| std::array::from_fn::<_, B, _>(|k| block[k][k]);
        let largest = self.diagonal.iter().flat_map(inverses).fold(0.0, f64::max);
        1.0 / (largest * largest)
    }

    /// Returns the unknowns of a row of the matrix.
    pub fn unknowns_mut(&mut self, pattern: &Pattern, i: usize) -> &mut [f64; P] {
        &mut self.unknowns[pattern.ranks[i] as usize]
    }

    /// Solves A x = b: the unknowns are b before, and x afterwards.
    pub fn solve(&mut self, pattern: &Pattern) {
        let factor = self;
        Arch::new().dispatch(SolveTask { factor, pattern });
    }
}

struct Factorise<'a, const B: usize, const P: usize> {
    factor: &'a mut Factor<B, P>,
    pattern: &'a Pattern,
}

impl<const B: usize, const P: usize> WithSimd for Factorise<'_, B, P> {
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let Factor { diagonal, blocks, places, first, next, reached, negative, .. } = self.factor;
        let Pattern { starts, rows, .. } = self.pattern;
        let [places, first, next, reached] =
            [places, first, next, reached].map(|numbers| &mut numbers[..]);
        let (rows, starts) = (&rows[..], &starts[..]);
        first.fill(NONE);
        for (k, diagonal) in diagonal.iter_mut().enumerate() {
            let (start, end) = (starts[k] as usize, starts[k + 1] as usize);
            for place in start..end {
                places[rows[place] as usize] = (place - start) as u32;
            }
            let (before, column) = blocks.split_at_mut(start);
            let column = &mut column[..end - start];
            let mut left = first[k];
            while left != NONE {
                let j = left as usize;
                left = next[j];
                let (place, end) = (reached[j] as usize, starts[j + 1] as usize);
                let own = before[place];
                let by = if negative[j] { opposite(&own) } else { own };
                subtract_product(diagonal, &own, &by);
                for place in place + 1..end {
                    let target = places[rows[place] as usize] as usize;
                    subtract_product(&mut column[target], &before[place], &by);
                }
                if place + 1 < end {
                    let to = rows[place + 1] as usize;
                    reached[j] += 1;
                    (next[j], first[to]) = (first[to], j as u32);
                }
            }
            if negative[k] {
                *diagonal = opposite(diagonal);
                for block in &mut *column {
                    *block = opposite(block);
                }
            }
            if !root(diagonal) {
                return false;
            }
            for block in column {
                divide(block, diagonal);
            }
            if start < end {
                let to = rows[start] as usize;
                reached[k] = start as u32;
                (next[k], first[to]) = (first[to], k as u32);
            }
        }
        true
    }
}

struct SolveTask<'a, const B: usize, const P: usize> {
    factor: &'a mut Factor<B, P>,
    pattern: &'a Pattern,
}

impl<const B: usize, const P: usize> WithSimd for SolveTask<'_, B, P> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Factor { diagonal, blocks, unknowns, negative, .. } = self.factor;
        let Pattern { starts, rows, .. } = self.pattern;
        let (rows, blocks, unknowns) = (&rows[..], &blocks[..], &mut unknowns[..]);
        for (k, l) in diagonal.iter().enumerate() {
            let mut y = unknowns[k];
            for c in 0..B {
                y[c] *= l[c][c];
                for r in c + 1..B {
                    y[r] = mul_add(-l[c][r], y[c], y[r]);
                }
            }
            unknowns[k] = y;
            for place in starts[k] as usize..starts[k + 1] as usize {
                subtract(&mut unknowns[rows[place] as usize], &blocks[place], &y);
            }
        }
        for (k, l) in diagonal.iter().enumerate().rev() {
            let mut sums = [[0.0; P]; B];
            for place in starts[k] as usize..starts[k + 1] as usize {
                add_terms(&mut sums, &blocks[place], &unknowns[rows[place] as usize]);
            }
            let x = &mut unknowns[k];
            if negative[k] {
                *x = x.map(|x| -x);
            }
            for c in (0..B).rev() {
                let mut of_c = x[c];
                for r in 0..P {
                    of_c -= sums[c][r];
                }
                for r in c + 1..B {
                    of_c = mul_add(-l[c][r], x[r], of_c);
                }
                x[c] = of_c * l[c][c];
            }
        }
    }
}

/// Returns the block with the opposite sign.
#[inline(always)]
fn opposite<const B: usize, const P: usize>(a: &Block<B, P>) -> Block<B, P> {
    a.map(|column| column.map(|number| -number))
}

/// Computes c -= a bT.
#[inline(always)]
fn subtract_product<const B: usize, const P: usize>(
    c: &mut Block<B, P>,
    a: &Block<B, P>,
    b: &Block<B, P>,
) {
    for m in 0..B {
        for k in 0..B {
            for r in 0..P {
                c[m][r] = mul_add(-b[k][m], a[k][r], c[m][r]);
            }
        }
    }
}

/// Computes y -= l x.
#[inline(always)]
fn subtract<const B: usize, const P: usize>(y: &mut [f64; P], l: &Block<B, P>, x: &[f64; P]) {
    for c in 0..B {
        for r in 0..P {
            y[r] = mul_add(-x[c], l[c][r], y[r]);
        }
    }
}

/// Adds the terms of lT x, whose sum over each row of `sums` is an element.
#[inline(always)]
fn add_terms<const B: usize, const P: usize>(
    sums: &mut Block<B, P>,
    l: &Block<B, P>,
    x: &[f64; P],
) {
    for c in 0..B {
        for r in 0..P {
            sums[c][r] = mul_add(l[c][r], x[r], sums[c][r]);
        }
    }
}

/// Replaces a block by the lower triangle l with a = l lT, its diagonal inverted. Returns whether
/// it exists.
#[inline(always)]
fn root<const B: usize, const P: usize>(a: &mut Block<B, P>) -> bool {
    for c in 0..B {
        for before in 0..c {
            let by = a[before][c];
            for r in c..B {
                a[c][r] = mul_add(-a[before][r], by, a[c][r]);
            }
        }
        // Written so that NaN fails.
        if !(a[c][c] > 0.0 && a[c][c] < f64::INFINITY) {
            return false;
        }
        let inverse = 1.0 / a[c][c].sqrt();
        a[c][c] = inverse;
        for r in c + 1..B {
            a[c][r] *= inverse;
        }
    }
    true
}

/// Multiplies a by the inverse of lT, where l has an inverted diagonal.
#[inline(always)]
fn divide<const B: usize, const P: usize>(a: &mut Block<B, P>, l: &Block<B, P>) {
    for c in 0..B {
        for before in 0..c {
            for r in 0..P {
                a[c][r] = mul_add(-l[before][c], a[before][r], a[c][r]);
            }
        }
        for r in 0..P {
            a[c][r] *= l[c][c];
        }
    }
}
