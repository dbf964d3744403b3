//! The springs of a grid in one pass over its rows, with vectors as wide as the processor has. The same bits on every
//! processor: multiplications and additions are fused everywhere alike, and the sums have one order.
//!
//! A row's springs are found way by way, vector by vector, and kept: each pulls at its own row, and at this or one of the
//! next two. One evaluation cuts rows of wide grids into strips, so that what is kept stays in the nearest cache, on the
//! stack. A sweep keeps whole rows, for each stage of a step, and sums up the stages while accelerations are at hand.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::mem::swap;
use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

use super::super::ending::Ending;
use super::super::flow::Flow;
use super::super::inverse_root::inverse_root;
use super::super::{columns, columns_mut};
use super::{Sheet, WAYS};
use crate::rows::{PAD, Part, REACH, Registers, Stage, Sweep, stride};
use crate::threads::{fork, threads};

/// How many times as fast this is as the same springs one by one, on the grids that people look at.
pub(crate) const SPEED: f64 = 3.0;

/// Columns of a strip at most: what a strip keeps fits a cache, and is cleared only once.
const WIDTHS: [usize; 3] = [32, 128, 512];
/// Columns beside a strip whose springs pull at it.
const LEFT: usize = 2;
const RIGHT: usize = 1;

/// Places in a row where laws differ: its first vector, those of its middle, the last but one, and the last.
const KINDS: usize = 4;
/// Numbers of laws: k, k r and c of the springs that go each way, zeros where none begins; and zeros for rows whose
/// springs would end below the last.
pub(crate) const LAWS: usize = 3 * (WAYS.len() + 1) * KINDS * PAD;
/// Columns of forces that are kept from row to row: right, two right, down, down and right (of this row and of the one
/// above), down and left (the same), two down (the same).
pub(crate) const FOUND: usize = 3 * 9;

/// What is found of springs: forces, and whether they are damped; or what their tangents make of a vector, and whether
/// those are clamped.
const PLAIN: u8 = 0;
const DAMPED: u8 = 1;
const TANGENT: u8 = 2;
const CLAMPED: u8 = 3;

/// Of which springs are asked.
#[derive(Clone, Copy)]
pub(crate) enum Of {
    /// Their forces on particles at x that move at v.
    Forces,
    /// What moving particles at x by v adds to the forces, and moving them at v, by the laws' dampings. With `clamped`,
    /// stiffness across compressed springs counts as none.
    Tangent { clamped: bool },
}

/// Sets f to what the ending makes of the forces of the sheet's springs on its particles, which are the first ones.
pub(crate) fn set(of: Of, sheet: &Sheet, x: &[f64], v: &[f64], f: &mut [f64], ending: &Ending) {
    let grid = sheet.grid();
    let held = columns_mut(f).map(|f| &mut f[..grid.particles()]);
    let bands = threads(grid.particles());
    fork(bands, 0..grid.rows(), grid.cols(), held, &|rows, f| {
        Arch::new().dispatch(Forces {
            of,
            sheet,
            x,
            v,
            rows,
            f,
            ending,
        });
    });
}

struct Forces<'a> {
    of: Of,
    sheet: &'a Sheet,
    x: &'a [f64],
    v: &'a [f64],
    /// Where forces are wanted, and the forces there.
    rows: Range<usize>,
    f: [&'a mut [f64]; 3],
    ending: &'a Ending<'a>,
}

impl WithSimd for Forces<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match self.of {
            Of::Tangent { clamped: true } => strips::<S, CLAMPED>(simd, self),
            Of::Tangent { clamped: false } => strips::<S, TANGENT>(simd, self),
            Of::Forces if self.sheet.is_damped() => strips::<S, DAMPED>(simd, self),
            Of::Forces => strips::<S, PLAIN>(simd, self),
        }
    }
}

