//! Construction of the list of pairs that may touch: trees of boxes find items that come near each
//! other, and planes between their primitives bound their distance.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::bounds::{Block, LANES};
use super::boxes::{Bounds, Courses, Meeting, Tree};
use super::surface::{Items, Surface};
use crate::geometry::{PairKind, closest};

/// Number of pairs of blocks, or of listed pairs, in a task of a thread.
pub(super) const CHUNK: usize = 512;

/// Pair that may touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    pub points: [u32; 4],
    pub kind: PairKind,
}

impl Candidate {
    /// Selects the positions, or other vectors, of the pair's points.
    pub fn of<T: Copy>(&self, all: &[T]) -> [T; 4] {
        self.points.map(|i| all[i as usize])
    }

    /// Returns the largest approach of the pair's primitives if each vertex moves by `travel`.
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
    /// Returns a lower bound of the gap (m) between two times after the beginning (s).
    pub fn gap(&self, [first, last]: [f64; 2]) -> f64 {
        self.gap - (self.closing * first).max(self.closing * last)
    }
}

/// Trees of the boxes of vertices, triangles and edges.
#[derive(Debug, Default)]
struct Trees {
    vertices: Tree,
    triangles: Tree,
    edges: Tree,
}

impl Trees {
    /// Updates the boxes with new courses: `around` has those of all vertices.
    fn take(
        &mut self,
        items: &Items,
        around: &[Bounds],
        reach: f64,
        is_new: &impl Fn(&[u32]) -> bool,
    ) {
        let vertices = items.vertices.iter().map(|i| [*i]);
        self.vertices.take(vertices, around, reach, is_new);
        let triangles = items.triangles().iter().copied();
        self.triangles.take(triangles, around, reach, is_new);
        let edges = items.edges.iter().copied();
        self.edges.take(edges, around, reach, is_new);
    }
}

