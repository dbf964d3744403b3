//! Which piece of a surface is on the wrong side, for each curve along which surfaces cross and
//! cut it.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use nalgebra::Vector3;

use super::points::EdgeHit;
use super::skeleton::Skeleton;
use crate::sets::Sets;

/// Number of classes of agreement: within one, the smaller piece moves.
const CLASSES: f64 = 4.0;

/// What is on the wrong side.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Wrong {
    /// A piece that is cut off, by its smallest vertex.
    Piece(u32),
    /// The part of a surface between a curve and a border, by the smallest vertex of the surface.
    Rim(u32),
}

/// Displacement by which an edge would bring what is on the wrong side through a triangle.
#[derive(Clone, Copy)]
struct Vote {
    wrong: Wrong,
    by: Vector3<f64>,
}

/// Votes for the same.
#[derive(Clone, Copy, Default)]
struct VoteSum {
    /// Sum of the displacements, and of their lengths (m).
    by: Vector3<f64>,
    lengths: f64,
    count: f64,
    /// Size of what is on the wrong side (m).
    size: f64,
}

/// The votes of all crossings, and what they have decided.
pub(super) struct Votes {
    /// The vote of each crossing.
    each: Vec<Option<Vote>>,
    /// The curve of each crossing, by its first crossing.
    curves: Vec<u32>,
    sums: BTreeMap<(u32, Wrong), VoteSum>,
    /// What is on the wrong side of each curve.
    decided: BTreeMap<u32, Wrong>,
    /// Mean displacement of each piece that moves (m).
    of_pieces: BTreeMap<u32, Vector3<f64>>,
}

impl Votes {
    pub fn count(skeleton: &Skeleton, pieces: &Pieces, hits: &[EdgeHit]) -> Self {
        let curves = curves(skeleton, hits);
        let rims = rims(skeleton, pieces, hits, &curves);
        let mut sums = BTreeMap::<_, VoteSum>::new();
        let vote = |(hit, curve): (&EdgeHit, &u32)| -> Option<(Vote, f64)> {
            let [a, b] = skeleton.edges[hit.edge].map(|i| pieces.of[i as usize]);
            if a != b {
                let [first, second] = [a, b].map(|piece| pieces.sizes[piece as usize]);
                let (end, piece, size) =
                    if first < second { (0, a, first) } else { (1, b, second) };
                let by = hit.passage(end);
                return Some((Vote { wrong: Wrong::Piece(piece), by }, size));
            }
            let [upper, lower] = *rims.get(&rim(skeleton, hit, *curve))?;
            let end = if upper < lower { hit.upper_end() } else { 1 - hit.upper_end() };
            let wrong = Wrong::Rim(skeleton.parts[skeleton.edges[hit.edge][0] as usize]);
            let is_open = upper.min(lower).is_finite();
            is_open.then(|| (Vote { wrong, by: hit.passage(end) }, upper.min(lower)))
        };
        let votes: Vec<_> = hits.iter().zip(&curves).map(vote).collect();
        for (vote, curve) in votes.iter().zip(&curves) {
            if let Some((Vote { wrong, by }, size)) = vote {
                let sum = sums.entry((*curve, *wrong)).or_default();
                sum.by += by;
                sum.lengths += by.norm();
                sum.count += 1.0;
                sum.size = sum.size.max(*size);
            }
        }
        let decided = decided(&sums);
        let mut of_pieces = BTreeMap::<_, VoteSum>::new();
        for ((curve, wrong), sum) in &sums {
            if let (Wrong::Piece(piece), true) = (wrong, decided.get(curve) == Some(wrong)) {
                let all = of_pieces.entry(*piece).or_default();
                all.by += sum.by;
                all.count += sum.count;
            }
        }
        Self {
            each: votes.into_iter().map(|vote| Some(vote?.0)).collect(),
            curves,
            sums,
            decided,
            of_pieces: of_pieces.into_iter().map(|(k, all)| (k, all.by / all.count)).collect(),
        }
    }

    /// Returns whether nothing is on the wrong side of the curve of crossing k.
    pub fn is_undecided(&self, k: usize) -> bool {
        !self.decided.contains_key(&self.curves[k])
    }

    /// Returns the displacement (m) of the edge of crossing k, half of it by its own vote and half
    /// by the mean of the curve; `None` if another side moves.
    pub fn step(&self, k: usize) -> Option<Vector3<f64>> {
        let (vote, curve) = (self.each[k]?, self.curves[k]);
        let sum = self.sums.get(&(curve, vote.wrong))?;
        let moves = self.decided.get(&curve) == Some(&vote.wrong);
        moves.then(|| 0.5 * (vote.by + sum.by / sum.count))
    }

    /// Returns the displacement (m) of a whole piece, if it moves.
    pub fn of_piece(&self, piece: u32) -> Option<Vector3<f64>> {
        self.of_pieces.get(&piece).copied()
    }
}

/// Decides what is on the wrong side of each curve: that which can leave in the straightest way, or
/// else the smallest.
fn decided(sums: &BTreeMap<(u32, Wrong), VoteSum>) -> BTreeMap<u32, Wrong> {
    let mut decided = BTreeMap::<u32, (Wrong, f64, f64)>::new();
    for ((curve, wrong), sum) in sums {
        let agreement = (CLASSES * sum.by.norm() / sum.lengths).round();
        let best = decided.entry(*curve).or_insert((*wrong, agreement, sum.size));
        if agreement > best.1 || agreement == best.1 && sum.size < best.2 {
            *best = (*wrong, agreement, sum.size);
        }
    }
    let best = decided.into_iter();
    best.map(|(curve, (wrong, ..))| (curve, wrong)).collect()
}

