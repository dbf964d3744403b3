//! Points that pushes move, while links between them keep their lengths: out of balls, capsules
//! and floors, and so that the curves along which surfaces cross become shorter.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::skeleton::Skeleton;
use crate::contact::check::Crossing;
use crate::contact::layer::ContactLayer;
use crate::contact::listing::Candidate;
use crate::contact::surface::Surface;
use crate::error::Vertex;
use crate::geometry::{PairKind, closest};

/// Share of the movement of a round that goes on in the next.
const INERTIA: f64 = 0.9;
/// Number of passes over the links in a round.
const PASSES: usize = 8;
/// Share of the error of its length by which a pass corrects a link.
const STIFFNESS: f64 = 0.5;

/// What may move to bring surfaces apart.
pub(crate) struct Freedom<'a> {
    /// Pairs of particles whose distances are kept, as far as possible.
    pub links: &'a [[u32; 2]],
    /// Inverse mass of each particle (1/kg), 0 if it stays where it is. All points of a rigid body
    /// have that of the body.
    pub weights: &'a [f64],
}

/// Displacement of one side of a crossing relative to the other.
pub(super) struct Push {
    /// Points on both sides.
    pub points: [u32; 5],
    /// Shares of the points, which are negative on the other side and sum to 0.
    pub shares: [f64; 5],
    /// The displacement (m).
    pub by: Vector3<f64>,
}

/// Points in motion.
pub(super) struct Points<'a> {
    /// Positions (m), those of obstacles last.
    pub at: Vec<Vector3<f64>>,
    /// Their displacements in the last round (m).
    moved: Vec<Vector3<f64>>,
    /// Their inverse masses (1/kg).
    weights: Vec<f64>,
    /// The rigid body of each particle.
    solids: Vec<Option<usize>>,
    links: &'a [[u32; 2]],
    /// Lengths of the links at the beginning (m).
    lengths: Vec<f64>,
}

impl<'a> Points<'a> {
    pub fn new(layer: &ContactLayer, freedom: &Freedom<'a>, t: f64, x: &[f64]) -> Self {
        let surface = layer.surface();
        let mut at = vec![];
        surface.place(layer.obstacles(), t, x, &mut at);
        let mut weights = freedom.weights.to_vec();
        weights.resize(at.len(), 0.0);
        let mut solids = vec![None; at.len()];
        for (k, body) in surface.rigid().iter().enumerate() {
            for i in body.points().chain([body.center()]) {
                solids[i] = Some(k);
            }
        }
        let length = |[a, b]: &[u32; 2]| (at[*a as usize] - at[*b as usize]).norm();
        Self {
            moved: vec![Vector3::zeros(); at.len()],
            weights,
            solids,
            links: freedom.links,
            lengths: freedom.links.iter().map(length).collect(),
            at,
        }
    }

    /// Moves all points: by the mean of the pushes on them, or else by what `of_piece` says for
    /// them, with a share of their last movement; then so that links have their lengths again.
    pub fn advance(&mut self, pushes: &[Push], of_piece: impl Fn(usize) -> Option<Vector3<f64>>) {
        let mut sums = vec![(Vector3::zeros(), 0.0); self.at.len()];
        for Push { points, shares, by } in pushes {
            let pairs = || points.iter().map(|i| *i as usize).zip(shares);
            let least = pairs().map(|(i, share)| self.weights[i] * share * share);
            let least: f64 = least.sum();
            if least == 0.0 {
                continue;
            }
            for (i, share) in pairs().filter(|(i, share)| self.weights[*i] * **share != 0.0) {
                sums[i].0 += by * (self.weights[i] * share / least);
                sums[i].1 += 1.0;
            }
        }
        self.share_in_solids(&mut sums);
        let before = self.at.clone();
        for (i, (sum, count)) in sums.into_iter().enumerate() {
            let pushed = match count {
                _ if self.weights[i] == 0.0 => continue,
                0.0 if self.solids[i].is_some() => sum,
                0.0 => of_piece(i).unwrap_or_default(),
                count => sum / count,
            };
            self.at[i] += self.moved[i] * INERTIA + pushed;
        }
        for _ in 0..PASSES {
            self.correct_links();
        }
        for (moved, (at, before)) in self.moved.iter_mut().zip(self.at.iter().zip(before)) {
            *moved = at - before;
        }
    }