#[inline(always)]
fn strips<S: Simd, const KIND: u8>(simd: S, forces: Forces) {
    const STRIDES: [usize; 3] = [stride(WIDTHS[0]), stride(WIDTHS[1]), stride(WIDTHS[2])];
    match forces.sheet.grid().cols() {
        cols if cols <= WIDTHS[0] => strips_of::<S, KIND, { STRIDES[0] }>(simd, forces),
        cols if cols <= WIDTHS[1] => strips_of::<S, KIND, { STRIDES[1] }>(simd, forces),
        _ => strips_of::<S, KIND, { STRIDES[2] }>(simd, forces),
    }
}

/// What is kept of a strip.
#[repr(C, align(64))]
struct Kept<const P: usize> {
    /// Of three rows.
    places: [[[f64; P]; 6]; 3],
    found: [[f64; P]; FOUND],
    wind: [[f64; P]; 3],
    f: [[f64; P]; 3],
    laws: [f64; LAWS],
}

/// Cuts the columns into strips of about the same width.
#[inline(always)]
fn strips_of<S: Simd, const KIND: u8, const P: usize>(simd: S, mut forces: Forces) {
    let cols = forces.sheet.grid().cols();
    let most = P - 2 * PAD;
    let count = if cols <= most {
        1
    } else {
        cols.div_ceil(most - LEFT - RIGHT)
    };
    let mut kept = Kept {
        places: [[[0.0; P]; 6]; 3],
        found: [[0.0; P]; FOUND],
        wind: [[0.0; P]; 3],
        f: [[0.0; P]; 3],
        laws: [0.0; LAWS],
    };
    for k in 0..count {
        let strip = k * cols / count..(k + 1) * cols / count;
        run::<S, KIND, P>(simd, &mut forces, &strip, &mut kept);
    }
}

#[inline(always)]
fn run<S: Simd, const KIND: u8, const P: usize>(
    simd: S,
    forces: &mut Forces,
    strip: &Range<usize>,
    kept: &mut Kept<P>,
) {
    let Forces {
        sheet,
        x,
        v,
        rows: wanted,
        f,
        ending,
        ..
    } = forces;
    let (rows, cols) = (sheet.grid().rows(), sheet.grid().cols());
    // The columns whose springs are found, and those whose particles they hold.
    let first = strip.start.saturating_sub(LEFT);
    let width = cols.min(strip.end + RIGHT) - first;
    let inside = PAD + strip.start - first..PAD + strip.end - first;
    fill::<S>(&mut kept.laws, sheet, first, width);
    kept.found = [[0.0; P]; FOUND];
    let n = x.len() / 3;
    let take = |row: usize, to: &mut [[f64; P]; 6]| {
        if row < rows {
            let seen = row * cols + first..row * cols + cols.min(strip.end + RIGHT + 2);
            for axis in 0..3 {
                let from = axis * n + seen.start..axis * n + seen.end;
                to[axis][PAD..PAD + seen.len()].copy_from_slice(&x[from.clone()]);
                if KIND != PLAIN || ending.drag.is_some() {
                    to[3 + axis][PAD..PAD + seen.len()].copy_from_slice(&v[from]);
                }
            }
        }
    };
    let [mut here, mut next, mut next2] = kept.places.each_mut();
    // Two rows above hand on what the first one needs.
    let begin = wanted.start.saturating_sub(REACH);
    take(begin, here);
    take(begin + 1, next);
    let size = Size::of::<S>(P, width);
    for row in begin..wanted.end {
        take(row + 2, next2);
        let particles = row * cols + first..row * cols + first + width;
        if let Some((wind, t)) = ending.wind {
            let mut gusts = kept.wind.each_mut().map(|a| &mut a[PAD..PAD + width]);
            wind.blow(t, columns(x, &particles), &mut gusts);
        }
        let mut springs = Springs {
            laws: &kept.laws,
            above: row,
            below: rows - 1 - row,
            found: kept.found.as_flattened_mut(),
        };
        let (places, f_row) = (here.as_flattened(), kept.f.as_flattened_mut());
        springs.find_along::<S, KIND>(simd, size, places);
        let put = Put::<S> {
            here: size.places::<S>(places, 0),
            f: size.at_mut::<S>(f_row),
        };
        let others = Others::<S>::new(simd, size, ending, &particles, kept.wind.as_flattened());
        let below = [next.as_flattened(), next2.as_flattened()];
        springs.find_below::<S, KIND>(simd, size, below, &others, put);
        if let Some(row) = row.checked_sub(wanted.start) {
            let to = row * cols + strip.start..row * cols + strip.end;
            for (f, from) in f.iter_mut().zip(&kept.f) {
                f[to.clone()].copy_from_slice(&from[inside.clone()]);
            }
        }
        swap(&mut here, &mut next);
        swap(&mut next, &mut next2);
    }
}

