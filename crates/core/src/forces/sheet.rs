//! The springs of a grid in one pass over its rows, with vectors as wide as the processor has. The same bits on every
//! processor: multiplications and additions are fused everywhere alike, and the sums have one order.
//!
//! A row's springs are found way by way, vector by vector, and kept: each pulls at its own row, and at this or one of the
//! next two. Rows of wide grids are cut into strips, so that what is kept stays in the nearest cache, on the stack.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::mem::swap;
use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

use super::inverse_root::inverse_root;
use crate::sheet::{Sheet, WAYS};

/// How many times as fast this is as the same springs one by one, on the grids that people look at.
pub(crate) const SPEED: f64 = 2.2;

/// Columns of a strip at most: what a strip keeps fits a cache, and is cleared only once.
const WIDTHS: [usize; 3] = [32, 128, 512];
/// Numbers beside a strip on either side: the longest vector, and zeros for springs that are not there.
const PAD: usize = 8;
/// Columns beside a strip whose springs pull at it.
const LEFT: usize = 2;
const RIGHT: usize = 1;

/// Sets f (N) to the forces of the sheet's springs on its particles, which are the first ones.
pub(crate) fn set(sheet: &Sheet, x: &[f64], v: &[f64], f: &mut [f64]) {
    Arch::new().dispatch(Forces { sheet, x, v, f });
}

struct Forces<'a> {
    sheet: &'a Sheet,
    x: &'a [f64],
    v: &'a [f64],
    f: &'a mut [f64],
}

impl WithSimd for Forces<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let damped = self.sheet.laws().iter().any(|law| law.damping > 0.0);
        if damped {
            strips::<S, true>(simd, self);
        } else {
            strips::<S, false>(simd, self);
        }
    }
}

#[inline(always)]
fn strips<S: Simd, const DAMPED: bool>(simd: S, forces: Forces) {
    const PADDED: [usize; 3] = [
        WIDTHS[0] + 2 * PAD,
        WIDTHS[1] + 2 * PAD,
        WIDTHS[2] + 2 * PAD,
    ];
    match forces.sheet.grid().cols() {
        cols if cols <= WIDTHS[0] => strips_of::<S, DAMPED, { PADDED[0] }>(simd, forces),
        cols if cols <= WIDTHS[1] => strips_of::<S, DAMPED, { PADDED[1] }>(simd, forces),
        _ => strips_of::<S, DAMPED, { PADDED[2] }>(simd, forces),
    }
}

/// Cuts the columns into strips of about the same width.
#[inline(always)]
fn strips_of<S: Simd, const DAMPED: bool, const P: usize>(simd: S, forces: Forces) {
    let Forces { sheet, x, v, f } = forces;
    let cols = sheet.grid().cols();
    let most = P - 2 * PAD;
    let count = if cols <= most {
        1
    } else {
        cols.div_ceil(most - LEFT - RIGHT)
    };
    let mut kept = Kept::<P>::default();
    for k in 0..count {
        let strip = k * cols / count..(k + 1) * cols / count;
        run::<S, DAMPED, P>(simd, sheet, x, v, f, &strip, &mut kept);
    }
}

/// Three columns of numbers, for a row of a strip.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Row<const P: usize>([[f64; P]; 3]);

impl<const P: usize> Default for Row<P> {
    fn default() -> Self {
        Self([[0.0; P]; 3])
    }
}

/// Three numbers of each particle of a vector, and of each of a row.
type Vectors<S> = [<S as Simd>::f64s; 3];
type Columns<'a, S> = [&'a [<S as Simd>::f64s]; 3];
type ColumnsMut<'a, S> = [&'a mut [<S as Simd>::f64s]; 3];

impl<const P: usize> Row<P> {
    /// A column as `m` vectors, beginning so many particles further right.
    #[inline(always)]
    fn column<S: Simd>(&self, axis: usize, shift: isize, m: usize) -> &[S::f64s] {
        let start = PAD.wrapping_add_signed(shift);
        &S::as_simd_f64s(&self.0[axis][start..start + m * S::F64_LANES]).0[..m]
    }

