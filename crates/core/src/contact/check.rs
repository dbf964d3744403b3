//! Exact check of a state for surfaces that cross.

use std::fmt;

use super::advance::rounding_error;
use super::candidates::Stretch;
use super::exact::{Crossing, crossings};
use super::layer::{Buffers, ContactLayer};
use super::listing::Candidate;
use crate::error::Vertex;
use crate::geometry::bvh::{Aabb, Bvh};
use crate::geometry::{PairKind, closest};

/// Number of pairs of boxes that may meet at the beginning in any surface.
const MAX_PAIRS: usize = 1_000_000;
/// Number of pairs of boxes per box that may meet at the beginning; cloth has some fifteen.
const MAX_PAIRS_PER_BOX: usize = 50;

/// Two primitives that have a point in common, by their vertices.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Crossed {
    /// Vertices of the first primitive: an edge, or whatever is inside a round obstacle or a floor.
    pub first: Vec<Vertex>,
    /// Vertices of the second primitive: a triangle, a round obstacle or a floor.
    pub second: Vec<Vertex>,
}

impl fmt::Display for Crossed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let side = |vertices: &[Vertex]| {
            if let [whole @ (Vertex::Obstacle(_) | Vertex::Body(_)), ..] = vertices {
                return whole.to_string();
            }
            let numbers = vertices.iter().filter_map(|vertex| match vertex {
                Vertex::Particle(i) => Some(i.to_string()),
                Vertex::Obstacle(_) | Vertex::Body(_) => None,
            });
            let numbers = numbers.collect::<Vec<_>>().join(", ");
            match vertices {
                [_] => format!("particle {numbers}"),
                [_, _] => format!("the edge of particles {numbers}"),
                _ => format!("the triangle of particles {numbers}"),
            }
        };
        write!(f, "{} crosses {}", side(&self.first), side(&self.second))
    }
}

/// Finds the pairs of an edge and a triangle that have a point in common at time t (s), with
/// particles at x (m), n x 3. They are found exactly, by signs of determinants. Also finds the
/// primitives inside a round obstacle or a floor, up to rounding. Pairs of obstacles are not
/// checked, nor are pairs of bodies if bodies cannot touch one another.
///
/// # Panics
/// x has not three numbers for each particle.
#[must_use]
pub fn crossed(layer: &ContactLayer, t: f64, x: &[f64]) -> Vec<Crossed> {
    let surface = layer.surface();
    let n = surface.particles();
    assert_eq!(x.len(), 3 * n, "x has three numbers for each particle");
    layer
        .scratch
        .lend(|buffers| crossed_with(layer, buffers, t, x))
}

/// Returns whether too many primitives of a thickness (m) are close together at time t (s), with
/// particles at x (m), n x 3, to list their pairs: those whose boxes meet.
pub(crate) fn is_crowded(layer: &ContactLayer, t: f64, x: &[f64], thickness: f64) -> bool {
    let surface = layer.surface();
    let mut places = vec![];
    surface.place(layer.obstacles(), t, x, &mut places);
    let around = |corners: &[u32; 3]| {
        Aabb::around(corners.map(|i| places[i as usize])).grown(0.5 * thickness)
    };
    let corners = surface
        .bodies
        .corners
        .iter()
        .chain(&surface.obstacles.corners);
    let boxes: Vec<_> = corners.map(around).collect();
    let most = MAX_PAIRS.max(MAX_PAIRS_PER_BOX * boxes.len());
    let mut pairs = 0;
    !Bvh::new(&boxes).pairs(|_, _| {
        pairs += 1;
        pairs <= most
    })
}

fn crossed_with(layer: &ContactLayer, buffers: &mut Buffers, t: f64, x: &[f64]) -> Vec<Crossed> {
    let surface = layer.surface();
    let (edges, triangles): (Vec<_>, Vec<_>) =
        (surface.edges().collect(), surface.triangles().collect());
    let (crossings, inside) = meetings(layer, buffers, t, x, &edges, &triangles);
    let name = |points: &[u32]| points.iter().map(|i| surface.vertex(*i)).collect();
    let exact = crossings.into_iter().map(|crossing| Crossed {
        first: name(&edges[crossing.edge]),
        second: name(&triangles[crossing.triangle]),
    });
    let inside = inside.iter().map(|pair| {
        let (first, second) = pair.points.split_at(pair.kind.first());
        let of = |points: &[u32]| {
            let mut points = points.to_vec();
            points.dedup();
            name(&points)
        };
        Crossed {
            first: of(first),
            second: of(second),
        }
    });
    exact.chain(inside).collect()
}

/// Finds the crossings of these edges and triangles of the surface, and the pairs inside a round
/// obstacle or a floor, as [`crossed`] does.
pub(super) fn meetings(
    layer: &ContactLayer,
    buffers: &mut Buffers,
    t: f64,
    x: &[f64],
    edges: &[[u32; 2]],
    triangles: &[[u32; 3]],
) -> (Vec<Crossing>, Vec<Candidate>) {
    let surface = layer.surface();
    let n = surface.particles();
    let Buffers {
        candidates,
        x: places,
        ..
    } = buffers;
    surface.place(layer.obstacles(), t, x, places);
    let counts = |crossing: &Crossing| {
        let (edge, triangle) = (edges[crossing.edge], triangles[crossing.triangle]);
        let [a, b] = [edge[0], triangle[0]].map(|i| (i as usize) < n);
        let apart = !surface.are_one(&edge, &triangle);
        a && b && surface.touches_itself && apart || a != b
    };
    let mut exact = crossings(x, &places[n..], triangles, edges);
    exact.retain(counts);
    let stretch = Stretch {
        times: [t; 2],
        ends: [places; 2],
        speeds: None,
    };
    candidates.cover(surface, &stretch);
    let is_inside = |pair: &&Candidate| {
        let (x, radius) = (pair.of(places), surface.radii(pair.kind, &pair.points));
        let offset = closest(pair.kind, &x).offset;
        let least = radius - rounding_error(&x);
        match pair.kind {
            PairKind::VertexFloor => offset.y < least,
            _ => radius > 0.0 && offset.norm() < least,
        }
    };
    let inside = candidates.near(surface.nearest()).filter(is_inside);
    (exact, inside.copied().collect())
}
