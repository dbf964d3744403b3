//! The springs of a row, computed direction by direction and vector by vector. Each spring pulls at
//! its own row, and at the same or one of the next two, for which its force is stored. The bits are
//! the same on every processor: multiplications and additions are always fused, and the sums have
//! one order.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::mem::swap;
use std::ops::Range;

use pulp::Simd;

use super::super::finish::Finish;
use super::lanes::{
    Columns, Lanes, Numbers, Point, Points, Vectors, add, dot, pick, plus, put, replace, sub,
};
use super::laws::{Law, kind};
use super::missing::Masks;
use crate::elements::inverse_root::inverse_root;
use crate::fused::{mul_adds, negate_mul_adds};

/// Number of columns of forces that are stored from row to row, by the direction of the springs:
/// right; two right; down; down and right, of this row and of the one above; down and left, of
/// both; and two down, of both.
pub(crate) const SPRING_FORCES: usize = 3 * 9;

/// Quantities of springs: forces, undamped or damped; products of their tangent with a vector,
/// clamped or not; and the differential of the forces.
pub(super) const PLAIN: u8 = 0;
pub(super) const DAMPED: u8 = 1;
pub(super) const TANGENT: u8 = 2;
pub(super) const CLAMPED: u8 = 3;
pub(super) const DIFFERENTIAL: u8 = 4;

/// Addends to the forces of springs on a row, and the operations that finish the sum.
pub(super) struct Others<'a, S: Simd> {
    addends: Option<Columns<'a, S>>,
    gravity: Option<(Vectors<S>, Numbers<'a, S>)>,
    drag: Option<S::f64s>,
    inertia: Option<Numbers<'a, S>>,
    inverse_masses: Option<Numbers<'a, S>>,
}

impl<'a, S: Simd> Others<'a, S> {
    #[inline(always)]
    pub fn new(
        simd: S,
        lanes: Lanes,
        finish: &Finish<'a>,
        particles: &Range<usize>,
        addends: Option<&'a [f64]>,
    ) -> Self {
        Self {
            addends: addends.map(|addends| lanes.at::<S>(addends, 0, 0)),
            gravity: finish.gravity.map(|(g, masses)| {
                let g = [simd.splat_f64s(g.x), simd.splat_f64s(g.y), simd.splat_f64s(g.z)];
                (g, Numbers::new(masses, particles))
            }),
            drag: finish.drag.map(|c| simd.splat_f64s(c)),
            inertia: finish.inertia.map(|masses| Numbers::new(masses, particles)),
            inverse_masses: finish
                .inverse_masses
                .map(|inverse_masses| Numbers::new(inverse_masses, particles)),
        }
    }

    #[inline(always)]
    fn apply(&self, simd: S, i: usize, u: Vectors<S>, f: Vectors<S>) -> Vectors<S> {
        let mut f = f;
        if let Some(addends) = self.addends {
            f = add::<S>(simd, f, pick::<S>(addends, i));
        }
        if let Some((g, masses)) = self.gravity {
            f = plus::<S>(simd, f, masses.at(simd, i), g);
        }
        if let Some(c) = self.drag {
            f = [
                negate_mul_adds(simd, c, u[0], f[0]),
                negate_mul_adds(simd, c, u[1], f[1]),
                negate_mul_adds(simd, c, u[2], f[2]),
            ];
        }
        if let Some(masses) = self.inertia {
            let m = masses.at(simd, i);
            f = [
                mul_adds(simd, m, u[0], simd.neg_f64s(f[0])),
                mul_adds(simd, m, u[1], simd.neg_f64s(f[1])),
                mul_adds(simd, m, u[2], simd.neg_f64s(f[2])),
            ];
        }
        if let Some(inverse_masses) = self.inverse_masses {
            let w = inverse_masses.at(simd, i);
            f = [simd.mul_f64s(f[0], w), simd.mul_f64s(f[1], w), simd.mul_f64s(f[2], w)];
        }
        f
    }
}

/// Source of the particles of a row, and use of the sums for them.
pub(super) trait Use<S: Simd> {
    /// Returns the particles of vector i.
    fn here(&self, i: usize) -> Point<S>;

    /// Uses the finished sum f of vector i.
    fn put(&mut self, simd: S, i: usize, here: Point<S>, f: Vectors<S>);
}