/// Writes the laws of a sheet as they are now, for a sweep.
pub(crate) fn begin(sheet: &Sheet, laws: &mut [f64]) {
    Arch::new().dispatch(Begin { sheet, laws });
}

struct Begin<'a> {
    sheet: &'a Sheet,
    laws: &'a mut [f64],
}

impl WithSimd for Begin<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        fill::<S>(self.laws, self.sheet, 0, self.sheet.grid().cols());
    }
}

/// A row in a stage of a sweep.
pub(crate) struct Advance<'a> {
    pub sheet: &'a Sheet,
    pub ending: &'a Ending<'a>,
    /// How particles drift afterwards.
    pub flow: Option<Flow>,
    /// Which stage it is, and what happens in it.
    pub number: usize,
    pub stage: &'a Stage,
    pub row: usize,
    pub registers: &'a mut Registers,
    pub sweep: &'a mut Sweep,
}

impl Advance<'_> {
    /// Takes it through the stage.
    pub fn run(self) {
        Arch::new().dispatch(self);
    }
}

impl WithSimd for Advance<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        if self.sheet.is_damped() {
            advance::<S, DAMPED>(simd, self);
        } else {
            advance::<S, PLAIN>(simd, self);
        }
    }
}

#[inline(always)]
fn advance<S: Simd, const KIND: u8>(simd: S, job: Advance) {
    let Advance {
        sheet,
        ending,
        flow,
        number,
        stage,
        row,
        registers,
        sweep,
    } = job;
    let Registers {
        y,
        sum,
        stage: moving,
    } = registers;
    let (count, cols) = (sheet.grid().rows(), sheet.grid().cols());
    let size = Size::of::<S>(stride(cols), cols);
    let particles = row * cols..(row + 1) * cols;
    let [here, next, next2] = moving.three_mut(row);
    if let Some((wind, t)) = ending.wind {
        let seen = PAD..PAD + cols;
        let mut gusts = columns_mut(sweep.wind.row_mut(0)).map(|a| &mut a[seen.clone()]);
        wind.blow(
            t,
            columns(here.split_at(3 * size.stride).0, &seen),
            &mut gusts,
        );
    }
    let mut springs = Springs {
        laws: sweep.laws.column(0, 0),
        above: row,
        below: count - 1 - row,
        found: sweep.found.row_mut(number),
    };
    springs.find_along::<S, KIND>(simd, size, here);
    let combine = Combine::<S> {
        y: size.places::<S>(y.row(row), 0),
        sum: size.places_mut::<S>(sum.row_mut(row)),
        stage: size.places_mut::<S>(here),
        first: stage.first,
        moves: stage.part == Part::All,
        b: simd.splat_f64s(stage.b),
        c: stage.c.map(|c| simd.splat_f64s(c)),
        flow,
    };
    let others = Others::<S>::new(simd, size, ending, &particles, sweep.wind.row(0));
    springs.find_below::<S, KIND>(simd, size, [next, next2], &others, combine);
}

