//! Continuous collision detection: whether two primitives, whose points move linearly during a
//! step, stay apart; by conservative advancement (Li, Kaufman, Jiang, *Codimensional incremental
//! potential contact*, 2021, additive CCD).
//!
//! At a time t, the closest points give a plane between the primitives, with normal n. The distance
//! of point i of the first from point j of the second along n is
//!
//! ```text
//! n . (x_i - x_j) + s n . (u_i - u_j)     at the time t + s,
//! ```
//!
//! and that of the primitives, being convex, is at least the smallest of these. So the primitives
//! cannot come as near as the gap before the first of these distances does: the pair is advanced to
//! that time, where it gets a new plane. The bound of the paper uses the sum of the lengths of both
//! displacements instead of the product with n, and advances less; a pair that slides or separates
//! needs only one plane here. Any plane between the primitives proves that they are apart, even if
//! the closest points are inaccurate.
//!
//! If the far end of a long primitive moves much, it soon crosses every plane near the other
//! primitive. Therefore, if planes advance little, the longer primitive or the step is halved, and
//! halves whose boxes stay apart are dropped.

use crate::geometry::{Closest, PairKind, closest, weighted};
use nalgebra::Vector3;

/// Share of the gap, or of the pair's distance at first if that is less, up to which an error of a
/// distance does not matter. Both are without the radius.
const GAP_TOLERANCE: f64 = 1e-5;

/// Share of the sum of the magnitudes of all coordinates below which a distance may be a rounding
/// error.
const ROUNDING: f64 = 1e-13;

/// Least gap, as a share of the same sum, that callers from outside get.
const LEAST_GAP_SHARE: f64 = 1e-11;

/// Share of the same sum by which rounding may change a distance.
const ROUNDING_ERROR: f64 = 1e-15;

/// Share of the gap, or of a pair's distance above it if that is less, by which a hit may be
/// farther apart than the gap; also the share of its room that a pair which begins nearer than the
/// gap may lose.
const NEAR_SHARE: f64 = 0.1;

/// Share of the distance of the closest points that a plane proves, if rounding has not turned it.
const STRAIGHT_SHARE: f64 = 0.99;

/// Largest number of planes for a pair. The search then returns the time reached so far.
const MAX_PLANES: usize = 20_000;

/// Number of planes after which a pair is halved.
const MAX_PLANES_OF_PAIR: usize = 256;

/// Number of planes after which a half is halved again.
const MAX_PLANES_OF_PART: usize = 16;

/// Returns the share of a step at which a pair comes as near as `gap`, or `None` if it never does.
///
/// The points (m) move linearly from `from` to `from + moves` (m). For round primitives, `radius`
/// is the sum of the radii (m), and included in `gap` (m, at least 0). `None` is a certificate that
/// the pair is farther apart than the gap during the whole step. `Some(t)` is conservative: the
/// pair is farther apart than the gap until t, and by at most a tenth of the gap or of its distance
/// above the gap at first; only if 20 000 planes do not decide, it may be farther apart at t. Both
/// allow for 1e-5 of the gap, which is at least 1e-11 of the sum of all coordinates, and for about
/// 1e-12 of the largest one, more than rounding here and in the sums `from + moves`.
///
/// A pair that begins nearer than the gap is hit at once, `Some(0.0)`, if its closest points
/// approach. Otherwise it may separate, slide and turn: it is only hit if it would lose a tenth of
/// its room, the distance above the radius. A pair that begins touching is hit whatever its motion,
/// because it is unknown on which sides its primitives belong. For round primitives that is known,
/// so they may separate, and lose up to three times this allowance if they turn.
///
/// Edges and triangles may be degenerate. The distance of a [`PairKind::VertexFloor`] is the signed
/// height of the vertex above the floor; if it begins below the gap, it is hit if the vertex sinks.
/// Numbers that are not finite are a hit.
///
/// ```
/// use a3_core::Vector3;
/// use a3_core::contact::{PairKind, time_of_impact};
///
/// // A vertex falls by 2 m from 1 m above a triangle.
/// let at = |x, y, z| Vector3::new(x, y, z);
/// let from = [at(0.2, 1.0, 0.2), at(0.0, 0.0, 0.0), at(0.0, 0.0, 1.0), at(1.0, 0.0, 0.0)];
/// let fall = at(0.0, -2.0, 0.0);
/// let moves = [fall, Vector3::zeros(), Vector3::zeros(), Vector3::zeros()];
/// let time = time_of_impact(PairKind::VertexTriangle, &from, &moves, 0.0, 0.01).unwrap();
/// assert!(time < 0.5 && time > 0.49);
/// let away = moves.map(|it| -it);
/// assert!(time_of_impact(PairKind::VertexTriangle, &from, &away, 0.0, 0.01).is_none());
/// ```
#[must_use]
pub fn time_of_impact(
    kind: PairKind,
    from: &[Vector3<f64>; 4],
    moves: &[Vector3<f64>; 4],
    radius: f64,
    gap: f64,
) -> Option<f64> {
    // A gap of 0 leaves no room for rounding.
    let least = radius + LEAST_GAP_SHARE * (magnitude(from) + magnitude(moves));
    time_and_planes(kind, from, moves, radius, gap.max(least)).0
}