/// Trees and scratch to make lists.
#[derive(Debug, Default)]
pub(super) struct Listing {
    bodies: Trees,
    obstacles: Trees,
    drops: Trees,
    around: Vec<Bounds>,
    blocks: Vec<[u32; 2]>,
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
        let drops = &surface.drops;
        let query = Query { surface, course, renewed, parallel };
        let is_new = |points: &[u32]| query.is_new(points);
        pairs.retain(|pair| !is_new(&pair.candidate.points));
        let kept = pairs.len();
        let reach = course.reach + surface.thickest();
        let vertices = 0..course.base.len();
        if let Some(renewed) = renewed {
            for i in vertices.filter(|i| renewed[*i]) {
                self.around[i] = course.around(surface, i);
            }
        } else {
            self.around.clear();
            let around = vertices.map(|i| course.around(surface, i));
            self.around.extend(around);
        }
        self.bodies.take(bodies, &self.around, reach, &is_new);
        self.obstacles.take(obstacles, &self.around, reach, &is_new);
        self.drops.take(drops, &self.around, reach, &is_new);
        let own = (bodies, &self.bodies);
        let others = (obstacles, &self.obstacles);
        let wet = (drops, &self.drops);
        let blocks = &mut self.blocks;
        if surface.touches_itself {
            query.touching([own; 2], blocks, pairs);
            query.crossing([own; 2], blocks, pairs);
        }
        if !obstacles.vertices.is_empty() && !bodies.vertices.is_empty() {
            query.touching([own, others], blocks, pairs);
            query.touching([others, own], blocks, pairs);
            query.crossing([own, others], blocks, pairs);
        }
        for (side, touch) in [(own, surface.touches_itself), (others, true)] {
            if touch && !drops.vertices.is_empty() && !side.0.vertices.is_empty() {
                query.touching([wet, side], blocks, pairs);
                query.crossing([wet, side], blocks, pairs);
            }
        }
        for &floor in &surface.floors {
            for &i in bodies.vertices.iter().chain(&drops.vertices) {
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

/// Items with their trees.
type ItemSide<'a> = (&'a Items, &'a Trees);

/// Surface and courses that a list is made for.
struct Query<'a> {
    surface: &'a Surface,
    course: &'a Courses<'a>,
    /// Whether each vertex has a new course, if only such vertices' pairs are listed.
    renewed: Option<&'a [bool]>,
    parallel: bool,
}

impl Query<'_> {
    /// Returns whether one of these vertices has a new course.
    fn is_new(&self, points: &[u32]) -> bool {
        self.renewed.is_none_or(|renewed| points.iter().any(|i| renewed[*i as usize]))
    }

    /// Adds the pairs of vertices of the first side and triangles of the second.
    #[expect(clippy::needless_bitwise_bool, reason = "a branch would be guessed wrong")]
    fn touching(
        &self,
        [(first, first_trees), (second, second_trees)]: [ItemSide; 2],
        blocks: &mut Vec<[u32; 2]>,
        pairs: &mut Vec<Listed>,
    ) {
        let trees = [&first_trees.vertices, &second_trees.triangles];
        let primitives = |[k, l]: [u32; 2]| {
            let (v, [a, b, c]) = (first.vertices[k as usize], second.triangles()[l as usize]);
            let is_corner = (v == a) | (v == b) | (v == c);
            let may_touch = !(is_corner | self.surface.are_one(&[v], &[a, b, c]));
            (may_touch, ([v, second.ranks[l as usize]], [v, a, b, c]))
        };
        self.search(PairKind::VertexTriangle, trees, primitives, blocks, pairs);
    }

    /// Adds the pairs of edges of both sides, which may be the same.
    #[expect(clippy::needless_bitwise_bool, reason = "a branch would be guessed wrong")]
    fn crossing(
        &self,
        [(first, first_trees), (second, second_trees)]: [ItemSide; 2],
        blocks: &mut Vec<[u32; 2]>,
        pairs: &mut Vec<Listed>,
    ) {
        let trees = [&first_trees.edges, &second_trees.edges];
        let primitives = |[k, l]: [u32; 2]| {
            let (k, l) = (k as usize, l as usize);
            let (e, f) = (first.edges[k], second.edges[l]);
            let meet = (e[0] == f[0]) | (e[0] == f[1]) | (e[1] == f[0]) | (e[1] == f[1]);
            // A point and an edge of a triangle: the point and its corners are a pair already.
            let is_point = (e[0] == e[1]) & second.is_side(l) | (f[0] == f[1]) & first.is_side(k);
            let may_touch = !(meet | is_point | self.surface.are_one(&e, &f));
            let all = [(first.edge_ranks[k], e), (second.edge_ranks[l], f)];
            let swapped = usize::from(all[1].0 < all[0].0);
            let ((m, [a, b]), (n, [c, d])) = (all[swapped], all[1 - swapped]);
            (may_touch, ([m, n], [a, b, c, d]))
        };
        self.search(PairKind::EdgeEdge, trees, primitives, blocks, pairs);
    }

    /// Adds the pairs of one kind of the primitives of two trees, or of one. `blocks` is scratch.
    fn search(
        &self,
        kind: PairKind,
        trees: [&Tree; 2],
        primitives: impl Fn([u32; 2]) -> (bool, Primitives) + Sync,
        blocks: &mut Vec<[u32; 2]>,
        pairs: &mut Vec<Listed>,
    ) {
        trees[0].blocks_near(trees[1], self.renewed.is_some(), blocks);
        let find = |blocks: &[[u32; 2]], near: &mut Vec<[u32; 2]>, pairs: &mut Vec<Listed>| {
            near.clear();
            let found = &mut *near;
            Meeting { trees, changed: self.renewed.is_some(), blocks, found }.find();
            self.bound(kind, near.iter().map(|pair| primitives(*pair)), pairs);
        };
        if self.parallel {
            pairs.par_extend(blocks.par_chunks(CHUNK).flat_map_iter(|blocks| {
                let mut found = vec![];
                find(blocks, &mut vec![], &mut found);
                found
            }));
        } else {
            let mut near = vec![];
            for blocks in blocks.chunks(CHUNK) {
                find(blocks, &mut near, pairs);
            }
        }
    }

    /// Adds those of these pairs of primitives of one kind that may touch and come within reach.
    /// Whether they may is random, so nothing branches there.
    fn bound(
        &self,
        kind: PairKind,
        near: impl Iterator<Item = (bool, Primitives)>,
        pairs: &mut Vec<Listed>,
    ) {
        let mut block = Block::new();
        let mut members = [([0; 2], [0; 4]); LANES];
        let mut count = 0;
        let mut empty = |members: &[Primitives]| {
            for (lane, (_, points)) in members.iter().enumerate() {
                block.set(lane, *points, self.course.base, Some(self.course.speeds));
            }
            block.bound(kind);
            for (lane, (ranks, points)) in members.iter().enumerate() {
                let bounds = [block.distance[lane], block.closing[lane]];
                pairs.extend(if bounds[0].is_finite() {
                    self.listed(kind, *ranks, *points, bounds)
                } else {
                    self.pair(kind, *ranks, *points)
                });
            }
        };
        for (may_touch, found) in near {
            members[count] = found;
            count += usize::from(may_touch);
            if count == LANES {
                empty(&members);
                count = 0;
            }
        }
        empty(&members[..count]);
    }

    /// Lists the pair of these primitives, by their ranks and points, if it comes within reach.
    fn pair(&self, kind: PairKind, ranks: [u32; 2], points: [u32; 4]) -> Option<Listed> {
        let course = self.course;
        let origin = course.base[points[0] as usize];
        let x = points.map(|i| course.base[i as usize] - origin);
        let normal = match kind {
            PairKind::VertexFloor => Vector3::y(),
            _ => closest(kind, &x).offset.try_normalize(0.0).unwrap_or_default(),
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
        let distance = if normal == Vector3::zeros() { f64::NEG_INFINITY } else { apart(x) };
        let closing = -apart(points.map(|i| course.speeds[i as usize]));
        self.listed(kind, ranks, points, [distance, closing])
    }

    /// Lists the pair of these primitives, whose distance (m) and the speed at which it shrinks
    /// (m/s) are bounded, if it comes within reach.
    fn listed(
        &self,
        kind: PairKind,
        ranks: [u32; 2],
        points: [u32; 4],
        [distance, closing]: [f64; 2],
    ) -> Option<Listed> {
        let course = self.course;
        let gap = distance - self.surface.reach(kind, &points) - self.surface.rounding();
        let listed = gap - closing.max(0.0) * course.horizon < course.reach;
        listed.then(|| Listed {
            key: (kind as u64) << 62 | u64::from(ranks[0]) << 31 | u64::from(ranks[1]),
            candidate: Candidate { points, kind },
            gap,
            closing,
        })
    }
}
