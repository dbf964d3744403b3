//! Closest points of a vertex and a triangle, of two edges, and of a vertex and a floor (Ericson,
//! *Real-Time Collision Detection*, 2005, 5.1), and nearest points of the surfaces of obstacles,
//! in the obstacle's own frame.

use std::ops::Range;

use nalgebra::Vector3;

/// Squared sine of the angle between two edges up to which their ends are also tried as closest
/// points: the linear system for interior points is then too ill-conditioned.
const PARALLEL_SINE_SQUARED: f64 = 1e-6;

/// Squared double area of a triangle, as a share of the product of two of its squared sides, up to
/// which the triangle counts as degenerate: it then consists of its edges.
const FLAT_SHARE: f64 = 1e-12;

/// Kind of a pair of primitives. Its four points are the vertices of the first primitive, then
/// those of the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum PairKind {
    /// Vertex (point 0) and triangle (points 1, 2, 3).
    VertexTriangle,
    /// Edge (points 0, 1) and edge (points 2, 3). An edge whose ends are equal is a point.
    EdgeEdge,
    /// Vertex (point 0) and the horizontal plane through point 1; points 2 and 3 are unused.
    VertexFloor,
}

impl PairKind {
    /// Returns the number of points of the first primitive.
    #[must_use]
    pub fn first(self) -> usize {
        if self == Self::EdgeEdge { 2 } else { 1 }
    }

    /// Returns the numbers of the points of both primitives. A floor has one.
    #[must_use]
    pub fn sides(self) -> [Range<usize>; 2] {
        let last = if self == Self::VertexFloor { 2 } else { 4 };
        [0..self.first(), self.first()..last]
    }
}

/// Closest points of a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// Weights of the four points, which sum to 0: the closest point of the first primitive is the
    /// sum over its points, that of the second the sum over its points with the sign reversed.
    pub weights: [f64; 4],
    /// Vector from the closest point of the second primitive to that of the first (m), which is the
    /// sum of the weighted points.
    pub offset: Vector3<f64>,
}

impl Closest {
    /// Returns the distance (m) and the unit vector from the second primitive to the first, unless
    /// they touch. The distance from a floor is the height above it, and its unit vector is known.
    pub(crate) fn apart(&self, kind: PairKind) -> Option<(f64, Vector3<f64>)> {
        if kind == PairKind::VertexFloor {
            return Some((self.offset.y, Vector3::y()));
        }
        let distance = self.offset.norm();
        (distance > 0.0).then(|| (distance, self.offset / distance))
    }

    fn new(weights: [f64; 4], points: &[Vector3<f64>; 4]) -> Self {
        Self { weights, offset: weighted(&weights, points) }
    }

    /// Returns the closer of two pairs of points.
    fn nearer(self, other: Self) -> Self {
        if other.offset.norm_squared() < self.offset.norm_squared() { other } else { self }
    }
}

/// Sums weighted vectors.
#[must_use]
pub fn weighted(weights: &[f64; 4], vectors: &[Vector3<f64>; 4]) -> Vector3<f64> {
    vectors[0] * weights[0]
        + vectors[1] * weights[1]
        + vectors[2] * weights[2]
        + vectors[3] * weights[3]
}

/// Finds the closest points of the pair of that kind with those points (m).
///
/// ```
/// use a3_core::Vector3;
/// use a3_core::contact::{PairKind, closest};
///
/// // Two edges that cross at right angles, 2 m apart.
/// let at = |x, y, z| Vector3::new(x, y, z);
/// let points = [at(-1.0, 0.0, 0.0), at(1.0, 0.0, 0.0), at(0.0, -1.0, 2.0), at(0.0, 1.0, 2.0)];
/// let found = closest(PairKind::EdgeEdge, &points);
/// assert_eq!((found.offset.norm(), found.weights), (2.0, [0.5, 0.5, -0.5, -0.5]));
/// ```
#[must_use]
pub fn closest(kind: PairKind, points: &[Vector3<f64>; 4]) -> Closest {
    match kind {
        PairKind::VertexTriangle => vertex_triangle(points),
        PairKind::EdgeEdge => edge_edge(points),
        PairKind::VertexFloor => Closest {
            weights: [1.0, -1.0, 0.0, 0.0],
            offset: Vector3::new(0.0, points[0].y - points[1].y, 0.0),
        },
    }
}

