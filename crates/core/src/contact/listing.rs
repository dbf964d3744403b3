//! Construction of the list of pairs that may touch: trees of boxes find items that come near each
//! other, and planes between their primitives bound their distance.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::bounds::{Block, LANES};
use super::boxes::{Courses, Tree};
use super::items::Items;
use super::surface::Surface;
use crate::geometry::{PairKind, closest};

/// Share of the largest thickness that is subtracted from gaps to allow for rounding.
const ROUNDING: f64 = 1e-9;

/// Number of overlapping boxes, or of pairs, in a task of a thread.
pub(super) const CHUNK: usize = 1024;

/// Pair that may touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    pub points: [u32; 4],
    pub kind: PairKind,
}

impl Candidate {
    /// The positions, or other vectors, of its points.
    pub fn of<T: Copy>(&self, all: &[T]) -> [T; 4] {
        self.points.map(|i| all[i as usize])
    }

    /// Largest approach of its primitives if each vertex moves by `travel`.
    pub fn approach(&self, travel: &[f64]) -> f64 {
        let [a, b, c, d] = self.of(travel);
        match self.kind {
            PairKind::VertexTriangle => a + b.max(c).max(d),
            PairKind::EdgeEdge => a.max(b) + c.max(d),
            PairKind::VertexFloor => a + b,
        }
    }
}

/// Pair of a list, with a lower bound of its gap while all vertices follow the courses of the list.
#[derive(Clone, Copy, Debug)]
pub(super) struct Listed {
    /// Key of the canonical order.
    key: u64,
    pub candidate: Candidate,
    /// Gap at the beginning (m): distance less radii and thickness.
    gap: f64,
    /// Upper bound of the speed at which the gap shrinks (m/s); negative if it grows.
    closing: f64,
}

impl Listed {
    /// Lower bound of the gap between two times after the beginning (s), in m.
    pub fn gap(&self, [first, last]: [f64; 2]) -> f64 {
        self.gap - (self.closing * first).max(self.closing * last)
    }
}

/// Trees and scratch to make lists.
#[derive(Debug, Default)]
pub(super) struct Listing {
    bodies: Tree,
    obstacles: Tree,
    overlaps: Vec<[u32; 2]>,
}

impl Listing {
    /// Lists the pairs that come within reach of each other on their courses, in canonical order:
    /// all, or only those with a vertex that has a new course.
    pub fn list(
        &mut self,
        surface: &Surface,
        course: &Courses,
        renewed: Option<&[bool]>,
        parallel: bool,
        pairs: &mut Vec<Listed>,
    ) {
        let (bodies, obstacles) = (&surface.bodies, &surface.obstacles);
        let query = Query {
            surface,
            course,
            renewed,
        };
        let is_new = |points: &[u32]| query.is_new(points);
        pairs.retain(|pair| !is_new(&pair.candidate.points));
        let kept = pairs.len();
        self.bodies.take(bodies, surface, course, &is_new);
        self.obstacles.take(obstacles, surface, course, &is_new);
        let overlaps = &mut self.overlaps;
        if surface.touches_itself {
            overlaps.clear();
            if renewed.is_none() {
                self.bodies.bvh.pairs(|s, t| {
                    overlaps.push([s, t]);
                    true
                });
            } else {
                self.bodies.meet(&self.bodies, bodies, &is_new, |s, t| {
                    if s < t || s > t && !is_new(&bodies.corners[t as usize]) {
                        overlaps.push([s, t]);
                    }
                });
            }
            query.list([(bodies, &self.bodies); 2], overlaps, parallel, pairs);
        }
        if !obstacles.corners.is_empty() && !bodies.corners.is_empty() {
            overlaps.clear();
            let mut add = |s, t| overlaps.push([s, t]);
            if renewed.is_none() {
                self.bodies.bvh.pairs_with(&self.obstacles.bvh, add);
            } else {
                self.bodies.meet(&self.obstacles, bodies, &is_new, &mut add);
                self.obstacles
                    .meet(&self.bodies, obstacles, &is_new, |t, s| {
                        if !is_new(&bodies.corners[s as usize]) {
                            add(s, t);
                        }
                    });
            }
            let both = [(bodies, &self.bodies), (obstacles, &self.obstacles)];
            query.list(both, overlaps, parallel, pairs);
        }
        for &floor in &surface.floors {
            for &i in &bodies.vertices {
                let points = [i, floor, floor, floor];
                if is_new(&points) {
                    pairs.extend(query.pair(PairKind::VertexFloor, [i, floor], points));
                }
            }
        }
        if renewed.is_some() {
            pairs[kept..].sort_unstable_by_key(|pair| pair.key);
            // The list consists of two sorted runs, which are merged.
            pairs.sort_by_key(|pair| pair.key);
        } else if parallel {
            pairs.par_sort_unstable_by_key(|pair| pair.key);
        } else {
            pairs.sort_unstable_by_key(|pair| pair.key);
        }
    }
}

