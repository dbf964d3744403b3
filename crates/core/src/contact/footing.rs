//! Flat faces and seams of rigid shapes: several primitives repel a particle or a round body like
//! the one surface that they form.
//!
//! A point near a face is within reach of several triangles and edges of that face, and of faces
//! that adjoin it, also of other shapes. The tangent plane of a primitive is the plane through its
//! point that is closest to the touching point, perpendicular to the line between both. A primitive
//! of a rigid shape does not repel a point if the point touches another primitive at least as
//! deeply, and no corner of the first primitive rises above the tangent plane of the other one.
//! What repels the point then does not depend on triangles, seams and parts, and the force is
//! continuous from one primitive to the next. The first one in canonical order repels a point that
//! is as near to several.
//!
//! A vertex of cloth, of a box or of a mesh is repelled once by each flat face, whose inner edges
//! and points repel nothing, and by all edges between faces: the surfaces below support it at many
//! points.

use std::cmp::Ordering;

use nalgebra::Vector3;

use super::candidates::{Candidates, Linear};
use super::listing::Candidate;
use super::motion::{Hit, Motion};
use super::repulsion::Pair;
use super::skin::{KEPT_SHARE, Law};
use super::surface::Surface;
use crate::error::Vertex;
use crate::geometry::{Closest, PairKind, closest};

/// Largest distance of two places of contact that count as one point, over the thickness: two
/// primitives of one plane touch a corner or an edge from no farther apart than their ranges.
const NEIGHBOUR_SHARE: f64 = 2.0;

/// Largest speed of one thing relative to another, along the normal of contact with one of them,
/// over that at which the range of the other is entered: 0 for level things at rest, 1 for one that
/// falls beside the other.
const ACROSS_SHARE: f64 = 0.5;

/// Weight of each corner from which on a point is above the interior of a triangle, and nearer to
/// no other one of the same face: more than rounding.
const INNER_SHARE: f64 = 1e-6;

/// Place at which one side of a pair touches a primitive of a rigid shape.
struct Footing {
    /// First vertex of the side.
    point: u32,
    /// Closest point of the side that touches, without its radius (m).
    at: Vector3<f64>,
    /// Depth within the thickness (m).
    depth: f64,
    /// Closest point of the primitive's surface (m), and the unit vector from there to the point.
    foot: Vector3<f64>,
    normal: Vector3<f64>,
    /// Corners of the primitive (m), and the radius around them (m).
    corners: [Vector3<f64>; 3],
    radius: f64,
    /// Height above a plane (m) up to which a corner counts as in it.
    tolerance: f64,
}

impl Footing {
    /// Returns whether the primitive rises by at most a height (m) above the plane at another place
    /// of the same point.
    fn is_behind(&self, other: &Self, most: f64) -> bool {
        let height = |corner: &Vector3<f64>| (corner - other.foot).dot(&other.normal) + self.radius;
        self.corners.iter().all(|corner| height(corner) <= most)
    }
}

/// Visits the results of all pairs, in their order, except those with a primitive that others hide
/// from its point.
fn visit_bare<R>(found: Vec<(Option<Footing>, R)>, mut visit: impl FnMut(R)) {
    let mut order: Vec<_> = (0..found.len()).filter(|k| found[*k].0.is_some()).collect();
    let key = |k: usize| found[k].0.as_ref().map(|it| (it.point, it.depth));
    order.sort_by(|a, b| match (key(*a), key(*b)) {
        (Some((a, deep)), Some((b, deeper))) => a.cmp(&b).then(deeper.total_cmp(&deep)),
        _ => Ordering::Equal,
    });
    let mut hidden = vec![false; found.len()];
    let of_one_point = |a: &usize, b: &usize| key(*a).map(|it| it.0) == key(*b).map(|it| it.0);
    for group in order.chunk_by(of_one_point) {
        for (number, k) in group.iter().enumerate() {
            hidden[*k] = group[..number].iter().any(|other| {
                let both = found[*k].0.as_ref().zip(found[*other].0.as_ref());
                both.is_some_and(|(own, other)| own.is_behind(other, own.tolerance))
            });
        }
    }
    for ((_, result), hidden) in found.into_iter().zip(hidden) {
        if !hidden {
            visit(result);
        }
    }
}