/// Fills in the laws of so many columns from the `first` on.
#[inline(always)]
fn fill<S: Simd>(laws: &mut [f64], sheet: &Sheet, first: usize, width: usize) {
    let (cols, lanes) = (sheet.grid().cols(), S::F64_LANES);
    let m = width.div_ceil(lanes);
    let vectors = [0, 1, m.saturating_sub(2), m - 1];
    let ways = laws
        .chunks_exact_mut(3 * KINDS * PAD)
        .zip(sheet.laws())
        .zip(WAYS);
    for ((ways, law), (_, _, right)) in ways {
        // Where springs begin that end on the sheet.
        let from = right.min(0).unsigned_abs().saturating_sub(first);
        let to = width.min((cols - first).saturating_sub(right.max(0) as usize));
        let numbers = [law.stiffness, law.stiffness * law.rest_length, law.damping];
        for (column, number) in ways.chunks_exact_mut(KINDS * PAD).zip(numbers) {
            for (vector, i) in column.chunks_exact_mut(lanes).zip(vectors) {
                for (lane, law) in vector.iter_mut().enumerate() {
                    let begins = (from..to).contains(&(i * lanes + lane));
                    *law = if begins { number } else { 0.0 };
                }
            }
        }
    }
}

/// Three numbers of each particle of a vector, and of each of a row.
type Vectors<S> = [<S as Simd>::f64s; 3];
type Columns<'a, S> = [&'a [<S as Simd>::f64s]; 3];
type ColumnsMut<'a, S> = [&'a mut [<S as Simd>::f64s]; 3];
/// Positions and velocities.
type Places<'a, S> = (Columns<'a, S>, Columns<'a, S>);
type PlacesMut<'a, S> = (ColumnsMut<'a, S>, ColumnsMut<'a, S>);

/// Numbers from one column of a row to the next, and vectors in one.
#[derive(Clone, Copy)]
struct Size {
    stride: usize,
    m: usize,
}

impl Size {
    #[inline(always)]
    fn of<S: Simd>(stride: usize, particles: usize) -> Self {
        Self {
            stride,
            m: particles.div_ceil(S::F64_LANES),
        }
    }

    /// A column's vectors, beginning so many particles further right.
    #[inline(always)]
    fn column<S: Simd>(self, a: &[f64], column: usize, shift: isize) -> &[S::f64s] {
        let start = (column * self.stride + PAD).wrapping_add_signed(shift);
        &S::as_simd_f64s(&a[start..start + self.m * S::F64_LANES]).0[..self.m]
    }

    /// Those of three columns from the `first` on.
    #[inline(always)]
    fn at<S: Simd>(self, a: &[f64], first: usize, shift: isize) -> Columns<'_, S> {
        [
            self.column::<S>(a, first, shift),
            self.column::<S>(a, first + 1, shift),
            self.column::<S>(a, first + 2, shift),
        ]
    }

    #[inline(always)]
    fn places<S: Simd>(self, a: &[f64], shift: isize) -> Places<'_, S> {
        (self.at::<S>(a, 0, shift), self.at::<S>(a, 3, shift))
    }

    /// Those of three columns, all there are.
    #[inline(always)]
    fn at_mut<S: Simd>(self, a: &mut [f64]) -> ColumnsMut<'_, S> {
        let there = PAD..PAD + self.m * S::F64_LANES;
        let [x, y, z] = columns_mut(a);
        [
            &mut S::as_mut_simd_f64s(&mut x[there.clone()]).0[..self.m],
            &mut S::as_mut_simd_f64s(&mut y[there.clone()]).0[..self.m],
            &mut S::as_mut_simd_f64s(&mut z[there]).0[..self.m],
        ]
    }

    #[inline(always)]
    fn places_mut<S: Simd>(self, a: &mut [f64]) -> PlacesMut<'_, S> {
        let (x, v) = a.split_at_mut(3 * self.stride);
        (self.at_mut::<S>(x), self.at_mut::<S>(v))
    }

    /// Which of the laws is a vector's.
    #[inline(always)]
    fn kind(self, i: usize) -> usize {
        let after = self.m - 1 - i;
        let kind = if after < 2 { 3 - after } else { i.min(1) };
        kind % KINDS
    }
}

/// A number of each particle of a row.
#[derive(Clone, Copy)]
struct Numbers<'a, S: Simd> {
    whole: &'a [S::f64s],
    rest: &'a [f64],
}