/// Returns the curve of each crossing, by its first crossing. A curve runs from a crossing of an
/// edge through a triangle at that edge to the next crossing of the same two triangles.
fn curves(skeleton: &Skeleton, hits: &[EdgeHit]) -> Vec<u32> {
    let mut sets = Sets::new(hits.len());
    let mut firsts = BTreeMap::new();
    for (k, hit) in hits.iter().enumerate() {
        let other = hit.triangle as u32;
        for own in skeleton.triangles_at(hit.edge) {
            let pair = [*own.min(&other), *own.max(&other)];
            sets.join(*firsts.entry(pair).or_insert(k as u32), k as u32);
        }
    }
    (0..hits.len() as u32).map(|k| sets.find(k)).collect()
}

/// Key of the two rims at a curve: the curve, and the parts of the edge and of the triangle.
type RimKey = (u32, u32, u32);

fn rim(skeleton: &Skeleton, hit: &EdgeHit, curve: u32) -> RimKey {
    let part = |i: u32| skeleton.parts[i as usize];
    let (edge, triangle) = (skeleton.edges[hit.edge], skeleton.triangles[hit.triangle]);
    (curve, part(edge[0]), part(triangle[0]))
}

/// Returns the mean distances (m) of edges from the border on the upper and on the lower side of
/// the triangles that they cross.
fn rims(
    skeleton: &Skeleton,
    pieces: &Pieces,
    hits: &[EdgeHit],
    curves: &[u32],
) -> BTreeMap<RimKey, [f64; 2]> {
    let mut sums = BTreeMap::<_, ([f64; 2], f64)>::new();
    for (hit, curve) in hits.iter().zip(curves) {
        let depth = |end: usize| pieces.depths[skeleton.edges[hit.edge][end] as usize];
        let upper = hit.upper_end();
        let (depths, count) = sums.entry(rim(skeleton, hit, *curve)).or_default();
        depths[0] += depth(upper);
        depths[1] += depth(1 - upper);
        *count += 1.0;
    }
    let mean = |([upper, lower], count): ([f64; 2], f64)| [upper / count, lower / count];
    sums.into_iter().map(|(key, sum)| (key, mean(sum))).collect()
}

/// The pieces into which crossings cut surfaces.
pub(super) struct Pieces {
    /// The piece of each vertex, by its smallest vertex.
    pub of: Vec<u32>,
    /// Lengths of all edges of each piece (m), of cut ones in part.
    pub sizes: Vec<f64>,
    /// Distance of each vertex from the border, along edges that are not cut (m); infinite if there
    /// is none.
    pub depths: Vec<f64>,
}

impl Pieces {
    /// Cuts surfaces with vertices at these places (m).
    pub fn cut(skeleton: &Skeleton, hits: &[EdgeHit], at: &[Vector3<f64>]) -> Self {
        let mut cuts = BTreeMap::new();
        for hit in hits {
            let [first, last] = cuts.entry(hit.edge).or_insert([1.0_f64, 0.0_f64]);
            (*first, *last) = (first.min(hit.share), last.max(hit.share));
        }
        let mut sets = Sets::new(at.len());
        for (k, [a, b]) in skeleton.edges.iter().enumerate() {
            if !cuts.contains_key(&k) {
                sets.join(*a, *b);
            }
        }
        let of: Vec<_> = (0..at.len() as u32).map(|i| sets.find(i)).collect();
        let mut sizes = vec![0.0; at.len()];
        for (k, ends) in skeleton.edges.iter().enumerate() {
            let [a, b] = ends.map(|i| i as usize);
            let length = (at[a] - at[b]).norm();
            let [first, last] = cuts.get(&k).copied().unwrap_or([0.5; 2]);
            sizes[of[a] as usize] += length * first;
            sizes[of[b] as usize] += length * (1.0 - last);
        }
        let is_cut = |edge: u32| cuts.contains_key(&(edge as usize));
        Self { of, sizes, depths: depths(skeleton, is_cut, at) }
    }
}

/// Computes distances (m) from the border along edges that are not cut (Dijkstra).
fn depths(skeleton: &Skeleton, is_cut: impl Fn(u32) -> bool, at: &[Vector3<f64>]) -> Vec<f64> {
    let mut depths = vec![f64::INFINITY; at.len()];
    // Numbers that are not negative have the order of their bits.
    let mut queue = BinaryHeap::new();
    for i in &skeleton.border {
        depths[*i as usize] = 0.0;
        queue.push((Reverse(0), *i));
    }
    while let Some((Reverse(bits), i)) = queue.pop() {
        let depth = f64::from_bits(bits);
        if depth > depths[i as usize] {
            continue;
        }
        for (j, edge) in &skeleton.neighbours[i as usize] {
            let there = depth + (at[i as usize] - at[*j as usize]).norm();
            if there < depths[*j as usize] && !is_cut(*edge) {
                depths[*j as usize] = there;
                queue.push((Reverse(there.to_bits()), *j));
            }
        }
    }
    depths
}