fn vertex_triangle(points: &[Vector3<f64>; 4]) -> Closest {
    let [p, a, b, c] = *points;
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let on = |u: f64, v: f64, w: f64| Closest::new([1.0, -u, -v, -w], points);
    if ab.cross(&ac).norm_squared() <= FLAT_SHARE * ab.norm_squared() * ac.norm_squared() {
        let [s, t, u] = [[a, b], [b, c], [c, a]].map(|side| share(p, side));
        return on(1.0 - s, s, 0.0).nearer(on(0.0, 1.0 - t, t)).nearer(on(u, 0.0, 1.0 - u));
    }
    let (d1, d2) = (ab.dot(&ap), ac.dot(&ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return on(1.0, 0.0, 0.0);
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(&bp), ac.dot(&bp));
    if d3 >= 0.0 && d4 <= d3 {
        return on(0.0, 1.0, 0.0);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let v = d1 / (d1 - d3);
        return on(1.0 - v, v, 0.0);
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(&cp), ac.dot(&cp));
    if d6 >= 0.0 && d5 <= d6 {
        return on(0.0, 0.0, 1.0);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let w = d2 / (d2 - d6);
        return on(1.0 - w, 0.0, w);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        let w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
        return on(0.0, 1.0 - w, w);
    }
    let scale = 1.0 / (va + vb + vc);
    let (v, w) = (vb * scale, vc * scale);
    on(1.0 - v - w, v, w)
}

fn edge_edge(points: &[Vector3<f64>; 4]) -> Closest {
    let [p, q, r, s] = *points;
    let (d1, d2, between) = (q - p, s - r, p - r);
    let (a, e, b) = (d1.norm_squared(), d2.norm_squared(), d1.dot(&d2));
    let (c, f) = (d1.dot(&between), d2.dot(&between));
    let on = |s: f64, t: f64| Closest::new([1.0 - s, s, t - 1.0, -t], points);
    let cross = a * e - b * b;
    let within = (cross > 0.0).then(|| {
        let s = ((b * f - c * e) / cross).clamp(0.0, 1.0);
        let t = (b * s + f) / e;
        if t < 0.0 {
            on((-c / a).clamp(0.0, 1.0), 0.0)
        } else if t > 1.0 {
            on(((b - c) / a).clamp(0.0, 1.0), 1.0)
        } else {
            on(s, t)
        }
    });
    match within {
        Some(within) if cross > PARALLEL_SINE_SQUARED * a * e => within,
        _ => {
            let ends = [
                on(0.0, share(p, [r, s])),
                on(1.0, share(q, [r, s])),
                on(share(r, [p, q]), 0.0),
                on(share(s, [p, q]), 1.0),
            ];
            let nearest = ends.into_iter().reduce(Closest::nearer);
            [nearest, within]
                .into_iter()
                .flatten()
                .reduce(Closest::nearer)
                .unwrap_or_else(|| on(0.0, 0.0))
        }
    }
}

/// Returns the position along an edge, as a share, of its point nearest to p; 0 if the edge is a
/// point.
fn share(p: Vector3<f64>, [a, b]: [Vector3<f64>; 2]) -> f64 {
    let along = b - a;
    let squared = along.norm_squared();
    if squared > 0.0 { ((p - a).dot(&along) / squared).clamp(0.0, 1.0) } else { 0.0 }
}

/// Nearest point of a surface (m), and the unit normal there.
pub(crate) struct Nearest {
    pub point: Vector3<f64>,
    pub normal: Vector3<f64>,
}

/// Separation of a point from a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Separation {
    /// Distance from the surface (m), below 0 inside.
    pub distance: f64,
    /// Direction in which the distance grows fastest: a unit vector.
    pub normal: Vector3<f64>,
}

/// Returns the nearest point of a sphere around the origin to a point d inside it; for its centre,
/// the point in the direction of `aside`.
pub(crate) fn of_sphere(
    d: Vector3<f64>,
    radius: f64,
    aside: impl Fn() -> Vector3<f64>,
) -> Option<Nearest> {
    let squared = d.x * d.x + d.y * d.y + d.z * d.z;
    if squared < radius * radius {
        let distance = squared.sqrt();
        let normal = if distance > 0.0 { d / distance } else { aside() };
        Some(Nearest { point: radius * normal, normal })
    } else {
        None
    }
}

/// Returns the nearest point of a box around the origin to a point d inside it: on the nearest
/// face.
pub(crate) fn of_box(
    d: Vector3<f64>,
    half_extents: Vector3<f64>,
    axes: [Vector3<f64>; 3],
) -> Option<Nearest> {
    let local = axes.map(|axis| axis.dot(&d));
    let depth = |k: usize| half_extents[k] - local[k].abs();
    if !(0..3).all(|k| depth(k) > 0.0) {
        return None;
    }
    let k = (1..3).fold(0, |k, other| if depth(other) < depth(k) { other } else { k });
    let normal = if local[k] < 0.0 { -axes[k] } else { axes[k] };
    Some(Nearest { point: d + normal * depth(k), normal })
}

/// Returns a segment as a vector, and the share of it after which it is nearest to d.
pub(super) fn along_axis([a, b]: [Vector3<f64>; 2], d: Vector3<f64>) -> (Vector3<f64>, f64) {
    let axis = b - a;
    let squared = axis.norm_squared();
    let share = if squared > 0.0 { ((d - a).dot(&axis) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (axis, share)
}

/// Returns the nearest point of a capsule to a point d inside it.
pub(crate) fn of_capsule(
    d: Vector3<f64>,
    [a, b]: [Vector3<f64>; 2],
    radius: f64,
) -> Option<Nearest> {
    let (axis, share) = along_axis([a, b], d);
    let middle = a + share * axis;
    let Nearest { point, normal } = of_sphere(d - middle, radius, || upwards(axis))?;
    Some(Nearest { point: middle + point, normal })
}

/// Returns the nearest point of a floor at height 0 to a point d below it.
pub(crate) fn of_floor(d: Vector3<f64>) -> Option<Nearest> {
    (d.y < 0.0).then(|| Nearest { point: Vector3::new(d.x, 0.0, d.z), normal: Vector3::y() })
}

/// Returns the unit vector perpendicular to an axis that points upwards most steeply; along x if
/// the axis is vertical.
fn upwards(axis: Vector3<f64>) -> Vector3<f64> {
    let squared = axis.norm_squared();
    if squared == 0.0 {
        return Vector3::y();
    }
    [Vector3::y(), Vector3::x()]
        .into_iter()
        .map(|e| e - axis * (axis.dot(&e) / squared))
        .find(|across| across.norm_squared() > 1e-6)
        .map_or(Vector3::y(), |across| across.normalize())
}

/// Returns two unit vectors, perpendicular to a third and to one another.
pub(crate) fn normals(direction: Vector3<f64>) -> [Vector3<f64>; 2] {
    let mut axis = Vector3::zeros();
    axis[direction.iamin()] = 1.0;
    let first = direction.cross(&axis).normalize();
    [first, direction.cross(&first)]
}