impl<'a, S: Simd> Numbers<'a, S> {
    #[inline(always)]
    fn new(a: &'a [f64], particles: &Range<usize>) -> Self {
        let (whole, rest) = S::as_simd_f64s(&a[particles.clone()]);
        Self { whole, rest }
    }

    /// Those of a vector, zeros where there is no particle.
    #[inline(always)]
    fn at(self, simd: S, i: usize) -> S::f64s {
        match self.whole.get(i) {
            Some(vector) => *vector,
            None => simd.partial_load_f64s(self.rest),
        }
    }
}

/// What an ending adds to the forces on a row, and what it divides them by.
struct Others<'a, S: Simd> {
    wind: Option<Columns<'a, S>>,
    gravity: Option<(Vectors<S>, Numbers<'a, S>)>,
    drag: Option<S::f64s>,
    inertia: Option<Numbers<'a, S>>,
    inverse_masses: Option<Numbers<'a, S>>,
}

impl<'a, S: Simd> Others<'a, S> {
    #[inline(always)]
    fn new(
        simd: S,
        size: Size,
        ending: &Ending<'a>,
        particles: &Range<usize>,
        gusts: &'a [f64],
    ) -> Self {
        Self {
            wind: ending.wind.map(|_| size.at::<S>(gusts, 0, 0)),
            gravity: ending.gravity.map(|(g, masses)| {
                let g = [
                    simd.splat_f64s(g.x),
                    simd.splat_f64s(g.y),
                    simd.splat_f64s(g.z),
                ];
                (g, Numbers::new(masses, particles))
            }),
            drag: ending.drag.map(|c| simd.splat_f64s(c)),
            inertia: ending.inertia.map(|masses| Numbers::new(masses, particles)),
            inverse_masses: ending
                .inverse_masses
                .map(|inverse_masses| Numbers::new(inverse_masses, particles)),
        }
    }

    #[inline(always)]
    fn apply(&self, simd: S, i: usize, u: Vectors<S>, f: Vectors<S>) -> Vectors<S> {
        let mut f = f;
        if let Some(wind) = self.wind {
            f = add::<S>(simd, f, pick::<S>(wind, i));
        }
        if let Some((g, masses)) = self.gravity {
            f = plus::<S>(simd, f, masses.at(simd, i), g);
        }
        if let Some(c) = self.drag {
            f = [
                simd.negate_mul_add_f64s(c, u[0], f[0]),
                simd.negate_mul_add_f64s(c, u[1], f[1]),
                simd.negate_mul_add_f64s(c, u[2], f[2]),
            ];
        }
        if let Some(masses) = self.inertia {
            let m = masses.at(simd, i);
            f = [
                simd.mul_add_f64s(m, u[0], simd.neg_f64s(f[0])),
                simd.mul_add_f64s(m, u[1], simd.neg_f64s(f[1])),
                simd.mul_add_f64s(m, u[2], simd.neg_f64s(f[2])),
            ];
        }
        if let Some(inverse_masses) = self.inverse_masses {
            let w = inverse_masses.at(simd, i);
            f = [
                simd.mul_f64s(f[0], w),
                simd.mul_f64s(f[1], w),
                simd.mul_f64s(f[2], w),
            ];
        }
        f
    }
}

/// Where a row's particles are, and what is done with what was found for them.
trait Use<S: Simd> {
    fn here(&self, i: usize) -> (Vectors<S>, Vectors<S>);

    fn put(&mut self, simd: S, i: usize, here: (Vectors<S>, Vectors<S>), f: Vectors<S>);
}

/// Forces are written down.
struct Put<'a, S: Simd> {
    here: Places<'a, S>,
    f: ColumnsMut<'a, S>,
}