/// Returns what [`time_of_impact`] returns, with the number of planes that it took.
pub(super) fn time_and_planes(
    kind: PairKind,
    from: &[Vector3<f64>; 4],
    moves: &[Vector3<f64>; 4],
    radius: f64,
    gap: f64,
) -> (Option<f64>, usize) {
    let magnitude = magnitude(from) + magnitude(moves);
    if !magnitude.is_finite() {
        return (Some(0.0), 0);
    }
    let tolerance =
        |room: f64| GAP_TOLERANCE * room.min(gap - radius).max(0.0) + ROUNDING * magnitude;
    // Approach (m) during the step above which a pair that begins nearer than the gap is hit.
    let approach =
        |room: f64| tolerance(room).min(NEAR_SHARE * room.max(0.0)) + ROUNDING_ERROR * magnitude;
    if kind == PairKind::VertexFloor {
        let (height, rise) = (from[0].y - from[1].y, moves[0].y - moves[1].y);
        let room = height - radius;
        let time = sinks_to(gap, height, rise, tolerance(room), approach(room));
        return (time, 0);
    }
    // Relative to point 0, so that large coordinates do not spoil small distances.
    let (from, moves) = (from.map(|x| x - from[0]), moves.map(|u| u - moves[0]));
    let plane = Plane::between(kind, &from, &moves);
    let (mut least, room) = (gap, plane.apart - radius);
    let tolerance = tolerance(room);
    if plane.apart <= gap + 2.0 * tolerance {
        let touches = NEAR_SHARE * room <= 2.0 * tolerance;
        if plane.rate < -approach(room) || (touches && radius == 0.0) {
            return (Some(0.0), 1);
        }
        least = plane.apart - (NEAR_SHARE * room).max(2.0 * tolerance);
    }
    let near = least + tolerance + NEAR_SHARE * gap.min(plane.apart - least);
    let mut search = HitSearch { kind, gaps: [least, near], planes: MAX_PLANES };
    let time = search.first_hit(&from, &moves, plane, MAX_PLANES_OF_PAIR);
    (time, MAX_PLANES - search.planes)
}

/// Search for the first time at which a pair, or a part of it, is hit.
struct HitSearch {
    kind: PairKind,
    /// Distance (m) that is kept, and distance at which a pair counts as hit.
    gaps: [f64; 2],
    /// Number of planes left.
    planes: usize,
}

