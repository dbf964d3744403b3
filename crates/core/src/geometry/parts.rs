//! Connected parts of closed surfaces. If several share an edge or a point, each gets its own copy.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::error::Error;
use crate::sets::Sets;

/// Angle (rad) between two triangles at an edge up to which they count as lying on one another.
const ANGLE_TOLERANCE: f64 = 1e-9;

/// Passage of a triangle along an edge: its corners at the lower and at the upper end of the edge,
/// and whether it passes upwards.
#[derive(Clone, Copy)]
struct EdgePassage {
    corners: [u32; 2],
    is_up: bool,
}

/// Closed surface in which each edge has two triangles, and each point one ring of them.
pub(super) struct Parts {
    pub points: Vec<Vector3<f64>>,
    pub triangles: Vec<[u32; 3]>,
    /// Part of each triangle, counted from 0.
    pub part_of: Vec<u32>,
    /// Number of parts.
    pub count: usize,
}

/// Splits the surface with these points and triangles into its parts.
///
/// # Errors
/// The numbers of triangles that pass an edge upwards and downwards differ.
pub(super) fn split(points: Vec<Vector3<f64>>, triangles: &[[u32; 3]]) -> Result<Parts, Error> {
    // Sets of corners around a point that are connected by edges, and sets of connected triangles.
    let mut rings = Sets::new(3 * triangles.len());
    let mut parts = Sets::new(triangles.len());
    for same in sides(triangles).chunk_by(|(a, _), (b, _)| a == b) {
        let [a, b] = same[0].0;
        let mut sides: Vec<_> = same.iter().map(|(_, side)| *side).collect();
        let up = sides.iter().filter(|side| side.is_up).count();
        if 2 * up != sides.len() {
            return Err(open(&points, [a, b], sides.len()));
        }
        if sides.len() > 2 {
            sort(&mut sides, [a, b].map(|i| points[i as usize]), |side| {
                let of = side.corners[0] / 3;
                let third = triangles[of as usize].iter().find(|i| **i != a && **i != b);
                third.map_or(Vector3::zeros(), |i| points[*i as usize])
            });
        }
        for [one, other] in pairs(&sides) {
            parts.join(one.corners[0] / 3, other.corners[0] / 3);
            for end in 0..2 {
                rings.join(one.corners[end], other.corners[end]);
            }
        }
    }
    let (mut points, mut triangles) = (points, triangles.to_vec());
    let mut ring_of = vec![u32::MAX; points.len()];
    let mut new = BTreeMap::new();
    for corner in 0..3 * triangles.len() as u32 {
        let ring = rings.find(corner);
        let at = &mut triangles[corner as usize / 3][corner as usize % 3];
        let first = &mut ring_of[*at as usize];
        if *first == u32::MAX {
            *first = ring;
        } else if *first != ring {
            let point = points[*at as usize];
            *at = *new.entry(ring).or_insert_with(|| {
                points.push(point);
                points.len() as u32 - 1
            });
        }
    }
    let mut numbers = BTreeMap::new();
    let part_of = (0..triangles.len() as u32).map(|k| {
        let next = numbers.len() as u32;
        *numbers.entry(parts.find(k)).or_insert(next)
    });
    let part_of = part_of.collect();
    Ok(Parts { count: numbers.len(), part_of, points, triangles })
}

/// Lists the passages of triangles along edges, sorted by edge.
fn sides(triangles: &[[u32; 3]]) -> Vec<([u32; 2], EdgePassage)> {
    let mut sides = Vec::with_capacity(3 * triangles.len());
    for (k, t) in triangles.iter().enumerate() {
        for from in 0..3 {
            let to = (from + 1) % 3;
            let is_up = t[from] < t[to];
            let mut corners = [from, to].map(|corner| (3 * k + corner) as u32);
            if !is_up {
                corners.reverse();
            }
            let edge = [t[from].min(t[to]), t[from].max(t[to])];
            sides.push((edge, EdgePassage { corners, is_up }));
        }
    }
    sides.sort_unstable_by_key(|(edge, side)| (*edge, side.corners));
    sides
}

/// Sorts the triangles at an edge by their angle around it, seen against its direction; `third` is
/// each one's corner off the edge. Of triangles at the same angle, those whose solid is behind them
/// come first.
fn sort(
    sides: &mut Vec<EdgePassage>,
    [a, b]: [Vector3<f64>; 2],
    third: impl Fn(&EdgePassage) -> Vector3<f64>,
) {
    let along = (b - a).try_normalize(0.0).unwrap_or_default();
    let from_edge = |side: &EdgePassage| {
        let d = third(side) - a;
        d - along * along.dot(&d)
    };
    let zero = from_edge(&sides[0]);
    let ahead = along.cross(&zero);
    let turn = std::f64::consts::TAU;
    let angle = |side: &EdgePassage| {
        let d = from_edge(side);
        let angle = libm::atan2(ahead.dot(&d), along.norm() * zero.dot(&d));
        let angle = if angle < -ANGLE_TOLERANCE { angle + turn } else { angle };
        if angle > turn - ANGLE_TOLERANCE { 0.0 } else { angle }
    };
    let mut sorted: Vec<_> = sides.iter().map(|side| (angle(side), *side)).collect();
    sorted.sort_by(|(a, _), (b, _)| a.total_cmp(b));
    for same in sorted.chunk_by_mut(|(a, _), (b, _)| b - a < ANGLE_TOLERANCE) {
        same.sort_by_key(|(_, side)| !side.is_up);
    }
    *sides = sorted.into_iter().map(|(_, side)| side).collect();
}

/// Pairs the triangles at an edge that bound the same solid. The solid begins behind a triangle
/// that passes the edge downwards and ends at one that passes it upwards.
fn pairs(sides: &[EdgePassage]) -> Vec<[EdgePassage; 2]> {
    let (mut begun, mut pairs) = (vec![], vec![]);
    let mut is_paired = vec![false; sides.len()];
    // Twice around, as a solid may extend across the first angle.
    for k in (0..sides.len()).chain(0..sides.len()) {
        if is_paired[k] || begun.contains(&k) {
            continue;
        }
        if !sides[k].is_up {
            begun.push(k);
        } else if let Some(first) = begun.pop() {
            (is_paired[first], is_paired[k]) = (true, true);
            pairs.push([sides[first], sides[k]]);
        }
    }
    pairs
}

/// Returns the error for an edge with different numbers of triangles in its two directions.
fn open(points: &[Vector3<f64>], [a, b]: [u32; 2], count: usize) -> Error {
    let place = |i: u32| {
        let [x, y, z]: [f64; 3] = points[i as usize].into();
        format!("point {i} at ({x}, {y}, {z})")
    };
    let why = match count {
        2 => "whose normals point to different sides".into(),
        count => format!("not {count}"),
    };
    Error::Invalid(format!(
        "a closed mesh has two triangles at each edge, but at that from {} to {} {why}",
        place(a),
        place(b),
    ))
}