impl<S: Simd> Use<S> for Put<'_, S> {
    #[inline(always)]
    fn here(&self, i: usize) -> (Vectors<S>, Vectors<S>) {
        let (x, v) = self.here;
        (pick::<S>(x, i), pick::<S>(v, i))
    }

    #[inline(always)]
    fn put(&mut self, _: S, i: usize, _: (Vectors<S>, Vectors<S>), f: Vectors<S>) {
        put::<S>(&mut self.f, i, f);
    }
}

/// Accelerations take particles to the next stage: sum + b k, and y + c k, k = \[v | a\].
struct Combine<'a, S: Simd> {
    y: Places<'a, S>,
    sum: PlacesMut<'a, S>,
    stage: PlacesMut<'a, S>,
    first: bool,
    /// Whether v moves x.
    moves: bool,
    b: S::f64s,
    /// None in the last stage, from which the sum goes on.
    c: Option<S::f64s>,
    /// What follows then.
    flow: Option<Flow>,
}

impl<S: Simd> Use<S> for Combine<'_, S> {
    #[inline(always)]
    fn here(&self, i: usize) -> (Vectors<S>, Vectors<S>) {
        let (x, v) = &self.stage;
        ([x[0][i], x[1][i], x[2][i]], [v[0][i], v[1][i], v[2][i]])
    }

    #[inline(always)]
    fn put(&mut self, simd: S, i: usize, (_, u): (Vectors<S>, Vectors<S>), a: Vectors<S>) {
        if self.moves {
            let (y, sum, stage) = (self.y.0, &mut self.sum.0, &mut self.stage.0);
            combine::<S>(simd, i, (self.first, self.b, self.c), y, sum, stage, u);
        }
        let (y, sum, stage) = (self.y.1, &mut self.sum.1, &mut self.stage.1);
        combine::<S>(simd, i, (self.first, self.b, self.c), y, sum, stage, a);
        if let Some(flow) = self.flow {
            let (x, v) = &mut self.stage;
            for axis in 0..3 {
                (x[axis][i], v[axis][i]) = flow.of(simd, axis, x[axis][i], v[axis][i]);
            }
        }
    }
}

#[inline(always)]
fn combine<S: Simd>(
    simd: S,
    i: usize,
    (first, b, c): (bool, S::f64s, Option<S::f64s>),
    y: Columns<S>,
    sum: &mut ColumnsMut<S>,
    stage: &mut ColumnsMut<S>,
    k: Vectors<S>,
) {
    let before = if first {
        [stage[0][i], stage[1][i], stage[2][i]]
    } else {
        [sum[0][i], sum[1][i], sum[2][i]]
    };
    let after = plus::<S>(simd, before, b, k);
    match c {
        None => put::<S>(stage, i, after),
        Some(c) => {
            put::<S>(sum, i, after);
            put::<S>(stage, i, plus::<S>(simd, pick::<S>(y, i), c, k));
        }
    }
}

/// The laws of the springs that go one way, in a row with so many `below` it.
#[inline(always)]
fn law<S: Simd>(laws: &[f64], way: usize, below: usize) -> Columns<'_, S> {
    let (_, rows_down, _) = WAYS[way];
    let way = if rows_down <= below { way } else { WAYS.len() };
    let three = &laws[3 * way * KINDS * PAD..][..3 * KINDS * PAD];
    [
        &S::as_simd_f64s(three).0[..KINDS],
        &S::as_simd_f64s(&three[KINDS * PAD..]).0[..KINDS],
        &S::as_simd_f64s(&three[2 * KINDS * PAD..]).0[..KINDS],
    ]
}

/// A row of springs.
struct Springs<'a> {
    laws: &'a [f64],
    /// How many rows there are above it and below.
    above: usize,
    below: usize,
    found: &'a mut [f64],
}

