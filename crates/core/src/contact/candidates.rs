//! Pairs of primitives that may touch, from trees of boxes, kept until somebody has moved too far.
//!
//! The list is a cache and nothing else: who asks it gets every pair that is near enough, in one
//! canonical order, and perhaps others, whenever and from whatever states it was made.

use nalgebra::Vector3;
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, BvhWorkspace};

use super::closest::{PairKind, closest};
use super::surface::{Items, Surface};

/// Share of the largest thickness that a margin lies between.
const MARGINS: (f64, f64) = (0.1, 2.0);
/// Uses between which the makings of a list should lie: with fewer the margin grows, and with more
/// it shrinks.
const USES: (u32, u32) = (8, 64);

/// Pair that may touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Candidate {
    pub points: [u32; 4],
    pub kind: PairKind,
    /// Distance (m), less the radius of obstacles, that the pair had at least on the whole way for
    /// which the list was made.
    gap: f64,
}

impl Candidate {
    /// The positions, or other vectors, of its points.
    pub fn of<T: Copy>(&self, all: &[T]) -> [T; 4] {
        self.points.map(|i| all[i as usize])
    }

    /// Most by which its primitives come nearer if each vertex moves so far.
    fn approach(&self, travel: &[f64]) -> f64 {
        let [a, b, c, d] = self.of(travel);
        match self.kind {
            PairKind::VertexTriangle => a + b.max(c).max(d),
            PairKind::EdgeEdge => a.max(b) + c.max(d),
            PairKind::VertexFloor => a + b,
        }
    }
}

/// List of pairs.
#[derive(Debug, Default)]
pub(super) struct Candidates {
    bodies: Tree,
    obstacles: Tree,
    pairs: Vec<Candidate>,
    /// Positions (m) at both ends of the way for which the list was made; none if it was not.
    base: [Vec<Vector3<f64>>; 2],
    /// How far a vertex may leave that way (m).
    margin: f64,
    uses: u32,
    travel: Vec<f64>,
}

impl Candidates {
    /// Makes sure that the list has every pair that comes nearer than its thickness while vertices
    /// move in straight lines between two states (m).
    pub fn cover(&mut self, surface: &Surface, from: &[Vector3<f64>], to: &[Vector3<f64>]) {
        let reach = surface.thickest();
        let covered = self.base[0].len() == from.len() && self.measure(from, to) <= self.margin;
        if covered {
            self.uses = self.uses.saturating_add(1);
            return;
        }
        let (least, most) = (MARGINS.0 * reach, MARGINS.1 * reach);
        if self.base[0].is_empty() {
            self.margin = reach;
        } else if self.uses < USES.0 {
            self.margin = (1.5 * self.margin).min(most);
        } else if self.uses > USES.1 {
            self.margin = (0.7 * self.margin).max(least);
        }
        self.uses = 0;
        self.make(surface, reach, from, to);
        self.measure(from, to);
    }

    /// Finds how far each vertex leaves the way of the list; the most of it (m). A motion that all
    /// vertices share is none.
    fn measure(&mut self, from: &[Vector3<f64>], to: &[Vector3<f64>]) -> f64 {
        let Self { base, travel, .. } = self;
        let mean = [(from, &base[0]), (to, &base[1])].map(|(x, base)| mean_difference(x, base));
        travel.clear();
        travel.extend((0..from.len()).map(|i| {
            let first = (from[i] - base[0][i] - mean[0]).norm_squared();
            let last = (to[i] - base[1][i] - mean[1]).norm_squared();
            first.max(last).sqrt()
        }));
        travel.iter().copied().fold(0.0, f64::max)
    }

    /// The pairs, in canonical order, that may come nearer than this gap (m), a function of the
    /// pair, on the way that was covered last.
    pub fn near<'a>(
        &'a self,
        gap: impl Fn(&Candidate) -> f64 + 'a,
    ) -> impl Iterator<Item = &'a Candidate> {
        let is_near = move |pair: &&Candidate| pair.gap - pair.approach(&self.travel) < gap(pair);
        self.pairs.iter().filter(is_near)
    }

    fn make(
        &mut self,
        surface: &Surface,
        reach: f64,
        from: &[Vector3<f64>],
        to: &[Vector3<f64>],
    ) {
        let reach = reach + 2.0 * self.margin;
        self.base[0].clear();
        self.base[0].extend_from_slice(from);
        self.base[1].clear();
        self.base[1].extend_from_slice(to);
        let way = Way {
            surface,
            from,
            to,
            shift: mean_difference(to, from),
            reach,
        };
        let mut pairs = std::mem::take(&mut self.pairs);
        pairs.clear();
        self.bodies.refit(&surface.bodies, &way);
        self.obstacles.refit(&surface.obstacles, &way);
        let (bodies, obstacles) = (&surface.bodies, &surface.obstacles);
        let boxes = &self.bodies.boxes[..];
        if surface.touches_itself {
            let tree = &self.bodies.tree;
            tree.traverse_bvtt_single_tree::<false>(&mut self.bodies.workspace, &mut |s, t| {
                way.find([bodies, bodies], [s, t], [boxes, boxes], &mut pairs);
            });
        }
        if !obstacles.corners.is_empty() && !bodies.corners.is_empty() {
            let (tree, other) = (&self.bodies.tree, &self.obstacles.tree);
            let both = [boxes, &self.obstacles.boxes[..]];
            for (s, t) in tree.leaf_pairs(other, parry3d_f64::partitioning::BvhNode::intersects) {
                way.find([bodies, obstacles], [s, t], both, &mut pairs);
            }
        }
        for &floor in &surface.floors {
            for &i in bodies.all_vertices() {
                way.keep(PairKind::VertexFloor, [i, floor, floor, floor], &mut pairs);
            }
        }
        pairs.sort_unstable_by_key(|pair| (pair.kind, pair.points));
        self.pairs = pairs;
    }
}

