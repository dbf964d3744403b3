//! What is inside balls, capsules and floors leaves them.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::points::Push;
use crate::contact::listing::Candidate;
use crate::contact::surface::Surface;
use crate::error::Vertex;
use crate::geometry::{PairKind, closest};

/// Distance by which things are moved beyond the surface, as a share of the radius.
const BEYOND: f64 = 1e-3;
/// Distance from the middle, as a share of the radius, up to which all that is inside leaves to the
/// same side.
const DEEP: f64 = 0.5;

/// Returns the pushes that bring what is inside round bodies, obstacles and floors out of them.
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
    let own = offset
        .try_normalize(0.0)
        .filter(|_| pair.kind != PairKind::VertexFloor);
    own.unwrap_or_else(Vector3::y)
}
