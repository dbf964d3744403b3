//! Lower bounds of the distances of many pairs at once, in SIMD vectors.
//!
//! The plane perpendicular to the shortest line between two primitives bounds their distance from
//! below. Any other plane would, too, but less closely: so the closest points need not be exact to
//! the last bit, and are computed without branches.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use crate::geometry::PairKind;
use crate::lanes::Lanes;
use crate::vectors::Arch;

/// Number of pairs in a block, a multiple of the lengths of all SIMD vectors.
pub(super) const LANES: usize = 8;

/// Squared sine of the angle between two edges up to which they count as parallel.
const PARALLEL_SINE_SQUARED: f64 = 1e-6;

/// Coordinates of the four points of each pair: point, axis, pair.
type PairPoints<T> = [[T; 3]; 4];

/// Pairs of one kind, and the bounds of their distances.
pub(super) struct Block {
    /// Positions (m), of which the first are the origins.
    x: PairPoints<[f64; LANES]>,
    /// Velocities (m/s).
    v: PairPoints<[f64; LANES]>,
    /// Lower bound of the distance (m); not finite for a pair without a plane, such as one that
    /// touches.
    pub distance: [f64; LANES],
    /// Speed at which this bound shrinks (m/s).
    pub closing: [f64; LANES],
}

impl Block {
    pub fn new() -> Self {
        Self {
            x: [[[0.0; LANES]; 3]; 4],
            v: [[[0.0; LANES]; 3]; 4],
            distance: [0.0; LANES],
            closing: [0.0; LANES],
        }
    }

    /// Sets the positions (m) of the points of a pair, and their velocities (m/s) if they move.
    pub fn set(
        &mut self,
        lane: usize,
        points: [u32; 4],
        x: &[Vector3<f64>],
        v: Option<&[Vector3<f64>]>,
    ) {
        let origin = x[points[0] as usize];
        for (k, i) in points.into_iter().enumerate() {
            let x = &x[i as usize];
            for axis in 0..3 {
                self.x[k][axis][lane] = x[axis] - origin[axis];
            }
            if let Some(v) = v {
                let v = &v[i as usize];
                for axis in 0..3 {
                    self.v[k][axis][lane] = v[axis];
                }
            }
        }
    }

    /// Computes the bounds of pairs of vertices and triangles, or of edges.
    pub fn bound(&mut self, kind: PairKind) {
        Arch::new().dispatch(Bounding { kind, block: self });
    }
}

/// Task that bounds the distances of a block.
struct Bounding<'a> {
    kind: PairKind,
    block: &'a mut Block,
}

impl WithSimd for Bounding<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { kind, block } = self;
        for part in 0..LANES / S::F64_LANES {
            let x = load_all(simd, &block.x, part);
            let v = load_all(simd, &block.v, part);
            let normal =
                if kind == PairKind::EdgeEdge { between_edges(&x) } else { from_triangle(&x) };
            apart(kind, &x, normal).store(&mut block.distance, part);
            let closing = Lanes::splat(simd, 0.0) - apart(kind, &v, normal);
            closing.store(&mut block.closing, part);
        }
    }
}