impl Springs<'_> {
    /// Finds those along the row.
    #[inline(always)]
    fn find_along<S: Simd, const KIND: u8>(&mut self, simd: S, size: Size, here: &[f64]) {
        let three = 3 * size.stride;
        let (right, right2) = self.found[..2 * three].split_at_mut(three);
        let (mut right, mut right2) = (size.at_mut::<S>(right), size.at_mut::<S>(right2));
        let laws = |way| law::<S>(self.laws, way, self.below);
        let (a, b) = (laws(0), laws(4));
        let (px, pv) = size.places::<S>(here, 0);
        let (one, two) = (size.places::<S>(here, 1), size.places::<S>(here, 2));
        for i in 0..size.m {
            let (p, kind) = ((pick::<S>(px, i), pick::<S>(pv, i)), size.kind(i));
            let force = spring::<S, KIND>(simd, pick::<S>(a, kind), p, one, i);
            put::<S>(&mut right, i, force);
            let force = spring::<S, KIND>(simd, pick::<S>(b, kind), p, two, i);
            put::<S>(&mut right2, i, force);
        }
    }

    /// Finds those to the rows below, and sums up.
    #[inline(always)]
    fn find_below<S: Simd, const KIND: u8>(
        &mut self,
        simd: S,
        size: Size,
        [next, next2]: [&[f64]; 2],
        others: &Others<S>,
        mut then: impl Use<S>,
    ) {
        let three = 3 * size.stride;
        let (right, rest) = self.found.split_at_mut(three);
        let (right2, rest) = rest.split_at_mut(three);
        let (down, rest) = rest.split_at_mut(three);
        let (mut backslash, rest) = rest.split_at_mut(three);
        let (mut from_left, rest) = rest.split_at_mut(three);
        let (mut slash, rest) = rest.split_at_mut(three);
        let (mut from_right, rest) = rest.split_at_mut(three);
        let (even, odd) = rest.split_at_mut(three);
        let is_odd = self.above % 2 == 1;
        if is_odd {
            swap(&mut backslash, &mut from_left);
            swap(&mut slash, &mut from_right);
        }
        // Where the row before last left its own, which this row's replace.
        let down2 = if is_odd { odd } else { even };
        let laws = |way| law::<S>(self.laws, way, self.below);
        let (a, b, c, d) = (laws(1), laws(2), laws(3), laws(5));
        let (ax, bx) = (size.places::<S>(next, 0), size.places::<S>(next, 1));
        let (cx, dx) = (size.places::<S>(next, -1), size.places::<S>(next2, 0));
        let (mut to_a, mut to_b) = (size.at_mut::<S>(down), size.at_mut::<S>(backslash));
        let (mut to_c, mut to_d) = (size.at_mut::<S>(slash), size.at_mut::<S>(down2));
        let (left, left2) = (size.at::<S>(right, 0, -1), size.at::<S>(right2, 0, -2));
        let (begun, begun2) = (size.at::<S>(right, 0, 0), size.at::<S>(right2, 0, 0));
        let above_left = size.at::<S>(from_left, 0, -1);
        let above_right = size.at::<S>(from_right, 0, 1);
        for i in 0..size.m {
            let (p, kind) = (then.here(i), size.kind(i));
            let mut all = sub::<S>(simd, pick::<S>(left, i), pick::<S>(begun, i));
            let pull = sub::<S>(simd, pick::<S>(left2, i), pick::<S>(begun2, i));
            all = add::<S>(simd, all, pull);
            let force = spring::<S, KIND>(simd, pick::<S>(a, kind), p, ax, i);
            let above = replace::<S>(&mut to_a, i, force);
            all = add::<S>(simd, all, sub::<S>(simd, above, force));
            let force = spring::<S, KIND>(simd, pick::<S>(b, kind), p, bx, i);
            put::<S>(&mut to_b, i, force);
            all = add::<S>(simd, all, sub::<S>(simd, pick::<S>(above_left, i), force));
            let force = spring::<S, KIND>(simd, pick::<S>(c, kind), p, cx, i);
            put::<S>(&mut to_c, i, force);
            all = add::<S>(simd, all, sub::<S>(simd, pick::<S>(above_right, i), force));
            let force = spring::<S, KIND>(simd, pick::<S>(d, kind), p, dx, i);
            let above2 = replace::<S>(&mut to_d, i, force);
            all = add::<S>(simd, all, sub::<S>(simd, above2, force));
            then.put(simd, i, p, others.apply(simd, i, p.1, all));
        }
    }
}