impl HitSearch {
    /// Finds the share of the motion at which a pair is hit, whose first plane is given. It uses at
    /// most `most` planes, and then halves the motion.
    fn first_hit(
        &mut self,
        from: &[Vector3<f64>; 4],
        moves: &[Vector3<f64>; 4],
        mut plane: Plane,
        most: usize,
    ) -> Option<f64> {
        let [least, near] = self.gaps;
        let (mut t, mut at) = (0.0, *from);
        for _ in 0..most.min(self.planes) {
            self.planes -= 1;
            if plane.apart <= near {
                return Some(t);
            }
            t += plane.holds_for(least + NEAR_SHARE * (near - least));
            if t >= 1.0 {
                return None;
            }
            at = std::array::from_fn(|i| from[i] + moves[i] * t);
            plane = Plane::between(self.kind, &at, moves);
        }
        let left = 1.0 - t;
        if self.planes == 0 {
            return Some(t);
        }
        let mut moves = moves.map(|u| u * left);
        let [a, b] = longest_edge(self.kind, &at);
        let length = (at[a] - at[b]).norm();
        let travel = moves.map(|u| (u - moves[0]).norm()).into_iter();
        if travel.fold(0.0, f64::max) > length {
            moves = moves.map(|u| 0.5 * u);
            let middle = std::array::from_fn(|i| at[i] + moves[i]);
            let first = self.hit_of_part(&at, &moves);
            let hit = first.or_else(|| Some(1.0 + self.hit_of_part(&middle, &moves)?));
            return hit.map(|hit| t + 0.5 * left * hit);
        }
        let mut hit = None;
        for (end, other) in [(a, b), (b, a)] {
            let halved = |points: &[Vector3<f64>; 4]| {
                let mut half = *points;
                half[end] = 0.5 * (points[end] + points[other]);
                half
            };
            // The second half matters only if it is hit before the first.
            let until = hit.unwrap_or(1.0);
            let moves = halved(&moves).map(|u| u * until);
            let earlier = self.hit_of_part(&halved(&at), &moves);
            hit = earlier.map(|earlier| until * earlier).or(hit);
        }
        hit.map(|hit| t + left * hit)
    }

    /// Finds the share of a part's motion at which it is hit.
    fn hit_of_part(&mut self, from: &[Vector3<f64>; 4], moves: &[Vector3<f64>; 4]) -> Option<f64> {
        if are_apart(self.kind, from, moves, self.gaps[1]) {
            return None;
        }
        let plane = Plane::between(self.kind, from, moves);
        self.first_hit(from, moves, plane, MAX_PLANES_OF_PART)
    }
}

/// Returns the ends of the longest edge of two primitives.
fn longest_edge(kind: PairKind, x: &[Vector3<f64>; 4]) -> [usize; 2] {
    let edges = match kind {
        PairKind::EdgeEdge => &[[0, 1], [2, 3]][..],
        _ => &[[1, 2], [2, 3], [3, 1]],
    };
    let length = |[a, b]: &[usize; 2]| (x[*a] - x[*b]).norm_squared();
    let longest = edges.iter().max_by(|a, b| length(a).total_cmp(&length(b)));
    longest.copied().unwrap_or([1, 2])
}

/// Sums the magnitudes of all coordinates of points (m).
fn magnitude(points: &[Vector3<f64>; 4]) -> f64 {
    points.iter().map(|x| x.abs().sum()).sum()
}

/// Returns an upper bound of the rounding error (m) of a distance between these primitives.
pub(super) fn rounding_error(points: &[Vector3<f64>; 4]) -> f64 {
    ROUNDING_ERROR * magnitude(points)
}

/// Finds the share of a step at which a vertex sinks to `gap` (m), given its height above a floor
/// and its rise in the step (m). One that begins lower is hit if it sinks by `approach` (m).
fn sinks_to(gap: f64, height: f64, rise: f64, tolerance: f64, approach: f64) -> Option<f64> {
    let above = height - gap;
    if above <= 2.0 * tolerance {
        return (rise < -approach).then_some(0.0);
    }
    let near = NEAR_SHARE * (tolerance + NEAR_SHARE * gap.min(above));
    (above + rise < near).then(|| (above - near) / -rise)
}