#[inline(always)]
fn minus<S: Simd>(a: [Lanes<S>; 3], b: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
fn times<S: Simd>(a: [Lanes<S>; 3], b: Lanes<S>) -> [Lanes<S>; 3] {
    [a[0] * b, a[1] * b, a[2] * b]
}

#[inline(always)]
fn dot<S: Simd>(a: [Lanes<S>; 3], b: [Lanes<S>; 3]) -> Lanes<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
fn unit<S: Simd>(a: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    let one = Lanes::splat(a[0].simd, 1.0);
    times(a, one / dot(a, a).root())
}

/// Returns the lanes that are in all three masks.
#[inline(always)]
fn all<S: Simd>(simd: S, [a, b, c]: [S::m64s; 3]) -> S::m64s {
    simd.and_m64s(a, simd.and_m64s(b, c))
}

/// Returns the first numbers in the lanes of a mask, and the others elsewhere.
#[inline(always)]
fn choose<S: Simd>(mask: S::m64s, [a, b, c]: [Lanes<S>; 3], other: [Lanes<S>; 3]) -> [Lanes<S>; 3] {
    [a.where_or(mask, other[0]), b.where_or(mask, other[1]), c.where_or(mask, other[2])]
}

/// Returns a share of an edge, within its ends.
#[inline(always)]
fn within<S: Simd>(share: Lanes<S>) -> Lanes<S> {
    let (zero, one) = (Lanes::splat(share.simd, 0.0), Lanes::splat(share.simd, 1.0));
    share.most(zero).least(one)
}

/// Returns x / y, or 0 where y is 0, because an edge may be a point.
#[inline(always)]
fn over<S: Simd>(x: Lanes<S>, y: Lanes<S>) -> Lanes<S> {
    let (zero, one) = (Lanes::splat(x.simd, 0.0), Lanes::splat(x.simd, 1.0));
    let is_zero = y.at_most(zero);
    zero.where_or(is_zero, x) / one.where_or(is_zero, y)
}

/// Reads vectors number `part` of a point.
#[inline(always)]
fn load<S: Simd>(simd: S, [x, y, z]: &[[f64; LANES]; 3], part: usize) -> [Lanes<S>; 3] {
    [Lanes::load(simd, x, part), Lanes::load(simd, y, part), Lanes::load(simd, z, part)]
}

/// Reads vectors number `part` of all four points.
#[inline(always)]
fn load_all<S: Simd>(
    simd: S,
    [a, b, c, d]: &PairPoints<[f64; LANES]>,
    part: usize,
) -> PairPoints<Lanes<S>> {
    [load(simd, a, part), load(simd, b, part), load(simd, c, part), load(simd, d, part)]
}

/// Returns the distance, along the normal, between the planes through the nearest points of both
/// primitives.
#[inline(always)]
fn apart<S: Simd>(
    kind: PairKind,
    points: &PairPoints<Lanes<S>>,
    normal: [Lanes<S>; 3],
) -> Lanes<S> {
    let [a, b, c, d] = *points;
    let [a, b, c, d] = [dot(a, normal), dot(b, normal), dot(c, normal), dot(d, normal)];
    if kind == PairKind::EdgeEdge { a.least(b) - c.most(d) } else { a - b.most(c).most(d) }
}

/// Returns the direction from the nearest point of a triangle to a vertex (Ericson, *Real-Time
/// Collision Detection*, 2005, 5.1.5).
#[inline(always)]
fn from_triangle<S: Simd>(points: &PairPoints<Lanes<S>>) -> [Lanes<S>; 3] {
    let [p, a, b, c] = *points;
    let simd = p[0].simd;
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let (ab, ac) = (minus(b, a), minus(c, a));
    let [ap, bp, cp] = [minus(p, a), minus(p, b), minus(p, c)];
    let (d1, d2) = (dot(ab, ap), dot(ac, ap));
    let (d3, d4) = (dot(ab, bp), dot(ac, bp));
    let (d5, d6) = (dot(ab, cp), dot(ac, cp));
    let (vc, vb, va) = (d1 * d4 - d3 * d2, d5 * d2 - d1 * d6, d3 * d6 - d5 * d4);
    // The shares of b and c in the nearest point, over a common denominator: inside first, and then
    // each edge and corner whose region holds the vertex.
    let (to_c, to_b) = (d4 - d3, d5 - d6);
    let is_bc = all(simd, [va.at_most(zero), zero.at_most(to_c), zero.at_most(to_b)]);
    let is_ca = all(simd, [vb.at_most(zero), zero.at_most(d2), d6.at_most(zero)]);
    let is_c = simd.and_m64s(zero.at_most(d6), d5.at_most(d6));
    let is_ab = all(simd, [vc.at_most(zero), zero.at_most(d1), d3.at_most(zero)]);
    let is_b = simd.and_m64s(zero.at_most(d3), d4.at_most(d3));
    let is_a = simd.and_m64s(d1.at_most(zero), d2.at_most(zero));
    let shares = [vb, vc, va + vb + vc];
    let shares = choose(is_bc, [to_b, to_c, to_b + to_c], shares);
    let shares = choose(is_ca, [zero, d2, d2 - d6], shares);
    let shares = choose(is_c, [zero, one, one], shares);
    let shares = choose(is_ab, [d1, zero, d1 - d3], shares);
    let shares = choose(is_b, [one, zero, one], shares);
    let [v, w, whole] = choose(is_a, [zero, zero, one], shares);
    let share = one / whole;
    let along = minus(ap, times(ab, v * share));
    unit(minus(along, times(ac, w * share)))
}

/// Returns the direction from the nearest point of the second edge to that of the first (Ericson,
/// 5.1.9). Of parallel edges, the line through the first end of the first is tried.
#[inline(always)]
fn between_edges<S: Simd>(points: &PairPoints<Lanes<S>>) -> [Lanes<S>; 3] {
    let [p, q, r, s] = *points;
    let simd = p[0].simd;
    let (zero, one) = (Lanes::splat(simd, 0.0), Lanes::splat(simd, 1.0));
    let (first, second, between) = (minus(q, p), minus(s, r), minus(p, r));
    let (a, e, b) = (dot(first, first), dot(second, second), dot(first, second));
    let (c, f) = (dot(first, between), dot(second, between));
    let cross = a * e - b * b;
    let is_parallel = cross.at_most(Lanes::splat(simd, PARALLEL_SINE_SQUARED) * a * e);
    let on_first = zero.where_or(is_parallel, b * f - c * e);
    let on_first = within(on_first / one.where_or(is_parallel, cross));
    let on_second = within(over(b * on_first + f, e));
    // For that point of the second edge, the nearest of the first.
    let on_first = within(over(b * on_second - c, a));
    let to_first = times(first, on_first);
    let to_second = times(second, on_second);
    let offset = minus(between, to_second);
    unit([offset[0] + to_first[0], offset[1] + to_first[1], offset[2] + to_first[2]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::closest;
    use crate::random::SplitMix;

    /// Draws the points of a random pair: some pairs have parallel or flat primitives, points or
    /// equal vertices.
    fn random_points(random: &mut SplitMix) -> [Vector3<f64>; 4] {
        let mut point = || Vector3::from_fn(|_, _| random.between(-1.0, 1.0));
        let mut points = [point(), point(), point(), point()];
        let [a, b, c, _] = points;
        match random.between(0.0, 10.0) as u32 {
            0 => points[3] = c + (b - a) * random.between(-2.0, 2.0),
            1 => points[3] = c + (c - b) * random.between(-2.0, 2.0),
            2 => points[1] = a,
            3 => points[3] = c,
            4 => points[2] = a,
            5 => points = points.map(|x| Vector3::new(x.x, 0.0, x.z)),
            _ => {}
        }
        points
    }

    #[test]
    fn bounds_are_below_the_distances_and_near_them() {
        let mut random = SplitMix(8);
        let mut exact = 0;
        for kind in [PairKind::VertexTriangle, PairKind::EdgeEdge] {
            for _ in 0..4000 {
                let all: Vec<_> = (0..LANES).flat_map(|_| random_points(&mut random)).collect();
                let speeds: Vec<_> = (0..4 * LANES)
                    .map(|_| Vector3::from_fn(|_, _| random.between(-1.0, 1.0)))
                    .collect();
                let points = |lane: usize| [0, 1, 2, 3].map(|k| (4 * lane + k) as u32);
                let mut block = Block::new();
                for lane in 0..LANES {
                    block.set(lane, points(lane), &all, Some(&speeds));
                }
                block.bound(kind);
                for lane in 0..LANES {
                    let (distance, closing) = (block.distance[lane], block.closing[lane]);
                    if !distance.is_finite() {
                        continue;
                    }
                    let later = |t: f64| {
                        let x = points(lane).map(|i| all[i as usize] + speeds[i as usize] * t);
                        closest(kind, &x).offset.norm()
                    };
                    assert!(distance <= later(0.0) + 1e-12, "{distance} {}", later(0.0));
                    assert!(distance - 0.3 * closing <= later(0.3) + 1e-12);
                    exact += usize::from((distance - later(0.0)).abs() < 1e-9);
                }
            }
        }
        // The others touch, or are flat.
        assert!(exact > 2 * 4000 * LANES * 8 / 10, "{exact}");
    }
}