    #[inline(always)]
    fn at<S: Simd>(&self, shift: isize, m: usize) -> Columns<'_, S> {
        [
            self.column::<S>(0, shift, m),
            self.column::<S>(1, shift, m),
            self.column::<S>(2, shift, m),
        ]
    }

    #[inline(always)]
    fn at_mut<S: Simd>(&mut self, m: usize) -> ColumnsMut<'_, S> {
        let there = PAD..PAD + m * S::F64_LANES;
        let [x, y, z] = &mut self.0;
        [
            &mut S::as_mut_simd_f64s(&mut x[there.clone()]).0[..m],
            &mut S::as_mut_simd_f64s(&mut y[there.clone()]).0[..m],
            &mut S::as_mut_simd_f64s(&mut z[there]).0[..m],
        ]
    }

    /// Takes the numbers of a range of particles from a column-major n x 3 matrix.
    #[inline(always)]
    fn take(&mut self, a: &[f64], from: &Range<usize>) {
        let n = a.len() / 3;
        for (axis, to) in self.0.iter_mut().enumerate() {
            to[PAD..PAD + from.len()]
                .copy_from_slice(&a[axis * n + from.start..axis * n + from.end]);
        }
    }
}

/// What is kept of a strip.
#[derive(Default)]
struct Kept<const P: usize> {
    /// Of three rows.
    places: [Places<P>; 3],
    found: Found<P>,
    sum: Row<P>,
    /// k, k r and c of the springs that begin in a column: zeros where none does.
    laws: [Row<P>; 6],
    no_law: Row<P>,
}

#[derive(Default)]
struct Places<const P: usize> {
    x: Row<P>,
    v: Row<P>,
}

impl<const P: usize> Places<P> {
    #[inline(always)]
    fn at<S: Simd>(&self, shift: isize, m: usize) -> (Columns<'_, S>, Columns<'_, S>) {
        (self.x.at::<S>(shift, m), self.v.at::<S>(shift, m))
    }
}

/// Forces of the springs that begin in a row, by their ways: of this row, and of those above that its springs end in.
#[derive(Default)]
struct Found<const P: usize> {
    right: Row<P>,
    right2: Row<P>,
    down: [Row<P>; 2],
    backslash: [Row<P>; 2],
    slash: [Row<P>; 2],
    down2: [Row<P>; 3],
}

