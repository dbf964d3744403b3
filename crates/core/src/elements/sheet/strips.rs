//! One evaluation of a sheet. Rows of wide grids are cut into strips, so that the numbers stored
//! from row to row stay in the first-level cache, on the stack.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::mem::swap;
use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::super::finish::Finish;
use super::kernel::{
    CLAMPED, DAMPED, DIFFERENTIAL, Others, PLAIN, RowOfSprings, SPRING_FORCES, TANGENT, Use,
};
use super::lanes::{ColumnsMut, Lanes, Point, Points, Vectors, put};
use super::laws::{self, LAWS};
use super::model::Sheet;
use crate::columns::columns_mut;
use crate::rows::{PAD, REACH, stride};
use crate::threads::{fork, threads};
use crate::vectors::Arch;

/// Largest numbers of columns of a strip, whose numbers fit into a cache and are cleared only once.
const WIDTHS: [usize; 3] = [32, 128, 512];
/// Columns beside a strip whose springs pull at it.
const LEFT: usize = 2;
const RIGHT: usize = 1;

/// Quantity of a sheet's springs.
#[derive(Clone, Copy)]
pub(crate) enum Quantity {
    /// Forces on particles at x that move at v.
    Forces,
    /// Differential of the forces at x for a displacement and a velocity v, with the dampings of
    /// the laws. With `clamped`, negative stiffness across compressed springs is taken as 0.
    Tangent { clamped: bool },
    /// Differential of the forces on particles at x that move at v, for dx and dv.
    Differential,
}

/// Columns of particles: positions and velocities, and for differentials their changes.
const PLACES: usize = 6;
const CHANGES: usize = 12;

/// Sets f, on the particles of a sheet, to the finished sum of its springs' forces, plus the old f
/// if `added`. The `fields` are x and v, and for differentials dx and dv.
pub(crate) fn set(
    quantity: Quantity,
    sheet: &Sheet,
    fields: &[&[f64]],
    f: &mut [f64],
    added: bool,
    finish: &Finish,
) {
    let grid = sheet.grid();
    let own = columns_mut(f).map(|f| &mut f[sheet.particles()]);
    let bands = threads(grid.particles());
    fork(bands, 0..grid.rows(), grid.cols(), own, &|rows, f| {
        Arch::new().dispatch(StripForces { quantity, sheet, fields, rows, f, added, finish });
    });
}

struct StripForces<'a> {
    quantity: Quantity,
    sheet: &'a Sheet,
    fields: &'a [&'a [f64]],
    /// Rows whose forces are computed, and the forces there.
    rows: Range<usize>,
    f: [&'a mut [f64]; 3],
    /// Whether the springs' forces are added to the old ones.
    added: bool,
    finish: &'a Finish<'a>,
}

impl WithSimd for StripForces<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        match self.quantity {
            Quantity::Tangent { clamped: true } => strips::<S, CLAMPED, PLACES>(simd, self),
            Quantity::Tangent { clamped: false } => strips::<S, TANGENT, PLACES>(simd, self),
            Quantity::Differential => strips::<S, DIFFERENTIAL, CHANGES>(simd, self),
            Quantity::Forces if self.sheet.is_damped() => strips::<S, DAMPED, PLACES>(simd, self),
            Quantity::Forces => strips::<S, PLAIN, PLACES>(simd, self),
        }
    }
}

#[inline(always)]
fn strips<S: Simd, const KIND: u8, const C: usize>(simd: S, forces: StripForces) {
    const STRIDES: [usize; 3] = [stride(WIDTHS[0]), stride(WIDTHS[1]), stride(WIDTHS[2])];
    match forces.sheet.grid().cols() {
        // Scalar code depends less on the cache: one width is enough.
        _ if const { S::F64_LANES == 1 } => strips_of::<S, KIND, C, { STRIDES[1] }>(simd, forces),
        cols if cols <= WIDTHS[0] => strips_of::<S, KIND, C, { STRIDES[0] }>(simd, forces),
        cols if cols <= WIDTHS[1] => strips_of::<S, KIND, C, { STRIDES[1] }>(simd, forces),
        _ => strips_of::<S, KIND, C, { STRIDES[2] }>(simd, forces),
    }
}

/// Numbers of a strip that are stored from row to row.
#[repr(C, align(64))]
struct Kept<const C: usize, const P: usize> {
    /// Columns of three rows.
    places: [[[f64; P]; C]; 3],
    spring_forces: [[f64; P]; SPRING_FORCES],
    addends: [[f64; P]; 3],
    f: [[f64; P]; 3],
    laws: [f64; LAWS],
}