/// Returns whether the boxes of two primitives in motion, relative to point 0, are farther apart
/// than a gap.
pub(super) fn are_apart(
    kind: PairKind,
    from: &[Vector3<f64>; 4],
    moves: &[Vector3<f64>; 4],
    gap: f64,
) -> bool {
    let (x, u) = (from.map(|x| x - from[0]), moves.map(|u| u - moves[0]));
    (0..3).any(|axis| {
        let low = |k: usize| x[k][axis].min(x[k][axis] + u[k][axis]);
        let high = |k: usize| x[k][axis].max(x[k][axis] + u[k][axis]);
        let [first, second] = match kind {
            PairKind::VertexTriangle => {
                [[0.0; 2], [low(1).min(low(2)).min(low(3)), high(1).max(high(2)).max(high(3))]]
            }
            PairKind::EdgeEdge => {
                [[low(1).min(0.0), high(1).max(0.0)], [low(2).min(low(3)), high(2).max(high(3))]]
            }
            PairKind::VertexFloor => return false,
        };
        second[0] - first[1] > gap || first[0] - second[1] > gap
    })
}

/// Plane between two primitives, perpendicular to the line through their closest points or, if
/// rounding turns that line, along the larger primitive.
struct Plane {
    /// Distance along the normal of each point of the first primitive from each point of the second
    /// (m).
    distances: [f64; 4],
    /// Changes of these distances in the whole step (m).
    rates: [f64; 4],
    /// Smallest of these distances (m), a lower bound of that of the primitives.
    apart: f64,
    /// Change of the distance of the closest points in the whole step (m).
    rate: f64,
}

impl Plane {
    fn between(kind: PairKind, at: &[Vector3<f64>; 4], moves: &[Vector3<f64>; 4]) -> Self {
        let Closest { weights, offset } = closest(kind, at);
        let distance = offset.norm();
        let normal = if distance > 0.0 { offset / distance } else { Vector3::zeros() };
        let rate = normal.dot(&weighted(&weights, moves));
        let plane = Self::across(normal, kind, [at, moves], rate);
        let is_straight = |plane: &Self| plane.apart >= STRAIGHT_SHARE * distance;
        if is_straight(&plane) {
            return plane;
        }
        let [a, b] = match kind {
            PairKind::EdgeEdge => [at[1] - at[0], at[3] - at[2]],
            _ => [at[2] - at[1], at[3] - at[1]],
        };
        let flat = a.cross(&b).try_normalize(0.0).map(|it| it * it.dot(&offset).signum());
        let flat = flat.map(|flat| Self::across(flat, kind, [at, moves], rate));
        flat.filter(is_straight).unwrap_or(plane)
    }

    /// Returns the plane with a normal between primitives whose closest points part at a rate.
    fn across(
        normal: Vector3<f64>,
        kind: PairKind,
        [at, moves]: [&[Vector3<f64>; 4]; 2],
        rate: f64,
    ) -> Self {
        let along = |[a, b, c, d]: [f64; 4]| match kind {
            PairKind::EdgeEdge => [a - c, a - d, b - c, b - d],
            _ => [a - b, a - c, a - d, a - d],
        };
        let distances = along(at.map(|x| normal.dot(&x)));
        Self {
            distances,
            rates: along(moves.map(|u| normal.dot(&u))),
            apart: distances.into_iter().fold(f64::INFINITY, f64::min),
            rate,
        }
    }

    /// Returns the share of the step from now on during which the distance along the normal stays
    /// above `least` (m); infinite if it always does.
    fn holds_for(&self, least: f64) -> f64 {
        let mut share = f64::INFINITY;
        for (apart, rate) in self.distances.iter().zip(&self.rates) {
            if *rate < 0.0 {
                share = share.min((least - apart) / rate);
            }
        }
        share
    }
}
