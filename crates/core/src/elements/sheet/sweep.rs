//! A row of a sheet in a stage of a sweep. What a stage keeps from row to row is whole rows, and
//! stages are summed up while accelerations are at hand.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use pulp::{Arch, Simd, WithSimd};

use super::super::finish::Finish;
use super::super::flow::Flow;
use super::kernel::{DAMPED, Others, PLAIN, RowOfSprings, Use};
use super::lanes::{
    Columns, ColumnsMut, Lanes, Places, PlacesMut, Point, Vectors, pick, plus, put,
};
use super::laws;
use super::model::Sheet;
use crate::rows::{Registers, Stage, SweepScratch, Terms, stride};

/// Prepares the scratch of a sweep over a sheet, with its laws as they are now.
pub(crate) fn begin(sheet: &Sheet, scratch: &mut SweepScratch) {
    scratch.clear_kept();
    let laws = scratch.shared_mut();
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
        laws::fill::<S>(self.laws, self.sheet, 0, self.sheet.grid().cols());
    }
}

/// A row in a stage of a sweep.
pub(crate) struct Advance<'a> {
    pub sheet: &'a Sheet,
    /// Whether the scratch holds addends to the forces.
    pub added: bool,
    pub finish: &'a Finish<'a>,
    /// Drift of the particles afterwards.
    pub flow: Option<Flow>,
    /// Number of the stage in the sweep, and the stage.
    pub number: usize,
    pub stage: &'a Stage,
    pub row: usize,
    pub registers: &'a mut Registers,
    pub scratch: &'a mut SweepScratch,
}

impl Advance<'_> {
    /// Takes the row through the stage.
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
        added,
        finish,
        flow,
        number,
        stage,
        row,
        registers,
        scratch,
    } = job;
    let Registers {
        y,
        sum,
        stage: moving,
    } = registers;
    let (count, cols) = (sheet.grid().rows(), sheet.grid().cols());
    let lanes = Lanes::new::<S>(stride(cols), cols);
    let own = sheet.particles().start;
    let particles = own + row * cols..own + (row + 1) * cols;
    let [here, next, next2] = moving.three_mut(row);
    let mut springs = RowOfSprings {
        laws: scratch.shared.column(0, 0),
        masks: sheet.masks(row, 0),
        above: row,
        below: count - 1 - row,
        spring_forces: scratch.kept.row_mut(number),
    };
    springs.find_along::<S, KIND>(simd, lanes, here);
    let combine = Combine::<S> {
        y: lanes.places::<S>(y.row(row), 0),
        sum: lanes.places_mut::<S>(sum.row_mut(row)),
        stage: lanes.places_mut::<S>(here),
        first: stage.first,
        moves: stage.terms == Terms::Motion,
        b: simd.splat_f64s(stage.b),
        c: stage.c.map(|c| simd.splat_f64s(c)),
        flow,
    };
    let addends = added.then(|| scratch.addends.row(0));
    let others = Others::<S>::new(simd, lanes, finish, &particles, addends);
    springs.find_below::<S, KIND>(simd, lanes, [next, next2], &others, combine);
}

/// Takes particles to the next stage by their accelerations: sum + b k, and y + c k, k = \[v | a\].
struct Combine<'a, S: Simd> {
    y: Places<'a, S>,
    sum: PlacesMut<'a, S>,
    stage: PlacesMut<'a, S>,
    first: bool,
    /// Whether v moves x.
    moves: bool,
    b: S::f64s,
    /// Weight of k in the next stage; `None` in the last one, whose sum is the new state.
    c: Option<S::f64s>,
    /// The drift that follows.
    flow: Option<Flow>,
}

impl<S: Simd> Use<S> for Combine<'_, S> {
    #[inline(always)]
    fn here(&self, i: usize) -> Point<S> {
        let (x, v) = &self.stage;
        let (x, v) = ([x[0][i], x[1][i], x[2][i]], [v[0][i], v[1][i], v[2][i]]);
        [x, v, x, v]
    }

    #[inline(always)]
    fn put(&mut self, simd: S, i: usize, [_, u, ..]: Point<S>, a: Vectors<S>) {
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