/// The springs that start in a row.
pub(super) struct RowOfSprings<'a> {
    pub laws: &'a [f64],
    /// Masks of the row, if springs are missing in it.
    pub masks: Option<Masks<'a>>,
    /// Numbers of rows above and below.
    pub above: usize,
    pub below: usize,
    /// Forces that are stored from row to row.
    pub spring_forces: &'a mut [f64],
}

impl RowOfSprings<'_> {
    /// Computes the springs along the row.
    #[inline(always)]
    pub fn find_along<S: Simd, const KIND: u8>(&mut self, simd: S, lanes: Lanes, here: &[f64]) {
        if self.masks.is_none() {
            self.along::<S, KIND, false>(simd, lanes, here);
        } else {
            self.along::<S, KIND, true>(simd, lanes, here);
        }
    }

    #[inline(always)]
    fn along<S: Simd, const KIND: u8, const MASKED: bool>(
        &mut self,
        simd: S,
        lanes: Lanes,
        here: &[f64],
    ) {
        let three = 3 * lanes.stride;
        let (right, right2) = self.spring_forces[..2 * three].split_at_mut(three);
        let (mut right, mut right2) = (lanes.at_mut::<S>(right), lanes.at_mut::<S>(right2));
        let laws = |direction| {
            let of = (self.laws, self.masks);
            Law::<S, MASKED>::new(simd, of, direction, self.below, lanes.count)
        };
        let (a, b) = (laws(0), laws(4));
        let points = |shift| lanes.points::<S>(here, KIND == DIFFERENTIAL, shift);
        let [here, one, two] = [points(0), points(1), points(2)];
        for i in 0..lanes.count {
            let (p, kind) = (here.pick(i), kind(i, lanes.count));
            let force = spring::<S, KIND>(simd, a.at(simd, i, kind), p, one, i);
            put::<S>(&mut right, i, force);
            let force = spring::<S, KIND>(simd, b.at(simd, i, kind), p, two, i);
            put::<S>(&mut right2, i, force);
        }
    }

    /// Computes the springs to the rows below, and sums the forces on the row.
    #[inline(always)]
    pub fn find_below<S: Simd, const KIND: u8>(
        &mut self,
        simd: S,
        lanes: Lanes,
        below: [&[f64]; 2],
        others: &Others<S>,
        then: impl Use<S>,
    ) {
        if self.masks.is_none() {
            self.down::<S, KIND, false>(simd, lanes, below, others, then);
        } else {
            self.down::<S, KIND, true>(simd, lanes, below, others, then);
        }
    }

    #[inline(always)]
    fn down<S: Simd, const KIND: u8, const MASKED: bool>(
        &mut self,
        simd: S,
        lanes: Lanes,
        [next, next2]: [&[f64]; 2],
        others: &Others<S>,
        mut then: impl Use<S>,
    ) {
        let three = 3 * lanes.stride;
        let (right, rest) = self.spring_forces.split_at_mut(three);
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
        // Columns of the row before last, which this row's forces replace.
        let down2 = if is_odd { odd } else { even };
        let laws = |direction| {
            let of = (self.laws, self.masks);
            Law::<S, MASKED>::new(simd, of, direction, self.below, lanes.count)
        };
        let (a, b, c, d) = (laws(1), laws(2), laws(3), laws(5));
        let points = |row, shift| lanes.points::<S>(row, KIND == DIFFERENTIAL, shift);
        let [ax, bx] = [points(next, 0), points(next, 1)];
        let [cx, dx] = [points(next, -1), points(next2, 0)];
        let (mut to_a, mut to_b) = (lanes.at_mut::<S>(down), lanes.at_mut::<S>(backslash));
        let (mut to_c, mut to_d) = (lanes.at_mut::<S>(slash), lanes.at_mut::<S>(down2));
        let (left, left2) = (lanes.at::<S>(right, 0, -1), lanes.at::<S>(right2, 0, -2));
        let (begun, begun2) = (lanes.at::<S>(right, 0, 0), lanes.at::<S>(right2, 0, 0));
        let above_left = lanes.at::<S>(from_left, 0, -1);
        let above_right = lanes.at::<S>(from_right, 0, 1);
        for i in 0..lanes.count {
            let (p, kind) = (then.here(i), kind(i, lanes.count));
            let mut all = sub::<S>(simd, pick::<S>(left, i), pick::<S>(begun, i));
            let pull = sub::<S>(simd, pick::<S>(left2, i), pick::<S>(begun2, i));
            all = add::<S>(simd, all, pull);
            let force = spring::<S, KIND>(simd, a.at(simd, i, kind), p, ax, i);
            let above = replace::<S>(&mut to_a, i, force);
            all = add::<S>(simd, all, sub::<S>(simd, above, force));
            let force = spring::<S, KIND>(simd, b.at(simd, i, kind), p, bx, i);
            put::<S>(&mut to_b, i, force);
            all = add::<S>(simd, all, sub::<S>(simd, pick::<S>(above_left, i), force));
            let force = spring::<S, KIND>(simd, c.at(simd, i, kind), p, cx, i);
            put::<S>(&mut to_c, i, force);
            all = add::<S>(simd, all, sub::<S>(simd, pick::<S>(above_right, i), force));
            let force = spring::<S, KIND>(simd, d.at(simd, i, kind), p, dx, i);
            let above2 = replace::<S>(&mut to_d, i, force);
            all = add::<S>(simd, all, sub::<S>(simd, above2, force));
            then.put(simd, i, p, others.apply(simd, i, p[1], all));
        }
    }
}

