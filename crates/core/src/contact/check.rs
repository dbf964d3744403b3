//! Exact check of a state for surfaces that cross.
//!
//! Edges that meet triangles, found exactly: the signs of determinants are those of real arithmetic
//! (Shewchuk, *Adaptive precision floating-point arithmetic and fast robust geometric predicates*,
//! 1997).

use std::fmt;

use nalgebra::Vector3;
use robust::{Coord, Coord3D, orient2d, orient3d};

use super::advance::rounding_error;
use super::candidates::Stretch;
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
        f.write_str(&self.told(&|whole| whole.to_string()))
    }
}

impl Crossed {
    /// Returns the pair in words, with these names of bodies and obstacles.
    pub(crate) fn told(&self, name: &dyn Fn(Vertex) -> String) -> String {
        let side = |vertices: &[Vertex]| {
            if let [whole @ (Vertex::Obstacle(_) | Vertex::Body(_)), ..] = vertices {
                return name(*whole);
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
        format!("{} crosses {}", side(&self.first), side(&self.second))
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
    layer.scratch.lend(|buffers| crossed_with(layer, buffers, t, x))
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
    let corners = surface.bodies.corners.iter().chain(&surface.obstacles.corners);
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
        Crossed { first: of(first), second: of(second) }
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
    let Buffers { candidates, x: places, .. } = buffers;
    surface.place(layer.obstacles(), t, x, places);
    let counts = |crossing: &Crossing| {
        let (edge, triangle) = (edges[crossing.edge], triangles[crossing.triangle]);
        let [a, b] = [edge[0], triangle[0]].map(|i| (i as usize) < n);
        let apart = !surface.are_one(&edge, &triangle);
        a && b && surface.touches_itself && apart || a != b
    };
    let mut exact = crossings(x, &places[n..], triangles, edges);
    exact.retain(counts);
    let stretch = Stretch { times: [t; 2], ends: [places; 2], speeds: None };
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

/// Edge and triangle that have a point in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Crossing {
    /// Index of the edge.
    pub edge: usize,
    /// Index of the triangle.
    pub triangle: usize,
}

/// Finds the edges and triangles that have a point but no corner in common, in ascending order.
///
/// `positions` are points (m) as n x 3 numbers in column-major order, as at the beginning of a
/// state; corners from n on are indices into `others` (m). All coordinates are finite.
///
/// The answer is exact as long as no product of three distances underflows. Edges and triangles are
/// closed sets: they also cross if they touch in one point, such as a corner, or overlap in one
/// plane, as cloth does that is folded onto itself at distance zero. Primitives in one plane that
/// do not touch, as those of flat cloth, do not cross. Edges with equal ends are points, and
/// degenerate triangles consist of their sides.
///
/// An edge and a triangle with a corner in common are not compared: they always meet there.
///
/// # Panics
///
/// If a corner is neither among the positions nor among the other points.
#[must_use]
pub fn crossings(
    positions: &[f64],
    others: &[Vector3<f64>],
    triangles: &[[u32; 3]],
    edges: &[[u32; 2]],
) -> Vec<Crossing> {
    let n = positions.len() / 3;
    let point = |i: u32| {
        let i = i as usize;
        if i < n {
            Vector3::new(positions[i], positions[n + i], positions[2 * n + i])
        } else {
            others[i - n]
        }
    };
    let edges_tree = tree(edges.iter().map(|corners| corners.map(point)));
    let triangles_tree = tree(triangles.iter().map(|corners| corners.map(point)));
    let mut found = vec![];
    edges_tree.pairs_with(&triangles_tree, |edge, triangle| {
        let (edge, triangle) = (edge as usize, triangle as usize);
        let (ends, corners) = (edges[edge], triangles[triangle]);
        if !ends.iter().any(|i| corners.contains(i))
            && edge_meets_triangle(ends.map(point), corners.map(point))
        {
            found.push(Crossing { edge, triangle });
        }
    });
    found.sort_unstable();
    found
}

/// Creates a tree of the boxes around primitives.
fn tree<const N: usize>(primitives: impl Iterator<Item = [Vector3<f64>; N]>) -> Bvh {
    Bvh::new(&primitives.map(Aabb::around).collect::<Vec<_>>())
}

/// Returns whether a closed edge and a closed triangle have a point in common.
fn edge_meets_triangle([p, q]: [Vector3<f64>; 2], [a, b, c]: [Vector3<f64>; 3]) -> bool {
    let sides = [[a, b], [b, c], [c, a]];
    // Most pairs of a smooth surface lie beside one another. This test is cheaper than that of
    // their position in space, above all if they lie in one plane.
    let axis = (b - a).cross(&(c - a)).iamax();
    let whole = turn(axis, a, b, c);
    if sides
        .iter()
        .any(|[a, b]| whole * turn(axis, *a, *b, p) < 0.0 && whole * turn(axis, *a, *b, q) < 0.0)
    {
        return false;
    }
    let (above, below) = (side(a, b, c, p), side(a, b, c, q));
    if above * below > 0.0 {
        return false;
    }
    if above != 0.0 || below != 0.0 {
        // The edge meets the plane in one point.
        let turns = [side(p, q, a, b), side(p, q, b, c), side(p, q, c, a)];
        return turns.iter().all(|turn| *turn >= 0.0) || turns.iter().all(|turn| *turn <= 0.0);
    }
    sides.iter().any(|side| edges_meet([p, q], *side))
        || (0..3).any(|axis| {
            let turns = sides.map(|[a, b]| turn(axis, a, b, p));
            turns.iter().all(|turn| *turn > 0.0) || turns.iter().all(|turn| *turn < 0.0)
        })
}

/// Returns whether two closed edges have a point in common.
fn edges_meet([p, q]: [Vector3<f64>; 2], [a, b]: [Vector3<f64>; 2]) -> bool {
    if side(p, q, a, b) != 0.0 {
        return false;
    }
    // They lie in one plane: project along an axis that is not in it. If there is none, they lie on
    // one line.
    for axis in 0..3 {
        let [a, b, p, q] =
            [turn(axis, p, q, a), turn(axis, p, q, b), turn(axis, a, b, p), turn(axis, a, b, q)];
        if a != 0.0 || b != 0.0 || p != 0.0 || q != 0.0 {
            return a * b <= 0.0 && p * q <= 0.0;
        }
    }
    (0..3).all(|axis| {
        p[axis].min(q[axis]) <= a[axis].max(b[axis]) && a[axis].min(b[axis]) <= p[axis].max(q[axis])
    })
}

/// Returns the sign of the volume of a tetrahedron: exactly -1, 0 or 1.
fn side(a: Vector3<f64>, b: Vector3<f64>, c: Vector3<f64>, d: Vector3<f64>) -> f64 {
    let at = |x: Vector3<f64>| Coord3D { x: x.x, y: x.y, z: x.z };
    sign(orient3d(at(a), at(b), at(c), at(d)))
}

/// Returns the sign of the area of a triangle seen along an axis: exactly -1, 0 or 1.
fn turn(axis: usize, a: Vector3<f64>, b: Vector3<f64>, c: Vector3<f64>) -> f64 {
    let at = |x: Vector3<f64>| Coord { x: x[(axis + 1) % 3], y: x[(axis + 2) % 3] };
    sign(orient2d(at(a), at(b), at(c)))
}

fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}