#[inline(always)]
fn run<S: Simd, const DAMPED: bool, const P: usize>(
    simd: S,
    sheet: &Sheet,
    x: &[f64],
    v: &[f64],
    f: &mut [f64],
    strip: &Range<usize>,
    kept: &mut Kept<P>,
) {
    let (rows, cols) = (sheet.grid().rows(), sheet.grid().cols());
    // The columns whose springs are found, and those whose particles they hold.
    let first = strip.start.saturating_sub(LEFT);
    let width = cols.min(strip.end + RIGHT) - first;
    let m = width.div_ceil(S::F64_LANES);
    let seen = |row: usize| row * cols + first..row * cols + cols.min(strip.end + RIGHT + 2);
    let inside = PAD + strip.start - first..PAD + strip.end - first;
    fill(&mut kept.laws, sheet, first, width, m * S::F64_LANES);
    kept.found = Found::default();
    let (sum, found) = (&mut kept.sum, &mut kept.found);
    let (right, right2) = (&mut found.right, &mut found.right2);
    let [mut down, mut from_above] = found.down.each_mut();
    let [mut backslash, mut from_left] = found.backslash.each_mut();
    let [mut slash, mut from_right] = found.slash.each_mut();
    let [mut down2, mut from_above_next, mut from_above2] = found.down2.each_mut();
    let take = |row: usize, to: &mut Places<P>| {
        if row < rows {
            to.x.take(x, &seen(row));
            if DAMPED {
                to.v.take(v, &seen(row));
            }
        }
    };
    let [mut here, mut next, mut next2] = kept.places.each_mut();
    take(0, here);
    take(1, next);
    let n = f.len() / 3;
    for row in 0..rows {
        take(row + 2, next2);
        let law = |way: usize| {
            let (_, rows_down, _) = WAYS[way];
            if row + rows_down < rows {
                kept.laws[way].at::<S>(0, m)
            } else {
                kept.no_law.at::<S>(0, m)
            }
        };
        let pair = [&mut *right, &mut *right2];
        along::<S, DAMPED, P>(simd, here, [law(0), law(4)], pair, m);
        let (px, pv) = here.at::<S>(0, m);
        let (ax, bx) = (next.at::<S>(0, m), next.at::<S>(1, m));
        let (cx, dx) = (next.at::<S>(-1, m), next2.at::<S>(0, m));
        let (a, b, c, d) = (law(1), law(2), law(3), law(5));
        let (mut to_a, mut to_b) = (down.at_mut::<S>(m), backslash.at_mut::<S>(m));
        let (mut to_c, mut to_d) = (slash.at_mut::<S>(m), down2.at_mut::<S>(m));
        let mut total = sum.at_mut::<S>(m);
        let (left, left2) = (right.at::<S>(-1, m), right2.at::<S>(-2, m));
        let (begun, begun2) = (right.at::<S>(0, m), right2.at::<S>(0, m));
        let (above, above2) = (from_above.at::<S>(0, m), from_above2.at::<S>(0, m));
        let (above_left, above_right) = (from_left.at::<S>(-1, m), from_right.at::<S>(1, m));
        for i in 0..m {
            let p = (pick::<S>(px, i), pick::<S>(pv, i));
            let mut all = sub::<S>(simd, pick::<S>(left, i), pick::<S>(begun, i));
            let pull = sub::<S>(simd, pick::<S>(left2, i), pick::<S>(begun2, i));
            all = add::<S>(simd, all, pull);
            let force = spring::<S, DAMPED>(simd, a, i, p, ax);
            put::<S>(&mut to_a, i, force);
            all = add::<S>(simd, all, sub::<S>(simd, pick::<S>(above, i), force));
            let force = spring::<S, DAMPED>(simd, b, i, p, bx);
            put::<S>(&mut to_b, i, force);
            all = add::<S>(simd, all, sub::<S>(simd, pick::<S>(above_left, i), force));
            let force = spring::<S, DAMPED>(simd, c, i, p, cx);
            put::<S>(&mut to_c, i, force);
            all = add::<S>(simd, all, sub::<S>(simd, pick::<S>(above_right, i), force));
            let force = spring::<S, DAMPED>(simd, d, i, p, dx);
            put::<S>(&mut to_d, i, force);
            all = add::<S>(simd, all, sub::<S>(simd, pick::<S>(above2, i), force));
            put::<S>(&mut total, i, all);
        }
        for (axis, sum) in sum.0.iter().enumerate() {
            f[axis * n + row * cols..][strip.clone()].copy_from_slice(&sum[inside.clone()]);
        }
        swap(&mut down, &mut from_above);
        swap(&mut backslash, &mut from_left);
        swap(&mut slash, &mut from_right);
        // This row's are those of the next but one.
        swap(&mut from_above2, &mut from_above_next);
        swap(&mut from_above_next, &mut down2);
        swap(&mut here, &mut next);
        swap(&mut next, &mut next2);
    }
}

/// Finds the springs along a row.
#[inline(always)]
fn along<S: Simd, const DAMPED: bool, const P: usize>(
    simd: S,
    places: &Places<P>,
    [a, b]: [Columns<S>; 2],
    [right, right2]: [&mut Row<P>; 2],
    m: usize,
) {
    let (px, pv) = places.at::<S>(0, m);
    let (one, two) = (places.at::<S>(1, m), places.at::<S>(2, m));
    let (mut right, mut right2) = (right.at_mut::<S>(m), right2.at_mut::<S>(m));
    for i in 0..m {
        let p = (pick::<S>(px, i), pick::<S>(pv, i));
        let force = spring::<S, DAMPED>(simd, a, i, p, one);
        put::<S>(&mut right, i, force);
        let force = spring::<S, DAMPED>(simd, b, i, p, two);
        put::<S>(&mut right2, i, force);
    }
}

/// Fills in the laws of so many columns from the `first` on, of which the last ones may be none.
fn fill<const P: usize>(
    laws: &mut [Row<P>; 6],
    sheet: &Sheet,
    first: usize,
    width: usize,
    found: usize,
) {
    let cols = sheet.grid().cols();
    for ((law, row), (_, _, to)) in sheet.laws().iter().zip(laws).zip(WAYS) {
        let begins =
            |col: usize| col < width && (0..cols).contains(&(first + col).wrapping_add_signed(to));
        let numbers = [law.stiffness, law.stiffness * law.rest_length, law.damping];
        for (column, number) in row.0.iter_mut().zip(numbers) {
            for (col, column) in column[PAD..PAD + found].iter_mut().enumerate() {
                *column = if begins(col) { number } else { 0.0 };
            }
        }
    }
}

