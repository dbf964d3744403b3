//! SIMD vectors of particles, and columns of them.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::ops::Range;

use pulp::Simd;

use crate::columns::columns_mut;
use crate::fused::mul_adds;
use crate::rows::PAD;

/// Three numbers for each particle of a vector, and for each of a row.
pub(super) type Vectors<S> = [<S as Simd>::f64s; 3];
pub(super) type Columns<'a, S> = [&'a [<S as Simd>::f64s]; 3];
pub(super) type ColumnsMut<'a, S> = [&'a mut [<S as Simd>::f64s]; 3];
/// Positions and velocities.
pub(super) type Places<'a, S> = (Columns<'a, S>, Columns<'a, S>);
pub(super) type PlacesMut<'a, S> = (ColumnsMut<'a, S>, ColumnsMut<'a, S>);

/// Positions, velocities and their changes of the particles of a vector.
pub(super) type Point<S> = [Vectors<S>; 4];

/// Positions, velocities and their changes of the particles of a row.
#[derive(Clone, Copy)]
pub(super) struct Points<'a, S: Simd> {
    places: Places<'a, S>,
    changes: Places<'a, S>,
}

impl<S: Simd> Points<'_, S> {
    #[inline(always)]
    pub fn pick(&self, i: usize) -> Point<S> {
        let ((x, v), (dx, dv)) = (self.places, self.changes);
        [pick::<S>(x, i), pick::<S>(v, i), pick::<S>(dx, i), pick::<S>(dv, i)]
    }
}

/// Layout of a row: the distance of columns, and the number of vectors in each.
#[derive(Clone, Copy)]
pub(super) struct Lanes {
    pub stride: usize,
    pub count: usize,
}

impl Lanes {
    #[inline(always)]
    pub fn new<S: Simd>(stride: usize, particles: usize) -> Self {
        Self { stride, count: particles.div_ceil(S::F64_LANES) }
    }

    /// Returns the vectors of a column, shifted to the right by a number of particles.
    #[inline(always)]
    fn column<S: Simd>(self, a: &[f64], column: usize, shift: isize) -> &[S::f64s] {
        let start = (column * self.stride + PAD).wrapping_add_signed(shift);
        &S::as_simd_f64s(&a[start..start + self.count * S::F64_LANES]).0[..self.count]
    }

    /// Returns the vectors of three columns from the `first` on, shifted to the right by a number
    /// of particles.
    #[inline(always)]
    pub fn at<S: Simd>(self, a: &[f64], first: usize, shift: isize) -> Columns<'_, S> {
        [
            self.column::<S>(a, first, shift),
            self.column::<S>(a, first + 1, shift),
            self.column::<S>(a, first + 2, shift),
        ]
    }

    #[inline(always)]
    pub fn places<S: Simd>(self, a: &[f64], shift: isize) -> Places<'_, S> {
        (self.at::<S>(a, 0, shift), self.at::<S>(a, 3, shift))
    }

    /// Returns the positions and velocities and, if there are such columns, their changes.
    /// Otherwise these are not used.
    #[inline(always)]
    pub fn points<S: Simd>(self, a: &[f64], changes: bool, shift: isize) -> Points<'_, S> {
        let places = self.places::<S>(a, shift);
        let changes =
            if changes { (self.at::<S>(a, 6, shift), self.at::<S>(a, 9, shift)) } else { places };
        Points { places, changes }
    }

    /// Returns the vectors of a matrix of three columns.
    #[inline(always)]
    pub fn at_mut<S: Simd>(self, a: &mut [f64]) -> ColumnsMut<'_, S> {
        let there = PAD..PAD + self.count * S::F64_LANES;
        let [x, y, z] = columns_mut(a);
        [
            &mut S::as_mut_simd_f64s(&mut x[there.clone()]).0[..self.count],
            &mut S::as_mut_simd_f64s(&mut y[there.clone()]).0[..self.count],
            &mut S::as_mut_simd_f64s(&mut z[there]).0[..self.count],
        ]
    }

    #[inline(always)]
    pub fn places_mut<S: Simd>(self, a: &mut [f64]) -> PlacesMut<'_, S> {
        let (x, v) = a.split_at_mut(3 * self.stride);
        (self.at_mut::<S>(x), self.at_mut::<S>(v))
    }
}

/// A number for each particle of a row.
#[derive(Clone, Copy)]
pub(super) struct Numbers<'a, S: Simd> {
    whole: &'a [S::f64s],
    rest: &'a [f64],
}

impl<'a, S: Simd> Numbers<'a, S> {
    #[inline(always)]
    pub fn new(a: &'a [f64], particles: &Range<usize>) -> Self {
        let (whole, rest) = S::as_simd_f64s(&a[particles.clone()]);
        Self { whole, rest }
    }

    /// Returns the numbers of vector i, with zeros where there is no particle.
    #[inline(always)]
    pub fn at(self, simd: S, i: usize) -> S::f64s {
        match self.whole.get(i) {
            Some(vector) => *vector,
            None => simd.partial_load_f64s(self.rest),
        }
    }
}

/// Returns a + b k.
#[inline(always)]
pub(super) fn plus<S: Simd>(simd: S, a: Vectors<S>, b: S::f64s, k: Vectors<S>) -> Vectors<S> {
    [mul_adds(simd, b, k[0], a[0]), mul_adds(simd, b, k[1], a[1]), mul_adds(simd, b, k[2], a[2])]
}

/// Returns vector i of three columns.
#[inline(always)]
pub(super) fn pick<S: Simd>(a: Columns<S>, i: usize) -> Vectors<S> {
    [a[0][i], a[1][i], a[2][i]]
}

/// Writes vector i of three columns.
#[inline(always)]
pub(super) fn put<S: Simd>(a: &mut ColumnsMut<S>, i: usize, [x, y, z]: Vectors<S>) {
    a[0][i] = x;
    a[1][i] = y;
    a[2][i] = z;
}

/// Writes vector i, and returns the old one.
#[inline(always)]
pub(super) fn replace<S: Simd>(a: &mut ColumnsMut<S>, i: usize, by: Vectors<S>) -> Vectors<S> {
    let before = [a[0][i], a[1][i], a[2][i]];
    put::<S>(a, i, by);
    before
}

#[inline(always)]
pub(super) fn add<S: Simd>(simd: S, a: Vectors<S>, b: Vectors<S>) -> Vectors<S> {
    [simd.add_f64s(a[0], b[0]), simd.add_f64s(a[1], b[1]), simd.add_f64s(a[2], b[2])]
}

#[inline(always)]
pub(super) fn sub<S: Simd>(simd: S, a: Vectors<S>, b: Vectors<S>) -> Vectors<S> {
    [simd.sub_f64s(a[0], b[0]), simd.sub_f64s(a[1], b[1]), simd.sub_f64s(a[2], b[2])]
}

#[inline(always)]
pub(super) fn dot<S: Simd>(simd: S, a: Vectors<S>, b: Vectors<S>) -> S::f64s {
    let sum = mul_adds(simd, a[1], b[1], simd.mul_f64s(a[0], b[0]));
    mul_adds(simd, a[2], b[2], sum)
}