/// a + b k
#[inline(always)]
fn plus<S: Simd>(simd: S, a: Vectors<S>, b: S::f64s, k: Vectors<S>) -> Vectors<S> {
    [
        simd.mul_add_f64s(b, k[0], a[0]),
        simd.mul_add_f64s(b, k[1], a[1]),
        simd.mul_add_f64s(b, k[2], a[2]),
    ]
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

/// Puts it there, and gives what was there.
#[inline(always)]
fn replace<S: Simd>(a: &mut ColumnsMut<S>, i: usize, by: Vectors<S>) -> Vectors<S> {
    let before = [a[0][i], a[1][i], a[2][i]];
    put::<S>(a, i, by);
    before
}

/// The forces of springs from particles at p with velocity u to others, as they pull at the latter: s d with
/// s = k - k r / L + c (w . d) / L2. Of tangents, with w between vectors and q = k - k r / L: q w + (k - q + c) (w . d) d / L2.
#[inline(always)]
fn spring<S: Simd, const KIND: u8>(
    simd: S,
    law: Vectors<S>,
    (p, u): (Vectors<S>, Vectors<S>),
    (x, v): (Columns<S>, Columns<S>),
    i: usize,
) -> Vectors<S> {
    let d = sub::<S>(simd, p, pick::<S>(x, i));
    let square = dot(simd, d, d);
    let inverse = inverse_root(simd, square);
    if KIND == TANGENT || KIND == CLAMPED {
        let zero = simd.splat_f64s(0.0);
        // Without a length there is no direction.
        let has_length = simd.less_than_f64s(zero, square);
        let inverse = simd.select_f64s(has_length, inverse, zero);
        let mut across = simd.negate_mul_add_f64s(law[1], inverse, law[0]);
        if KIND == CLAMPED {
            across = simd.max_f64s(across, zero);
        }
        let w = sub::<S>(simd, u, pick::<S>(v, i));
        let turn = simd.mul_f64s(simd.mul_f64s(dot(simd, w, d), inverse), inverse);
        let more = simd.add_f64s(simd.sub_f64s(law[0], across), law[2]);
        let s = simd.mul_f64s(turn, more);
        return [
            simd.mul_add_f64s(s, d[0], simd.mul_f64s(across, w[0])),
            simd.mul_add_f64s(s, d[1], simd.mul_f64s(across, w[1])),
            simd.mul_add_f64s(s, d[2], simd.mul_f64s(across, w[2])),
        ];
    }
    let mut s = simd.negate_mul_add_f64s(law[1], inverse, law[0]);
    if KIND == DAMPED {
        let rate = dot(simd, sub::<S>(simd, u, pick::<S>(v, i)), d);
        let rate = simd.mul_f64s(simd.mul_f64s(rate, inverse), inverse);
        s = simd.mul_add_f64s(law[2], rate, s);
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
                        of: Of::Forces,
                        sheet: &sheet,
                        x: &x,
                        v: &v,
                        rows: 0..rows,
                        f: columns_mut(&mut f),
                        ending: &Ending::default(),
                    });
                    f
                };
                let expected = by(&|forces| forces.with_simd(pulp::Scalar::new()));
                assert!(expected.iter().all(|f| f.is_finite()));
                assert_eq!(by(&|forces| Arch::new().dispatch(forces)), expected);
                for bands in [2, 3, 8] {
                    let found = by(&|forces| {
                        let Forces { rows, f, .. } = forces;
                        fork(bands, rows, cols, f, &|rows, f| {
                            Arch::new().dispatch(Forces { rows, f, ..forces });
                        });
                    });
                    assert!(found == expected, "{bands} bands");
                }
                #[cfg(target_arch = "x86_64")]
                if let Some(avx2) = pulp::x86::V3::try_new() {
                    assert_eq!(by(&|forces| Simd::vectorize(avx2, forces)), expected);
                }
            }
        }
    }
}