/// Returns the forces of springs between particles: s d with s = k - k r / L + c (w . d) / L2. For
/// a tangent, with w the difference of the vectors and q = k - k r / L, they are q w + (k - q + c)
/// (w . d) d / L2; for a differential, with the changes e of d and g of w, s e + ds d.
#[inline(always)]
fn spring<S: Simd, const KIND: u8>(
    simd: S,
    law: Vectors<S>,
    [p, u, dp, du]: Point<S>,
    others: Points<S>,
    i: usize,
) -> Vectors<S> {
    let [x, v, dx, dv] = others.pick(i);
    let d = sub::<S>(simd, p, x);
    let square = dot(simd, d, d);
    let mut inverse = inverse_root(simd, square);
    if KIND == TANGENT || KIND == CLAMPED || KIND == DIFFERENTIAL {
        let zero = simd.splat_f64s(0.0);
        // A spring of length 0 has no direction.
        let has_length = simd.less_than_f64s(zero, square);
        inverse = simd.select_f64s(has_length, inverse, zero);
    }
    let mut s = negate_mul_adds(simd, law[1], inverse, law[0]);
    if KIND == TANGENT || KIND == CLAMPED {
        if KIND == CLAMPED {
            s = simd.max_f64s(s, simd.splat_f64s(0.0));
        }
        let w = sub::<S>(simd, u, v);
        let turn = twice(simd, dot(simd, w, d), inverse);
        let more = simd.add_f64s(simd.sub_f64s(law[0], s), law[2]);
        return sum_of::<S>(simd, s, w, simd.mul_f64s(turn, more), d);
    }
    if KIND == DIFFERENTIAL {
        let (w, e, g) = (sub::<S>(simd, u, v), sub::<S>(simd, dp, dx), sub::<S>(simd, du, dv));
        let rate = twice(simd, dot(simd, w, d), inverse);
        let share = twice(simd, dot(simd, e, d), inverse);
        // c ((g . d) + (w . e) - 2 (w . d) (e . d) / L2) / L2
        let turned = simd.add_f64s(dot(simd, g, d), dot(simd, w, e));
        let lost = simd.mul_f64s(simd.add_f64s(rate, rate), share);
        let damping = simd.mul_f64s(law[2], simd.sub_f64s(twice(simd, turned, inverse), lost));
        let ds = mul_adds(simd, simd.sub_f64s(law[0], s), share, damping);
        let s = mul_adds(simd, law[2], rate, s);
        return sum_of::<S>(simd, s, e, ds, d);
    }
    if KIND == DAMPED {
        let rate = twice(simd, dot(simd, sub::<S>(simd, u, v), d), inverse);
        s = mul_adds(simd, law[2], rate, s);
    }
    [simd.mul_f64s(s, d[0]), simd.mul_f64s(s, d[1]), simd.mul_f64s(s, d[2])]
}

/// Returns a b2.
#[inline(always)]
fn twice<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> S::f64s {
    simd.mul_f64s(simd.mul_f64s(a, b), b)
}

/// Returns a x + b y.
#[inline(always)]
fn sum_of<S: Simd>(simd: S, a: S::f64s, x: Vectors<S>, b: S::f64s, y: Vectors<S>) -> Vectors<S> {
    [
        mul_adds(simd, b, y[0], simd.mul_f64s(a, x[0])),
        mul_adds(simd, b, y[1], simd.mul_f64s(a, x[1])),
        mul_adds(simd, b, y[2], simd.mul_f64s(a, x[2])),
    ]
}