fn mean_difference(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> Vector3<f64> {
    let sum = a.iter().zip(b).fold(Vector3::zeros(), |sum, (a, b)| sum + (a - b));
    sum / a.len().max(1) as f64
}

/// Way of all vertices for which a list is made.
struct Way<'a> {
    surface: &'a Surface,
    from: &'a [Vector3<f64>],
    to: &'a [Vector3<f64>],
    /// Mean motion, which is left out (m).
    shift: Vector3<f64>,
    /// Gap below which pairs are listed (m).
    reach: f64,
}

impl Way<'_> {
    /// Box around vertices on the way, with half the reach around it.
    fn around(&self, vertices: &[u32]) -> Aabb {
        let mut low = Vector3::repeat(f64::INFINITY);
        let mut high = Vector3::repeat(f64::NEG_INFINITY);
        for &i in vertices {
            let (a, b) = (self.from[i as usize], self.to[i as usize] - self.shift);
            low = low.inf(&a.inf(&b));
            high = high.sup(&a.sup(&b));
        }
        let around = 0.5 * self.reach + self.surface.radius(vertices[0]);
        let corner = |v: Vector3<f64>, by: f64| Vector::new(v.x + by, v.y + by, v.z + by);
        Aabb::new(corner(low, -around), corner(high, around))
    }

    /// Adds the pairs of primitives of two items that are within reach.
    fn find(
        &self,
        items: [&Items; 2],
        [s, t]: [u32; 2],
        boxes: [&[Aabb]; 2],
        pairs: &mut Vec<Candidate>,
    ) {
        let (s, t) = (s as usize, t as usize);
        for ([a, b], [k, l]) in [([0, 1], [s, t]), ([1, 0], [t, s])] {
            if !items[b].is_triangle(l) {
                continue;
            }
            let corners = items[b].corners[l];
            for &v in items[a].vertices(k) {
                if !corners.contains(&v) && meet(&self.around(&[v]), &boxes[b][l]) {
                    let [p, q, r] = corners;
                    self.keep(PairKind::VertexTriangle, [v, p, q, r], pairs);
                }
            }
        }
        for e in items[0].edges(s) {
            let around = self.around(e);
            if !meet(&around, &boxes[1][t]) {
                continue;
            }
            for f in items[1].edges(t) {
                // A point and an edge of a triangle: its corners and the point are a pair already.
                let point = e[0] == e[1] && items[1].is_triangle(t)
                    || f[0] == f[1] && items[0].is_triangle(s);
                if point || e.iter().any(|i| f.contains(i)) || !meet(&around, &self.around(f)) {
                    continue;
                }
                let ([a, b], [c, d]) = if e < f { (e, f) } else { (f, e) };
                self.keep(PairKind::EdgeEdge, [*a, *b, *c, *d], pairs);
            }
        }
    }

    /// Adds a pair if it is within reach.
    fn keep(&self, kind: PairKind, points: [u32; 4], pairs: &mut Vec<Candidate>) {
        let from = points.map(|i| self.from[i as usize]);
        let moves = points.map(|i| self.to[i as usize] - self.from[i as usize]);
        let mean = 0.25 * (moves[0] + moves[1] + moves[2] + moves[3]);
        let travel = moves.map(|d| (d - mean).norm());
        let radius = self.surface.radius(points[0]) + self.surface.radius(points[kind.first()]);
        let distance = match kind {
            // Below a floor the force is still there.
            PairKind::VertexFloor => from[0].y - from[1].y,
            _ => closest(kind, &from).offset.norm(),
        };
        let mut pair = Candidate {
            points,
            kind,
            gap: distance - radius,
        };
        let [a, b, c, d] = travel;
        pair.gap -= match kind {
            PairKind::VertexTriangle => a + b.max(c).max(d),
            PairKind::EdgeEdge => a.max(b) + c.max(d),
            PairKind::VertexFloor => a + b,
        };
        if pair.gap < self.reach {
            pairs.push(pair);
        }
    }
}

fn meet(a: &Aabb, b: &Aabb) -> bool {
    let overlap = |k: usize| a.mins[k] <= b.maxs[k] && b.mins[k] <= a.maxs[k];
    overlap(0) && overlap(1) && overlap(2)
}

/// Tree of the boxes of items.
#[derive(Default)]
struct Tree {
    tree: Bvh,
    boxes: Vec<Aabb>,
    workspace: BvhWorkspace,
}

impl std::fmt::Debug for Tree {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "a tree of {} boxes", self.boxes.len())
    }
}

impl Tree {
    /// Takes the boxes of the items on a way.
    fn refit(&mut self, items: &Items, way: &Way) {
        let first = self.boxes.len() != items.corners.len();
        self.boxes.clear();
        let boxes = items.corners.iter().map(|corners| way.around(corners));
        self.boxes.extend(boxes);
        if first {
            self.tree = Bvh::from_leaves(BvhBuildStrategy::Binned, &self.boxes);
        } else {
            for (k, aabb) in self.boxes.iter().enumerate() {
                self.tree.insert_or_update_partially(*aabb, k as u32, 0.0);
            }
            self.tree.refit(&mut self.workspace);
        }
    }
}