#[inline(always)]
fn pick<S: Simd>(a: Columns<S>, i: usize) -> Vectors<S> {
    [a[0][i], a[1][i], a[2][i]]
}

#[inline(always)]
fn put<S: Simd>(a: &mut ColumnsMut<S>, i: usize, [x, y, z]: Vectors<S>) {
    a[0][i] = x;
    a[1][i] = y;
    a[2][i] = z;
}

/// The forces of springs from particles at p with velocity u to others, as they pull at the latter: s d with
/// s = k - k r / L + c (w . d) / L2.
#[inline(always)]
fn spring<S: Simd, const DAMPED: bool>(
    simd: S,
    law: Columns<S>,
    i: usize,
    (p, u): (Vectors<S>, Vectors<S>),
    (x, v): (Columns<S>, Columns<S>),
) -> Vectors<S> {
    let d = sub::<S>(simd, p, pick::<S>(x, i));
    let inverse = inverse_root(simd, dot(simd, d, d));
    let mut s = simd.negate_mul_add_f64s(law[1][i], inverse, law[0][i]);
    if DAMPED {
        let rate = dot(simd, sub::<S>(simd, u, pick::<S>(v, i)), d);
        let rate = simd.mul_f64s(simd.mul_f64s(rate, inverse), inverse);
        s = simd.mul_add_f64s(law[2][i], rate, s);
    }
    [
        simd.mul_f64s(s, d[0]),
        simd.mul_f64s(s, d[1]),
        simd.mul_f64s(s, d[2]),
    ]
}

#[inline(always)]
fn add<S: Simd>(simd: S, a: Vectors<S>, b: Vectors<S>) -> Vectors<S> {
    [
        simd.add_f64s(a[0], b[0]),
        simd.add_f64s(a[1], b[1]),
        simd.add_f64s(a[2], b[2]),
    ]
}

#[inline(always)]
fn sub<S: Simd>(simd: S, a: Vectors<S>, b: Vectors<S>) -> Vectors<S> {
    [
        simd.sub_f64s(a[0], b[0]),
        simd.sub_f64s(a[1], b[1]),
        simd.sub_f64s(a[2], b[2]),
    ]
}

#[inline(always)]
fn dot<S: Simd>(simd: S, a: Vectors<S>, b: Vectors<S>) -> S::f64s {
    let sum = simd.mul_add_f64s(a[1], b[1], simd.mul_f64s(a[0], b[0]));
    simd.mul_add_f64s(a[2], b[2], sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;
    use crate::random::SplitMix;

    /// The forces by one number at a time, and by every kind of vector that this processor has.
    #[test]
    fn vectors_of_any_length_give_the_same_bits() {
        for (rows, cols) in [(2, 2), (5, 3), (9, 33), (4, 140), (3, 515), (3, 1050)] {
            for damping_time in [0.0, 0.01] {
                let grid = Grid::new(rows, cols).unwrap();
                let sheet = Sheet::new(grid, 0.1, [100.0, 80.0, 30.0], damping_time).unwrap();
                let mut random = SplitMix(3);
                let mut numbers = || {
                    let n = 3 * grid.particles();
                    (0..n)
                        .map(|_| random.between(-1.0, 1.0))
                        .collect::<Vec<_>>()
                };
                let (x, v) = (numbers(), numbers());
                let by = |run: &dyn Fn(Forces)| {
                    let mut f = vec![f64::NAN; x.len()];
                    run(Forces {
                        sheet: &sheet,
                        x: &x,
                        v: &v,
                        f: &mut f,
                    });
                    f
                };
                let expected = by(&|forces| forces.with_simd(pulp::Scalar::new()));
                assert!(expected.iter().all(|f| f.is_finite()));
                assert_eq!(by(&|forces| Arch::new().dispatch(forces)), expected);
                #[cfg(target_arch = "x86_64")]
                if let Some(avx2) = pulp::x86::V3::try_new() {
                    assert_eq!(by(&|forces| Simd::vectorize(avx2, forces)), expected);
                }
            }
        }
    }
}
