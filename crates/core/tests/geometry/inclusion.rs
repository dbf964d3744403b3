//! Tight inclusion: whether two primitives meet, by bisection of the boxes of (t, u, v) with
//! conservative bounds (Wang, Ferguson, Schneider, Jiang, Attene, Panozzo, *A large-scale benchmark
//! and an inclusion-based algorithm for continuous collision detection*, 2021).
//!
//! The vector F(t, u, v) between two points of the primitives is linear in each parameter, so its
//! values in a box of parameters lie within the box around those at the corners. If that box does
//! not contain 0, there is no root in it.

use a3_core::Vector3;
use a3_core::contact::{PairKind, closest};
use nalgebra::Rotation3;

/// Error of F in units of the largest coordinate. There are at most 10 roundings of 2^-53 in F
/// (parameters are dyadic, so 1 - t and 1 - u - v are exact), 2 at the end of the step, and 11 in
/// the rotation of points.
const FILTER: f64 = 32.0 * f64::EPSILON / 2.0;

/// Variation of F (m) below which a box is not split.
const WIDTH: f64 = 1e-12;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// No root: certain.
    Apart,
    /// Root, or a value that is nearer to one than the filter and the least width of boxes allow.
    Meets,
    /// More boxes than the budget has.
    Undecided,
}

/// Whether two primitives come nearer than `separation` (m) in a maximum norm along the axes or, if
/// that is not decided quickly, along axes that include the normal where they are nearest.
pub fn meet(
    kind: PairKind,
    from: &[Vector3<f64>; 4],
    to: &[Vector3<f64>; 4],
    separation: f64,
) -> Verdict {
    let reach = separation + FILTER * from.iter().chain(to).map(Vector3::amax).fold(0.0, f64::max);
    let verdict = search(kind, from, to, reach, 300);
    if verdict != Verdict::Undecided {
        return verdict;
    }
    let offsets = (0..=64).map(|k| {
        let t = f64::from(k) / 64.0;
        closest(kind, &std::array::from_fn(|i| from[i].lerp(&to[i], t))).offset
    });
    let normal = offsets.min_by(|a, b| a.norm().total_cmp(&b.norm())).unwrap();
    let across = Vector3::ith(normal.iamin(), 1.0);
    let turn = Rotation3::face_towards(&normal, &across);
    let seen = |points: &[Vector3<f64>; 4]| points.map(|x| turn.inverse() * x);
    search(kind, &seen(from), &seen(to), reach, 3000)
}

fn search(
    kind: PairKind,
    from: &[Vector3<f64>; 4],
    to: &[Vector3<f64>; 4],
    reach: f64,
    budget: usize,
) -> Verdict {
    // Largest change of F while a parameter goes from 0 to 1.
    let extent = |a: usize, b: usize| (from[a] - from[b]).amax().max((to[a] - to[b]).amax());
    let moves: [f64; 4] = std::array::from_fn(|i| (to[i] - from[i]).amax());
    let time = moves.into_iter().fold(0.0, f64::max);
    let scales = match kind {
        PairKind::EdgeEdge => [time, extent(0, 1), extent(2, 3)],
        _ => [time, extent(1, 2), extent(1, 3)],
    };
    let mut boxes = vec![[[0.0, 1.0]; 3]];
    for _ in 0..budget {
        let Some(parameters) = boxes.pop() else {
            return Verdict::Apart;
        };
        let (low, high) = bounds(kind, from, to, &parameters);
        if low.max() > reach || high.min() < -reach {
            continue;
        }
        let inside = low.min() >= -reach && high.max() <= reach;
        if inside || (high - low).amax() <= WIDTH {
            return Verdict::Meets;
        }
        let length = |k: usize| (parameters[k][1] - parameters[k][0]) * scales[k];
        let longest = |k, other| if length(other) > length(k) { other } else { k };
        let k = (0..3).fold(0, longest);
        let [a, b] = parameters[k];
        let middle = 0.5 * (a + b);
        for half in [[middle, b], [a, middle]] {
            let mut part = parameters;
            part[k] = half;
            if kind == PairKind::EdgeEdge || part[1][0] + part[2][0] <= 1.0 {
                boxes.push(part);
            }
        }
    }
    Verdict::Undecided
}

/// Bounds of F in a box, which are those of its values at the corners.
fn bounds(
    kind: PairKind,
    from: &[Vector3<f64>; 4],
    to: &[Vector3<f64>; 4],
    [times, us, vs]: &[[f64; 2]; 3],
) -> (Vector3<f64>, Vector3<f64>) {
    let mut low = Vector3::repeat(f64::INFINITY);
    let mut high = -low;
    for &t in times {
        let at: [Vector3<f64>; 4] = std::array::from_fn(|i| from[i] * (1.0 - t) + to[i] * t);
        for &u in us {
            for &v in vs {
                let value = if kind == PairKind::EdgeEdge {
                    (at[0] * (1.0 - u) + at[1] * u) - (at[2] * (1.0 - v) + at[3] * v)
                } else {
                    at[0] - (at[1] * (1.0 - u - v) + at[2] * u + at[3] * v)
                };
                low = low.inf(&value);
                high = high.sup(&value);
            }
        }
    }
    (low, high)
}