/// Ranks of two primitives, and their points.
type Primitives = ([u32; 2], [u32; 4]);

/// Pairs of primitives whose boxes come within reach.
#[derive(Default)]
struct Near {
    vertex_triangle: Vec<Primitives>,
    edge_edge: Vec<Primitives>,
}

/// Items with their tree.
type Side<'a> = (&'a Items, &'a Tree);

/// Surface and courses that a list is made for.
struct Query<'a> {
    surface: &'a Surface,
    course: &'a Courses<'a>,
    /// Whether each vertex has a new course, if only such vertices' pairs are listed.
    renewed: Option<&'a [bool]>,
}

impl Query<'_> {
    /// Whether one of these vertices has a new course.
    fn is_new(&self, points: &[u32]) -> bool {
        self.renewed
            .is_none_or(|renewed| points.iter().any(|i| renewed[*i as usize]))
    }

    /// Adds the pairs of items whose boxes overlap.
    fn list(
        &self,
        sides: [Side; 2],
        overlaps: &[[u32; 2]],
        parallel: bool,
        pairs: &mut Vec<Listed>,
    ) {
        if parallel {
            pairs.par_extend(overlaps.par_chunks(CHUNK).flat_map_iter(|overlaps| {
                let mut found = vec![];
                self.list_some(sides, overlaps, &mut Near::default(), &mut found);
                found
            }));
        } else {
            let mut near = Near::default();
            for overlaps in overlaps.chunks(CHUNK) {
                self.list_some(sides, overlaps, &mut near, pairs);
            }
        }
    }

    /// Adds the pairs of some items whose boxes overlap. `near` is scratch.
    fn list_some(
        &self,
        sides: [Side; 2],
        overlaps: &[[u32; 2]],
        near: &mut Near,
        pairs: &mut Vec<Listed>,
    ) {
        for items in overlaps {
            self.find(sides, items.map(|k| k as usize), near);
        }
        self.bound(PairKind::VertexTriangle, &mut near.vertex_triangle, pairs);
        self.bound(PairKind::EdgeEdge, &mut near.edge_edge, pairs);
    }

    /// Adds those of these pairs of one kind that come within reach, and clears them.
    fn bound(&self, kind: PairKind, near: &mut Vec<Primitives>, pairs: &mut Vec<Listed>) {
        let mut block = Block::new();
        for near in near.chunks(LANES) {
            for (lane, (_, points)) in near.iter().enumerate() {
                block.set(lane, *points, self.course.base, self.course.speeds);
            }
            block.bound(kind);
            let bounds = block.distance.iter().zip(&block.closing);
            for (&(ranks, points), (distance, closing)) in near.iter().zip(bounds) {
                if distance.is_finite() {
                    pairs.extend(self.listed(kind, ranks, points, [*distance, *closing]));
                } else {
                    pairs.extend(self.pair(kind, ranks, points));
                }
            }
        }
        near.clear();
    }

    /// Finds the pairs of primitives of two items whose boxes come within reach.
    fn find(&self, sides: [Side; 2], [s, t]: [usize; 2], near: &mut Near) {
        let reach = self.course.reach + self.surface.thickest();
        let squared = reach * reach;
        let [(first, first_tree), (second, second_tree)] = sides;
        let [a, b] = [first.corners[s][0], second.corners[t][0]];
        if first_tree.items[s].apart(&second_tree.items[t]) >= squared
            || self.surface.is_one_solid(a, b)
        {
            return;
        }
        for ([(a, at), (b, bt)], [k, l]) in [(sides, [s, t]), ([sides[1], sides[0]], [t, s])] {
            if !b.is_triangle(l) {
                continue;
            }
            let corners = b.corners[l];
            for i in a.vertices_of(k) {
                let v = a.vertices[i];
                if !corners.contains(&v) && at.vertices[i].apart(&bt.items[l]) < squared {
                    let [p, q, r] = corners;
                    let ranks = [v, b.ranks[l]];
                    let points = [v, p, q, r];
                    if self.is_new(&points) {
                        near.vertex_triangle.push((ranks, points));
                    }
                }
            }
        }
        for i in first.edges_of(s) {
            let (e, around) = (first.edges[i], &first_tree.edges[i]);
            if around.apart(&second_tree.items[t]) >= squared {
                continue;
            }
            for j in second.edges_of(t) {
                let f = second.edges[j];
                // A point and an edge of a triangle: the point and its corners are a pair already.
                let point =
                    e[0] == e[1] && second.is_triangle(t) || f[0] == f[1] && first.is_triangle(s);
                if point
                    || e.iter().any(|i| f.contains(i))
                    || around.apart(&second_tree.edges[j]) >= squared
                {
                    continue;
                }
                let [mut e, mut f] = [(first.edge_ranks[i], e), (second.edge_ranks[j], f)];
                if f.0 < e.0 {
                    std::mem::swap(&mut e, &mut f);
                }
                let ((m, [a, b]), (n, [c, d])) = (e, f);
                let points = [a, b, c, d];
                if self.is_new(&points) {
                    near.edge_edge.push(([m, n], points));
                }
            }
        }
    }

    /// The pair of these primitives, by their ranks and points, if it comes within reach.
    fn pair(&self, kind: PairKind, ranks: [u32; 2], points: [u32; 4]) -> Option<Listed> {
        let course = self.course;
        let origin = course.base[points[0] as usize];
        let x = points.map(|i| course.base[i as usize] - origin);
        let normal = match kind {
            PairKind::VertexFloor => Vector3::y(),
            _ => closest(kind, &x)
                .offset
                .try_normalize(0.0)
                .unwrap_or_default(),
        };
        // The plane between the primitives bounds their distance, now and later.
        let apart = |v: [Vector3<f64>; 4]| {
            let [a, b, c, d] = v.map(|v| v.dot(&normal));
            match kind {
                PairKind::VertexTriangle => a - b.max(c).max(d),
                PairKind::EdgeEdge => a.min(b) - c.max(d),
                PairKind::VertexFloor => a - b,
            }
        };
        let distance = if normal == Vector3::zeros() {
            f64::NEG_INFINITY
        } else {
            apart(x)
        };
        let closing = -apart(points.map(|i| course.speeds[i as usize]));
        self.listed(kind, ranks, points, [distance, closing])
    }

    /// The pair of these primitives, whose distance (m) and the speed at which it shrinks (m/s) are
    /// bounded, if it comes within reach.
    fn listed(
        &self,
        kind: PairKind,
        ranks: [u32; 2],
        points: [u32; 4],
        [distance, closing]: [f64; 2],
    ) -> Option<Listed> {
        let course = self.course;
        let thickness = self.surface.thickness(kind, &points);
        let rounding = ROUNDING * self.surface.thickest();
        let gap = distance - self.surface.radii(kind, &points) - thickness - rounding;
        let listed = gap - closing.max(0.0) * course.horizon < course.reach;
        listed.then(|| Listed {
            key: (kind as u64) << 62 | u64::from(ranks[0]) << 31 | u64::from(ranks[1]),
            candidate: Candidate { points, kind },
            gap,
            closing,
        })
    }
}