    /// Adds up the pushes on each rigid body, so that its points move alike.
    fn share_in_solids(&self, sums: &mut [(Vector3<f64>, f64)]) {
        let count = self.solids.iter().flatten().max().map_or(0, |most| most + 1);
        let mut of_bodies = vec![(Vector3::zeros(), 0.0); count];
        for (solid, (sum, count)) in self.solids.iter().zip(sums.iter()) {
            if let Some(k) = solid {
                of_bodies[*k].0 += sum;
                of_bodies[*k].1 += count;
            }
        }
        for (solid, sum) in self.solids.iter().zip(sums) {
            if let Some(k) = solid {
                *sum = of_bodies[*k];
            }
        }
    }

    /// Moves the ends of each link towards its length.
    fn correct_links(&mut self) {
        let free = |i: usize| {
            if self.solids[i].is_some() { 0.0 } else { self.weights[i] }
        };
        for (link, length) in self.links.iter().zip(&self.lengths) {
            let [i, j] = link.map(|i| i as usize);
            let (a, b) = (free(i), free(j));
            let apart = self.at[j] - self.at[i];
            let now = apart.norm();
            if a + b > 0.0 && now > 0.0 {
                let by = apart * (STIFFNESS * (now - length) / now / (a + b));
                self.at[i] += by * a;
                self.at[j] -= by * b;
            }
        }
    }
}

/// Distance by which things are moved beyond the surface, as a share of the radius.
const BEYOND: f64 = 1e-3;
/// Distance from the middle, as a share of the radius, up to which all that is inside leaves to the
/// same side.
const DEEP: f64 = 0.5;

/// Returns the pushes that move points out of round bodies, obstacles and floors.
pub(super) fn pushes(surface: &Surface, inside: &[Candidate], at: &[Vector3<f64>]) -> Vec<Push> {
    let sides = |pair: &Candidate| {
        [pair.points[0], pair.points[pair.kind.first()]].map(|i| whole(surface.vertex(i)))
    };
    let mut means = BTreeMap::new();
    for pair in inside {
        let mean = means.entry(sides(pair)).or_insert_with(Vector3::zeros);
        *mean += direction(pair, at);
    }
    let push = |pair: &Candidate| {
        let radius = surface.radii(pair.kind, &pair.points);
        let closest = closest(pair.kind, &pair.of(at));
        let is_deep = closest.offset.norm() < DEEP * radius;
        let mean = means[&sides(pair)].try_normalize(0.0).filter(|_| is_deep);
        let direction = mean.unwrap_or_else(|| direction(pair, at));
        let ([a, b, c, d], [i, j, k, l]) = (closest.weights, pair.points);
        Push {
            points: [i, j, k, l, i],
            shares: [a, b, c, d, 0.0],
            by: direction * (radius * (1.0 + BEYOND) - closest.offset.dot(&direction)),
        }
    };
    inside.iter().map(push).collect()
}

/// Returns the key of the body or obstacle of a vertex; all particles that belong to no rigid body
/// have one.
fn whole(vertex: Vertex) -> (u8, usize) {
    match vertex {
        Vertex::Particle(_) => (0, 0),
        Vertex::Body(k) => (1, k),
        Vertex::Obstacle(k) => (2, k),
    }
}

/// Returns the direction in which the first side of a pair is nearest to the outside of the second.
fn direction(pair: &Candidate, at: &[Vector3<f64>]) -> Vector3<f64> {
    let offset = closest(pair.kind, &pair.of(at)).offset;
    let own = offset.try_normalize(0.0).filter(|_| pair.kind != PairKind::VertexFloor);
    own.unwrap_or_else(Vector3::y)
}

/// Largest displacement of a round, as a share of the length of the edge or of the size of the
/// triangle; of fine surfaces as of coarse ones of the same size.
const REACH: f64 = 0.25;
/// Least displacement of a passage, as a share of the largest.
const LEAST: f64 = 0.5;

/// An edge that crosses a triangle.
pub(super) struct EdgeHit {
    /// Numbers of the edge and of the triangle.
    pub edge: usize,
    pub triangle: usize,
    ends: [u32; 2],
    corners: [u32; 3],
    /// Place along the edge, from 0 to 1.
    pub share: f64,
    /// Weights of the corners at that place, which sum to 1.
    weights: [f64; 3],
    /// Normal of the triangle.
    pub normal: Vector3<f64>,
    /// Heights of the ends of the edge above the triangle (m).
    pub heights: [f64; 2],
    /// Largest displacement of a round (m).
    pub most: f64,
}

