//! A row of a sheet in a stage of a sweep. A stage stores whole rows for the rows below, and is
//! summed up as soon as its accelerations are known.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use pulp::{Simd, WithSimd};

use super::super::finish::Finish;
use super::super::flow::Flow;
use super::kernel::{DAMPED, Others, PLAIN, RowOfSprings, Use};
use super::lanes::{ColumnsMut, Lanes, PlacesMut, Point, Vectors, plus, put};
use super::laws;
use super::model::Sheet;
use crate::rows::{Next, Registers, Stage, SweepScratch, Terms, stride};
use crate::vectors::Arch;

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

/// Task that takes a row through a stage of a sweep.
pub(crate) struct Advance<'a> {
    pub sheet: &'a Sheet,
    /// Whether the scratch holds forces to be added.
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
    let Advance { sheet, added, finish, flow, number, stage, row, registers, scratch } = job;
    let Registers { y, sum, stage: moving } = registers;
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
    let combine = CombineRows::<S> {
        y: lanes.places_mut::<S>(y.row_mut(row)),
        sum: lanes.places_mut::<S>(sum.row_mut(row)),
        stage: lanes.places_mut::<S>(here),
        by: stage,
        flow,
    };
    let addends = added.then(|| scratch.addends.row(0));
    let others = Others::<S>::new(simd, lanes, finish, &particles, addends);
    springs.find_below::<S, KIND>(simd, lanes, [next, next2], &others, combine);
}

/// Use that takes particles to the next stage by their accelerations, k = \[v | a\].
struct CombineRows<'a, S: Simd> {
    y: PlacesMut<'a, S>,
    sum: PlacesMut<'a, S>,
    stage: PlacesMut<'a, S>,
    by: &'a Stage,
    /// The drift that follows.
    flow: Option<Flow>,
}

impl<S: Simd> Use<S> for CombineRows<'_, S> {
    #[inline(always)]
    fn here(&self, i: usize) -> Point<S> {
        let (x, v) = &self.stage;
        let (x, v) = ([x[0][i], x[1][i], x[2][i]], [v[0][i], v[1][i], v[2][i]]);
        [x, v, x, v]
    }

    #[inline(always)]
    fn put(&mut self, simd: S, i: usize, [_, u, ..]: Point<S>, a: Vectors<S>) {
        if self.by.terms == Terms::Motion {
            let columns = [&mut self.y.0, &mut self.sum.0, &mut self.stage.0];
            combine::<S>(simd, i, self.by, columns, u);
        }
        let columns = [&mut self.y.1, &mut self.sum.1, &mut self.stage.1];
        combine::<S>(simd, i, self.by, columns, a);
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
    by: &Stage,
    [y, sum, stage]: [&mut ColumnsMut<S>; 3],
    k: Vectors<S>,
) {
    let at = |columns: &ColumnsMut<S>| [columns[0][i], columns[1][i], columns[2][i]];
    let before = if by.first { at(stage) } else { at(sum) };
    let after = plus::<S>(simd, before, simd.splat_f64s(by.b), k);
    match by.next {
        Next::Sum => put::<S>(stage, i, after),
        Next::FromY(c) => {
            put::<S>(sum, i, after);
            put::<S>(stage, i, plus::<S>(simd, at(y), simd.splat_f64s(c), k));
        }
        Next::Ahead { keep, add } => {
            let add = simd.splat_f64s(add);
            let more = k.map(|k| simd.mul_f64s(add, k));
            let ahead =
                if by.first { more } else { plus::<S>(simd, more, simd.splat_f64s(keep), at(y)) };
            put::<S>(y, i, ahead);
            put::<S>(stage, i, after);
        }
    }
}
