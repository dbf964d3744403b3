//! One evaluation of a sheet. Rows of wide grids are cut into strips, so that what is kept from row
//! to row stays in the nearest cache, on the stack.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::mem::swap;
use std::ops::Range;

use pulp::{Arch, Simd, WithSimd};

use super::super::finish::Finish;
use super::kernel::{CLAMPED, DAMPED, Others, PLAIN, RowOfSprings, SPRING_FORCES, TANGENT, Use};
use super::lanes::{ColumnsMut, Lanes, Places, Vectors, pick, put};
use super::laws::{self, LAWS};
use super::model::Sheet;
use crate::columns::columns_mut;
use crate::rows::{PAD, REACH, stride};
use crate::threads::{fork, threads};

/// Largest numbers of columns of a strip: what a strip keeps fits a cache, and is cleared only
/// once.
const WIDTHS: [usize; 3] = [32, 128, 512];
/// Columns beside a strip whose springs pull at it.
const LEFT: usize = 2;
const RIGHT: usize = 1;

/// Quantity of a sheet's springs.
#[derive(Clone, Copy)]
pub(crate) enum Quantity {
    /// Forces on particles at x that move at v.
    Forces,
    /// Change of the forces on particles at x by moving them by v, and at v, by the laws'
    /// dampings. With `clamped`, stiffness across compressed springs counts as none.
    Tangent { clamped: bool },
}

/// Sets f, on the particles of a sheet, to the finished sum of its springs' forces, and of what f
/// holds before if that is to be `added`.
pub(crate) fn set(
    quantity: Quantity,
    sheet: &Sheet,
    [x, v]: [&[f64]; 2],
    f: &mut [f64],
    added: bool,
    finish: &Finish,
) {
    let grid = sheet.grid();
    let own = columns_mut(f).map(|f| &mut f[sheet.particles()]);
    let bands = threads(grid.particles());
    fork(bands, 0..grid.rows(), grid.cols(), own, &|rows, f| {
        Arch::new().dispatch(Forces {
            quantity,
            sheet,
            x,
            v,
            rows,
            f,
            added,
            finish,
        });
    });
}

struct Forces<'a> {
    quantity: Quantity,
    sheet: &'a Sheet,
    x: &'a [f64],
    v: &'a [f64],
    /// Rows whose forces are wanted, and the forces there.
    rows: Range<usize>,
    f: [&'a mut [f64]; 3],
    /// Whether the forces there are added to.
    added: bool,
    finish: &'a Finish<'a>,
}

impl WithSimd for Forces<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match self.quantity {
            Quantity::Tangent { clamped: true } => strips::<S, CLAMPED>(simd, self),
            Quantity::Tangent { clamped: false } => strips::<S, TANGENT>(simd, self),
            Quantity::Forces if self.sheet.is_damped() => strips::<S, DAMPED>(simd, self),
            Quantity::Forces => strips::<S, PLAIN>(simd, self),
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

/// Numbers of a strip that are kept from row to row.
#[repr(C, align(64))]
struct Kept<const P: usize> {
    /// Positions and velocities of three rows.
    places: [[[f64; P]; 6]; 3],
    spring_forces: [[f64; P]; SPRING_FORCES],
    addends: [[f64; P]; 3],
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
        spring_forces: [[0.0; P]; SPRING_FORCES],
        addends: [[0.0; P]; 3],
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
        added,
        finish,
        ..
    } = forces;
    let (rows, cols) = (sheet.grid().rows(), sheet.grid().cols());
    // The columns whose springs are found, and those whose particles they hold.
    let first = strip.start.saturating_sub(LEFT);
    let width = cols.min(strip.end + RIGHT) - first;
    let inside = PAD + strip.start - first..PAD + strip.end - first;
    laws::fill::<S>(&mut kept.laws, sheet, first, width);
    kept.spring_forces = [[0.0; P]; SPRING_FORCES];
    let (n, own) = (x.len() / 3, sheet.particles().start);
    let take = |row: usize, to: &mut [[f64; P]; 6]| {
        if row < rows {
            let seen = row * cols + first..row * cols + cols.min(strip.end + RIGHT + 2);
            for axis in 0..3 {
                let from = axis * n + own + seen.start..axis * n + own + seen.end;
                to[axis][PAD..PAD + seen.len()].copy_from_slice(&x[from.clone()]);
                if KIND != PLAIN || finish.drag.is_some() {
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
    let lanes = Lanes::new::<S>(P, width);
    for row in begin..wanted.end {
        take(row + 2, next2);
        let particles = own + row * cols + first..own + row * cols + first + width;
        let wanted_row = row.checked_sub(wanted.start);
        let to = |row: usize| row * cols + strip.start..row * cols + strip.end;
        if let Some(row) = wanted_row.filter(|_| *added) {
            for (addends, f) in kept.addends.iter_mut().zip(&*f) {
                addends[inside.clone()].copy_from_slice(&f[to(row)]);
            }
        }
        let mut springs = RowOfSprings {
            laws: &kept.laws,
            masks: sheet.masks(row, first),
            above: row,
            below: rows - 1 - row,
            spring_forces: kept.spring_forces.as_flattened_mut(),
        };
        let (places, f_row) = (here.as_flattened(), kept.f.as_flattened_mut());
        springs.find_along::<S, KIND>(simd, lanes, places);
        let put = Put::<S> {
            here: lanes.places::<S>(places, 0),
            f: lanes.at_mut::<S>(f_row),
        };
        let addends = added.then_some(kept.addends.as_flattened());
        let others = Others::<S>::new(simd, lanes, finish, &particles, addends);
        let below = [next.as_flattened(), next2.as_flattened()];
        springs.find_below::<S, KIND>(simd, lanes, below, &others, put);
        if let Some(row) = wanted_row {
            for (f, from) in f.iter_mut().zip(&kept.f) {
                f[to(row)].copy_from_slice(&from[inside.clone()]);
            }
        }
        swap(&mut here, &mut next);
        swap(&mut next, &mut next2);
    }
}

/// Writes forces down.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::Grid;
    use crate::random::SplitMix;

    /// The forces by one number at a time, and by every kind of vector that this processor has.
    #[test]
    fn vectors_of_any_length_give_the_same_bits() {
        let sizes = [(2, 2), (5, 3), (9, 33), (4, 140), (3, 515), (3, 1050)];
        let most = if cfg!(miri) { 2 } else { sizes.len() };
        for (rows, cols) in sizes.into_iter().take(most) {
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
                        quantity: Quantity::Forces,
                        sheet: &sheet,
                        x: &x,
                        v: &v,
                        rows: 0..rows,
                        f: columns_mut(&mut f),
                        added: false,
                        finish: &Finish::default(),
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