/// Cuts the columns into strips of about the same width.
#[inline(always)]
fn strips_of<S: Simd, const KIND: u8, const C: usize, const P: usize>(
    simd: S,
    mut forces: StripForces,
) {
    let cols = forces.sheet.grid().cols();
    let most = P - 2 * PAD;
    let count = if cols <= most { 1 } else { cols.div_ceil(most - LEFT - RIGHT) };
    let mut kept = Kept {
        places: [[[0.0; P]; C]; 3],
        spring_forces: [[0.0; P]; SPRING_FORCES],
        addends: [[0.0; P]; 3],
        f: [[0.0; P]; 3],
        laws: [0.0; LAWS],
    };
    for k in 0..count {
        let strip = k * cols / count..(k + 1) * cols / count;
        if k > 0 {
            kept.spring_forces = [[0.0; P]; SPRING_FORCES];
        }
        run::<S, KIND, C, P>(simd, &mut forces, &strip, &mut kept);
    }
}

#[inline(always)]
fn run<S: Simd, const KIND: u8, const C: usize, const P: usize>(
    simd: S,
    forces: &mut StripForces,
    strip: &Range<usize>,
    kept: &mut Kept<C, P>,
) {
    let StripForces { sheet, fields, rows: wanted, f, added, finish, .. } = forces;
    let (rows, cols) = (sheet.grid().rows(), sheet.grid().cols());
    // The columns whose springs are computed, and those of the particles at their ends.
    let first = strip.start.saturating_sub(LEFT);
    let width = cols.min(strip.end + RIGHT) - first;
    let inside = PAD + strip.start - first..PAD + strip.end - first;
    laws::fill::<S>(&mut kept.laws, sheet, first, width);
    let (n, own) = (fields[0].len() / 3, sheet.particles().start);
    // Forces of undamped springs depend on no velocities, unless there is drag.
    let read = if KIND == PLAIN && finish.drag.is_none() { 1 } else { C / 3 };
    let take = |row: usize, to: &mut [[f64; P]; C]| {
        if row < rows {
            let seen = row * cols + first..row * cols + cols.min(strip.end + RIGHT + 2);
            for column in 0..3 * read {
                let start = column % 3 * n + own + seen.start;
                let from = &fields[column / 3][start..start + seen.len()];
                to[column][PAD..PAD + seen.len()].copy_from_slice(from);
            }
        }
    };
    let [mut here, mut next, mut next2] = kept.places.each_mut();
    // The springs of the two rows above pull at the first row.
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
            here: lanes.points::<S>(places, KIND == DIFFERENTIAL, 0),
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

/// Use that writes forces.
struct Put<'a, S: Simd> {
    here: Points<'a, S>,
    f: ColumnsMut<'a, S>,
}

impl<S: Simd> Use<S> for Put<'_, S> {
    #[inline(always)]
    fn here(&self, i: usize) -> Point<S> {
        self.here.pick(i)
    }

    #[inline(always)]
    fn put(&mut self, _: S, i: usize, _: Point<S>, f: Vectors<S>) {
        put::<S>(&mut self.f, i, f);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::elements::axial;
    use crate::elements::force::At;
    use crate::geometry::Triangles;
    use crate::grid::Grid;
    use crate::random::SplitMix;

    /// Compares the forces by scalar code with those by every kind of vector that this processor
    /// has.
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
                    (0..n).map(|_| random.between(-1.0, 1.0)).collect::<Vec<_>>()
                };
                let all = [numbers(), numbers(), numbers(), numbers()];
                let fields = all.each_ref().map(|field| &field[..]);
                for quantity in [Quantity::Forces, Quantity::Differential] {
                    let by = |run: &dyn Fn(StripForces)| {
                        let mut f = vec![f64::NAN; fields[0].len()];
                        run(StripForces {
                            quantity,
                            sheet: &sheet,
                            fields: &fields,
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
                            let StripForces { rows, f, .. } = forces;
                            fork(bands, rows, cols, f, &|rows, f| {
                                Arch::new().dispatch(StripForces { rows, f, ..forces });
                            });
                        });
                        assert!(found == expected, "{bands} bands");
                    }
                    #[cfg(target_arch = "x86_64")]
                    if let Some(avx2) = pulp::x86::V3::try_new() {
                        assert_eq!(by(&|forces| Simd::vectorize(avx2, forces)), expected);
                    }
                }
                // The oracle: spring by spring.
                let mut expected = vec![0.0; fields[0].len()];
                let [x, v, dx, dv] = fields;
                let at = At { t: 0.0, x, v, masses: &[], triangles: &Triangles::default() };
                for spring in sheet.springs() {
                    axial::add_differential(&spring, &at, [dx, dv], &mut expected);
                }
                let mut found = vec![0.0; expected.len()];
                let finish = Finish::default();
                set(Quantity::Differential, &sheet, &fields, &mut found, false, &finish);
                let size = expected.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
                for (found, expected) in found.iter().zip(&expected) {
                    assert!((found - expected).abs() < 1e-13 * size, "{found} {expected}");
                }
            }
        }
    }
}