impl Surface {
    /// Visits what `find` has found for the pairs that may be within their reach at an instant, by
    /// their velocities (m/s), in canonical order. Left out are pairs with a primitive of a rigid
    /// shape that others hide from the point that it touches. Several threads may call `find`.
    pub(super) fn each_bare<R: Send>(
        &self,
        candidates: &Candidates,
        still: &Linear,
        speeds: &[Vector3<f64>],
        find: impl Fn(&Candidate, &Pair) -> Option<R> + Sync,
        visit: impl FnMut(R),
    ) {
        let reach = |candidate: &Candidate| Some(self.reach(candidate.kind, &candidate.points));
        let pair = |candidate: &Candidate| Pair {
            kind: candidate.kind,
            law: self.law(candidate.kind, &candidate.points),
            x: candidate.of(still.x),
            v: candidate.of(speeds),
        };
        let find = |candidate: &Candidate, pair: &Pair| {
            let found = find(candidate, pair)?;
            (!self.leaves_to_neighbour(candidate, still.x)).then_some(found)
        };
        if self.has_points {
            let standing = |candidate: &Candidate| {
                let pair = pair(candidate);
                let result = find(candidate, &pair)?;
                Some((self.footing(candidate, &pair), result))
            };
            let mut found = vec![];
            candidates.each(0.0, still, reach, standing, |result| found.push(result));
            visit_bare(found, visit);
        } else {
            let find = |candidate: &Candidate| find(candidate, &pair(candidate));
            candidates.each(0.0, still, reach, find, visit);
        }
    }

    /// Returns whether a vertex is a particle without triangles and edges, or a point of a round
    /// shape.
    pub(crate) fn is_single(&self, vertex: u32) -> bool {
        let is_alone = || self.singles.get(vertex as usize).is_some_and(|is| *is);
        self.radius(vertex) > 0.0 || is_alone()
    }

    /// Returns whether a vertex is a point of an obstacle or of a rigid body.
    pub(super) fn is_hard(&self, vertex: u32) -> bool {
        vertex as usize >= self.particles() || self.solid(vertex).is_some()
    }

    /// Returns whether another triangle of the same flat face is nearer to the vertex of a pair, or
    /// as near and earlier: the one surface that they form repels the vertex once.
    fn leaves_to_neighbour(&self, candidate: &Candidate, x: &[Vector3<f64>]) -> bool {
        let [i, own @ ..] = candidate.points;
        if candidate.kind != PairKind::VertexTriangle || self.flat.beside.is_empty() {
            return false;
        }
        let Some(beside) = self.flat.beside.get(&own) else {
            return false;
        };
        let to = |[a, b, c]: [u32; 3]| {
            let points = [i, a, b, c].map(|i| x[i as usize]);
            closest(PairKind::VertexTriangle, &points)
        };
        let Closest { weights, offset } = to(own);
        let distance = offset.norm_squared();
        let is_nearer = |other: [u32; 3]| {
            let theirs = to(other).offset.norm_squared();
            theirs < distance || theirs == distance && other < own
        };
        let is_inside = weights[1..].iter().all(|weight| *weight < -INNER_SHARE);
        !is_inside && beside.iter().any(|other| is_nearer(*other))
    }

    /// Returns the place at which a pair touches, if it is a single point with a primitive of a
    /// rigid shape.
    fn footing(&self, candidate: &Candidate, pair: &Pair) -> Option<Footing> {
        let [i, a, b, c] = candidate.points;
        let is_edge = candidate.kind == PairKind::EdgeEdge;
        // The side of the point, and a vertex of the other side.
        let (side, other) = match candidate.kind {
            PairKind::EdgeEdge if i == a => (0, b),
            PairKind::EdgeEdge if b == c => (1, i),
            PairKind::EdgeEdge => return None,
            _ => (0, a),
        };
        let point = candidate.points[if is_edge { 2 * side } else { 0 }];
        if !self.is_single(point) || !self.is_hard(other) {
            return None;
        }
        self.footing_of(candidate, &pair.law, &pair.x, side)
    }