impl EdgeHit {
    pub fn new(skeleton: &Skeleton, crossing: Crossing, at: &[Vector3<f64>]) -> Self {
        let Crossing { edge, triangle } = crossing;
        let (ends, corners) = (skeleton.edges[edge], skeleton.triangles[triangle]);
        let [p, q] = ends.map(|i| at[i as usize]);
        let [a, b, c] = corners.map(|i| at[i as usize]);
        let doubled = (b - a).cross(&(c - a));
        // Degenerate triangles have no normal, and do not move.
        let area = doubled.norm().max(f64::MIN_POSITIVE);
        let normal = doubled / area;
        let heights = [p, q].map(|end| (end - a).dot(&normal));
        let across = heights[0] - heights[1];
        let share = if across == 0.0 { 0.5 } else { (heights[0] / across).clamp(0.0, 1.0) };
        let place = p + (q - p) * share;
        let part = |u: Vector3<f64>, v: Vector3<f64>| {
            ((u - place).cross(&(v - place)).dot(&normal) / area).clamp(0.0, 1.0)
        };
        let parts = [part(b, c), part(c, a), part(a, b)];
        let sum: f64 = parts.iter().sum();
        Self {
            edge,
            triangle,
            ends,
            corners,
            share,
            weights: if sum > 0.0 { parts.map(|part| part / sum) } else { [1.0 / 3.0; 3] },
            normal,
            heights,
            most: REACH
                * skeleton.fineness([ends[0], corners[0]])
                * (q - p).norm().min(area.sqrt()),
        }
    }

    /// Returns the displacement (m) of the edge relative to the triangle that brings an end of the
    /// edge to the side of the other.
    pub fn passage(&self, end: usize) -> Vector3<f64> {
        let [own, other] = [self.heights[end], self.heights[1 - end]];
        let height = if own == 0.0 { -other } else { own };
        let by = height.abs().clamp(LEAST * self.most, self.most);
        self.normal * -by.copysign(height)
    }

    /// Returns the end of the edge on the upper side of the triangle.
    pub fn upper_end(&self) -> usize {
        usize::from(self.heights[1] > self.heights[0])
    }

    /// Returns the push that moves the edge relative to the triangle.
    pub fn push(&self, by: Vector3<f64>) -> Push {
        let ([p, q], [a, b, c]) = (self.ends, self.corners);
        let [u, v, w] = self.weights;
        Push { points: [p, q, a, b, c], shares: [1.0 - self.share, self.share, -u, -v, -w], by }
    }
}

/// Least sine of the angle between an edge and a triangle that counts.
const LEAST_SINE: f64 = 1e-2;
/// Length of the gradient at which the displacement is 0.7 of the largest.
const SOFTNESS: f64 = 0.1;
/// Least sine of the angle between two triangles whose curve has a direction.
const PARALLEL_SINE: f64 = 1e-9;

/// Returns the displacement (m) of the edge relative to the triangle that makes the curve of their
/// surfaces shorter. An edge without triangles leaves by its shorter end.
pub(super) fn step(
    skeleton: &Skeleton,
    hit: &EdgeHit,
    at: &[Vector3<f64>],
) -> Option<Vector3<f64>> {
    let ends = skeleton.edges[hit.edge];
    let triangles = skeleton.triangles_at(hit.edge);
    if triangles.is_empty() {
        return Some(hit.passage(usize::from(hit.share > 0.5)));
    }
    let [p, q] = ends.map(|i| at[i as usize]);
    let edge = (q - p).normalize();
    let sine = edge.dot(&hit.normal);
    let sine = sine.abs().max(LEAST_SINE).copysign(sine);
    let mut gradient = Vector3::zeros();
    for triangle in triangles {
        let corners = skeleton.triangles[*triangle as usize];
        let third = corners.into_iter().find(|i| !ends.contains(i))?;
        let to = at[third as usize] - p;
        let inward = to - edge * edge.dot(&to);
        let normal = edge.cross(&inward);
        let along = normal.cross(&hit.normal);
        if along.norm() < PARALLEL_SINE * normal.norm() {
            continue;
        }
        // The curve runs from the edge into the triangle.
        let along = along.normalize() * 1.0_f64.copysign(along.dot(&inward));
        gradient += along - hit.normal * (2.0 * edge.dot(&along) / sine);
    }
    let scale = hit.most / gradient.norm_squared().hypot(SOFTNESS).sqrt();
    gradient.iter().all(|g| g.is_finite()).then_some(gradient * scale)
}