    /// Returns the place at which one side of a pair at x (m) touches the other.
    fn footing_of(
        &self,
        candidate: &Candidate,
        law: &Law,
        x: &[Vector3<f64>; 4],
        side: usize,
    ) -> Option<Footing> {
        let sides = candidate.kind.sides();
        let (own, other) = (sides[side].clone(), sides[1 - side].clone());
        let sign = if side == 0 { 1.0 } else { -1.0 };
        let Closest { weights, offset } = closest(candidate.kind, x);
        let (offset, distance) = (offset * sign, offset.norm());
        let normal = offset / distance;
        let at = own.clone().map(|k| x[k] * (weights[k] * sign)).sum();
        let reach = law.range();
        let radius = self.radius(candidate.points[other.start]);
        let foot = at - normal * (distance - radius);
        // The part of a floor that the side can touch.
        let around = |along: f64, across: f64| foot + Vector3::new(along, 0.0, across) * reach;
        let corners = if candidate.kind == PairKind::VertexFloor && side == 0 {
            [around(1.0, 0.0), around(-0.5, 0.8), around(-0.5, -0.8)]
        } else {
            [0, 1, 2].map(|k| x[(other.start + k).min(other.end - 1)])
        };
        (distance > 0.0).then_some(Footing {
            point: candidate.points[own.start],
            at,
            depth: reach - distance,
            foot,
            normal,
            corners,
            radius,
            tolerance: KEPT_SHARE * law.skin.thickness,
        })
    }

    /// Returns whether a side of a pair, which enters the range of its repulsion, only slides on:
    /// it touches something else at the same point, above which the other side does not rise, and
    /// to which this moves across. So a box slides over the seam of two boxes. Where it lands on
    /// both at once, neither has pushed it yet.
    pub(super) fn slides_on(
        &self,
        candidates: &Candidates,
        motion: &Motion,
        pair: &Candidate,
        hit: Hit,
    ) -> bool {
        let seen = |pair: &Candidate, side: usize| {
            let law = self.law(pair.kind, &pair.points);
            let x = motion.places(pair, &law, hit);
            let footing = law.is_dull.then(|| self.footing_of(pair, &law, &x, side));
            let sides = pair.kind.sides();
            let weights = closest(pair.kind, &x).weights;
            let speeds = [side, 1 - side].map(|side| {
                let sign = if side == 0 { 1.0 } else { -1.0 };
                let own = sides[side].clone();
                let parts = own.map(|k| motion.v[pair.points[k] as usize] * (weights[k] * sign));
                parts.sum::<Vector3<f64>>()
            });
            Some(TouchingSide {
                footing: footing??,
                speeds,
                party: self.vertex(pair.points[sides[side].start]),
                thickness: law.skin.thickness,
            })
        };
        (0..2).filter_map(|side| seen(pair, side)).any(|entering| {
            let others = candidates.near(0.0).filter(|other| *other != pair);
            let mut others = others.flat_map(|other| [0, 1].map(|side| seen(other, side)));
            others.any(|other| other.is_some_and(|known| entering.slides_on(&known)))
        })
    }
}

/// Side of a pair, where it touches.
struct TouchingSide {
    footing: Footing,
    /// Velocities (m/s) of its closest point and of that of the other side.
    speeds: [Vector3<f64>; 2],
    party: Vertex,
    thickness: f64,
}

impl TouchingSide {
    /// Returns whether the side enters another range as it slides on the other side of a known
    /// contact.
    fn slides_on(&self, known: &Self) -> bool {
        let (entering, footing) = (&self.footing, &known.footing);
        let gap = known.thickness - footing.depth;
        let across = (known.speeds[1] - self.speeds[1]).dot(&footing.normal);
        let approach = (self.speeds[0] - self.speeds[1]).dot(&entering.normal);
        known.party == self.party
            && footing.depth > footing.tolerance
            && (footing.at - entering.at).norm() <= NEIGHBOUR_SHARE * known.thickness
            && entering.is_behind(footing, gap)
            && across.abs() <= ACROSS_SHARE * approach.abs()
    }
}
