//! Surface of a network: vertices, edges and triangles of its bodies and of its obstacles, each
//! listed once.

use nalgebra::Vector3;

use super::obstacle::Obstacle;
use super::skin::{KEPT_SHARE, Law, Skin, TURNING_LOSS};
use crate::error::Vertex;
use crate::geometry::{FlatFaces, PairKind, Shape};
use crate::path::Place;
use crate::rigid::Body;

/// Bound of rounding errors of distances, as a share of the largest thickness.
const ROUNDING_SHARE: f64 = 1e-9;

/// Range of speeds over which the force of an elastic pair changes from approach to separation,
/// over the speed that its repulsion alone would give.
const TURN_SHARE: f64 = 0.1;

/// Vertices, edges and triangles of bodies and obstacles. Vertices are the particles, followed by
/// the points of obstacles.
#[derive(Clone, Debug, Default)]
pub struct Surface {
    particles: usize,
    skins: Vec<Skin>,
    radii: Vec<f64>,
    /// The rigid body of each particle, counted from 1, or 0 for none; empty without bodies.
    solids: Vec<u32>,
    /// Rigid bodies.
    rigid: Vec<Body>,
    /// Pairs of bodies, by their centres, and of particles with bodies that joints join, in order.
    joined: Vec<[u32; 2]>,
    /// Points of each obstacle in its own frame, before it turned (m).
    anchors: Vec<Vec<Vector3<f64>>>,
    pub(super) bodies: Items,
    pub(super) obstacles: Items,
    /// Particles of a fluid, as points, in order.
    pub(super) drops: Items,
    /// Flat faces of rigid shapes. Their inner edges and points touch nothing: what would cross
    /// one crosses a triangle beside it, or has a corner there.
    pub(super) flat: FlatFaces,
    /// Whether each particle has no triangles and no edges, and belongs to no rigid body.
    pub(super) singles: Vec<bool>,
    /// Whether any vertex is single, and may touch a rigid shape.
    pub(super) has_points: bool,
    /// Vertices that represent floors.
    pub(super) floors: Vec<u32>,
    /// Whether bodies can touch themselves and one another.
    pub(super) touches_itself: bool,
    thickest: f64,
    thinnest: f64,
}

impl Surface {
    /// Creates the surface of obstacles, and of particles with these skins: corners of triangles,
    /// ends of edges, and points of rigid bodies. An edge with equal ends is a point.
    #[must_use]
    pub fn new(
        skins: &[Skin],
        triangles: &[[u32; 3]],
        edges: &[[u32; 2]],
        bodies: &[Body],
        obstacles: &[Obstacle],
        touches_itself: bool,
    ) -> Self {
        let mut surface = Self {
            particles: skins.len(),
            skins: skins.to_vec(),
            radii: vec![0.0; skins.len()],
            touches_itself,
            rigid: bodies.to_vec(),
            ..Self::default()
        };
        if !bodies.is_empty() {
            surface.solids = vec![0; skins.len()];
        }
        surface.singles = vec![true; skins.len()];
        let corners = triangles.iter().flatten();
        let ends = edges.iter().filter(|[a, b]| a != b).flatten();
        for i in corners.chain(ends) {
            surface.singles[*i as usize] = false;
        }
        for i in bodies.iter().flat_map(Body::points) {
            surface.singles[i] = false;
        }
        let (mut faces, mut sides) = (triangles.to_vec(), edges.to_vec());
        for (k, body) in bodies.iter().enumerate() {
            let mut first = body.points().start as u32;
            for part in body.parts() {
                let simplices = part.shape.simplices();
                let points = simplices.points.len() as u32;
                for i in first..first + points {
                    surface.radii[i as usize] = simplices.radius;
                    surface.solids[i as usize] = k as u32 + 1;
                }
                if let Shape::Sphere { .. } = part.shape {
                    sides.push([first; 2]);
                }
                surface.flat.add(&simplices.flat_faces(), first);
                faces.extend(simplices.triangles.iter().map(|t| t.map(|i| first + i)));
                sides.extend(simplices.edges.iter().map(|e| e.map(|i| first + i)));
                first += points;
            }
        }
        surface.bodies = Items::new(faces, sides, &surface.flat, &[]);
        let (mut faces, mut sides) = (vec![], vec![]);
        for obstacle in obstacles {
            let first = surface.skins.len() as u32;
            let mut simplices = obstacle.shape.simplices();
            if obstacle.shape == Shape::Floor {
                simplices.points.push(Vector3::zeros());
                surface.floors.push(first);
            }
            for _ in &simplices.points {
                surface.skins.push(Skin {
                    thickness: obstacle.thickness,
                    stiffness: f64::INFINITY,
                    damping: 0.0,
                    friction: obstacle.friction,
                    rolling: 0.0,
                    restitution: obstacle.restitution,
                    mass: f64::INFINITY,
                });
                surface.radii.push(simplices.radius);
            }
            if let Shape::Sphere { .. } = obstacle.shape {
                sides.push([first; 2]);
            }
            surface.flat.add(&simplices.flat_faces(), first);
            faces.extend(simplices.triangles.iter().map(|t| t.map(|i| first + i)));
            sides.extend(simplices.edges.iter().map(|e| e.map(|i| first + i)));
            surface.anchors.push(simplices.points);
        }
        surface.obstacles = Items::new(faces, sides, &surface.flat, &[&surface.bodies]);
        let is_hard = !(bodies.is_empty() && obstacles.is_empty());
        surface.has_points =
            is_hard && (0..surface.skins.len() as u32).any(|i| surface.is_single(i));
        surface.measure();
        surface
    }

    /// Adds particles of a fluid to the surface, as edges with equal ends. They touch soft bodies
    /// and obstacles, but neither one another nor rigid bodies.
    pub(crate) fn with_drops(mut self, drops: &[[u32; 2]]) -> Self {
        let others = [&self.bodies, &self.obstacles];
        let mut drops = drops.to_vec();
        drops.sort_unstable();
        self.drops = Items::new([], drops, &FlatFaces::default(), &others);
        self.measure();
        self
    }

    /// Finds the least and the largest thickness of the vertices that touch.
    fn measure(&mut self) {
        let all = [&self.bodies, &self.obstacles, &self.drops];
        let touching = all.into_iter().flat_map(|items| &items.vertices);
        let thicknesses = touching.chain(&self.floors).map(|i| self.skins[*i as usize].thickness);
        (self.thinnest, self.thickest) = thicknesses
            .fold((f64::INFINITY, 0.0), |(least, most): (f64, f64), d| (least.min(d), most.max(d)));
    }

    /// Keeps pairs from touching: of bodies, named by their centres, and of particles with bodies.
    pub(crate) fn with_joined(mut self, pairs: impl Iterator<Item = [usize; 2]>) -> Self {
        let pairs = pairs.map(|[a, b]| [a.min(b) as u32, a.max(b) as u32]);
        self.joined.extend(pairs);
        self.joined.sort_unstable();
        self
    }

    /// Returns the number of particles, which are the first vertices.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.particles
    }

    /// Returns the number of vertices: of particles and of points of obstacles.
    #[must_use]
    pub fn vertices(&self) -> usize {
        self.skins.len()
    }

    /// Returns the particle, rigid body or obstacle to which a vertex belongs.
    #[must_use]
    pub fn vertex(&self, vertex: u32) -> Vertex {
        let Some(mut point) = (vertex as usize).checked_sub(self.particles) else {
            let particle = Vertex::Particle(vertex as usize);
            return self.solid(vertex).map_or(particle, Vertex::Body);
        };
        let mut k = 0;
        while k + 1 < self.anchors.len() && point >= self.anchors[k].len() {
            point -= self.anchors[k].len();
            k += 1;
        }
        Vertex::Obstacle(k)
    }

    /// Returns the triangles of bodies and of obstacles.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        let obstacles = self.obstacles.triangles();
        self.bodies.triangles().iter().chain(obstacles).copied()
    }

    /// Returns the edges of bodies and of obstacles, the lower end first.
    pub fn edges(&self) -> impl Iterator<Item = [u32; 2]> {
        let edges = self.bodies.edges.iter().chain(&self.obstacles.edges).chain(&self.flat.edges);
        edges.copied().filter(|[a, b]| a != b)
    }

    /// Returns whether damping acts anywhere.
    pub(super) fn is_damped(&self) -> bool {
        let takes = |skin: &Skin| skin.damping > 0.0 || skin.restitution > 0.0;
        self.skins.iter().any(takes)
    }

    /// Returns the rigid bodies.
    pub(super) fn rigid(&self) -> &[Body] {
        &self.rigid
    }

    /// Returns the number of the rigid body to which a vertex belongs, if it belongs to one.
    pub(super) fn solid(&self, vertex: u32) -> Option<usize> {
        let solid = self.solids.get(vertex as usize).copied().unwrap_or(0);
        (solid > 0).then(|| solid as usize - 1)
    }

    /// Returns whether two primitives, given by their vertices, do not touch: on the same rigid
    /// body, where a joint joins them, or as a fluid and a rigid body.
    pub(super) fn are_one(&self, a: &[u32], b: &[u32]) -> bool {
        if self.solids.is_empty() && self.joined.is_empty() {
            return false;
        }
        let solids = [self.solid(a[0]), self.solid(b[0])];
        let is_drop = |i: u32| self.drops.vertices.binary_search(&i).is_ok();
        match solids {
            [Some(a), Some(b)] if a == b => return true,
            [None, Some(_)] if is_drop(a[0]) => return true,
            _ => {}
        }
        let owner = |i: u32| self.solid(i).map_or(i, |k| self.rigid[k].center() as u32);
        let joined = |[i, j]: [u32; 2]| self.joined.binary_search(&[i.min(j), i.max(j)]).is_ok();
        !self.joined.is_empty()
            && (a.iter()).any(|i| b.iter().any(|j| joined([owner(*i), owner(*j)])))
    }

    /// Returns the least thickness that is not 0 (m); infinite without any.
    pub(super) fn least_thickness(&self) -> f64 {
        let all = self.skins.iter().map(|skin| skin.thickness);
        all.filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min)
    }

    /// Returns the largest thickness (m).
    pub(crate) fn thickest(&self) -> f64 {
        self.thickest
    }

    /// Returns whether friction acts anywhere.
    pub(super) fn is_rough(&self) -> bool {
        self.skins.iter().any(|skin| skin.friction > 0.0 || skin.rolling > 0.0)
    }

    /// Returns whether anything is rigid or elastic.
    pub(super) fn is_rigid_or_elastic(&self) -> bool {
        !self.rigid.is_empty() || self.skins.iter().any(|skin| skin.restitution > 0.0)
    }

    /// Returns whether a side of a pair is rigid, or the pair elastic.
    pub(super) fn is_rigid_or_elastic_pair(&self, kind: PairKind, points: &[u32; 4]) -> bool {
        let sides = [points[0], points[kind.first()]];
        sides.iter().any(|i| self.solid(*i).is_some() || self.skins[*i as usize].restitution > 0.0)
    }

    /// Returns the gap beyond their thickness (m) below which surfaces may come nearer than the
    /// distance that they keep.
    pub(super) fn nearest(&self) -> f64 {
        2.0 * KEPT_SHARE * self.thickest - self.thinnest
    }

    /// Returns the radius of a vertex (m): 0 except for those of round obstacles and bodies.
    pub(super) fn radius(&self, vertex: u32) -> f64 {
        self.radii[vertex as usize]
    }

    /// Returns the contact law between the primitives of a pair.
    pub(super) fn law(&self, kind: PairKind, points: &[u32; 4]) -> Law {
        let [a, b] = [points[0], points[kind.first()]].map(|i| self.skins[i as usize]);
        let mut skin = Skin {
            thickness: self.thickness(kind, points),
            stiffness: a.stiffness.min(b.stiffness),
            damping: a.damping.max(b.damping),
            friction: a.friction.max(b.friction),
            rolling: a.rolling.max(b.rolling),
            restitution: a.restitution.max(b.restitution),
            mass: 1.0 / (a.mass.recip() + b.mass.recip()),
        };
        // The speed at which the repulsion alone stops a body at gap 0.
        let restitution = skin.restitution;
        let (stopped, is_dull) = if self.is_rigid_or_elastic_pair(kind, points) {
            let is_hard = |k: usize| self.is_hard(points[k]);
            (
                skin.thickness * (skin.stiffness / (2.0 * skin.mass)).sqrt(),
                restitution.powi(2) <= TURNING_LOSS && is_hard(0) && is_hard(kind.first()),
            )
        } else {
            (f64::INFINITY, false)
        };
        if is_dull {
            skin.restitution = 0.0;
        } else if restitution > 0.0 {
            skin.damping = 1.0 / (TURN_SHARE * stopped);
        }
        Law { skin, stopped, is_dull, restitution, radius: self.radii(kind, points) }
    }

    /// Returns the thickness of a pair (m).
    pub(super) fn thickness(&self, kind: PairKind, points: &[u32; 4]) -> f64 {
        let [a, b] = [points[0], points[kind.first()]].map(|i| self.skins[i as usize].thickness);
        0.5 * (a + b)
    }

    /// Returns the distance (m) up to which a pair touches.
    pub(super) fn reach(&self, kind: PairKind, points: &[u32; 4]) -> f64 {
        self.thickness(kind, points) + self.radii(kind, points)
    }

    /// Bounds the rounding errors of distances (m).
    pub(super) fn rounding(&self) -> f64 {
        ROUNDING_SHARE * self.thickest
    }

    /// Sums the radii of a pair (m).
    pub(super) fn radii(&self, kind: PairKind, points: &[u32; 4]) -> f64 {
        self.radius(points[0]) + self.radius(points[kind.first()])
    }

    /// Writes positions (m) of all vertices at time t (s), with particles at x, n x 3.
    pub(super) fn place(
        &self,
        obstacles: &[Obstacle],
        t: f64,
        x: &[f64],
        out: &mut Vec<Vector3<f64>>,
    ) {
        particles_of(x, out);
        self.each_anchor(obstacles, t, |place| out.push(place.position));
    }

    /// Writes velocities (m/s) of all vertices at time t (s), with those of particles in v, n x 3.
    pub(super) fn speeds(
        &self,
        obstacles: &[Obstacle],
        t: f64,
        v: &[f64],
        out: &mut Vec<Vector3<f64>>,
    ) {
        particles_of(v, out);
        self.each_anchor(obstacles, t, |place| out.push(place.velocity));
    }

    /// Visits the place of each point of obstacles at time t (s).
    fn each_anchor(&self, obstacles: &[Obstacle], t: f64, mut visit: impl FnMut(Place)) {
        for (points, obstacle) in self.anchors.iter().zip(obstacles) {
            let pose = obstacle.at(t);
            for point in points {
                visit(pose.of(*point));
            }
        }
    }
}

/// Writes the rows of an n x 3 matrix to `out`, replacing its contents.
fn particles_of(x: &[f64], out: &mut Vec<Vector3<f64>>) {
    let n = x.len() / 3;
    let (xs, ys, zs) = (&x[..n], &x[n..2 * n], &x[2 * n..]);
    out.clear();
    out.extend((0..n).map(|i| Vector3::new(xs[i], ys[i], zs[i])));
}

/// Vertices, edges and triangles of bodies or of obstacles, or the drops of a fluid.
#[derive(Clone, Debug, Default)]
pub(super) struct Items {
    /// Corners of the triangles, and then of those edges and points that are in none of them. The
    /// last two corners of an edge are equal, and all three of a point.
    pub corners: Vec<[u32; 3]>,
    /// Number of triangles.
    triangles: usize,
    /// Rank of each of these by its corners, after those of other items.
    pub ranks: Vec<u32>,
    /// Vertices.
    pub vertices: Vec<u32>,
    /// Edges, the lower end of each first: those of triangles, and then the others. The ends of a
    /// point are equal.
    pub edges: Vec<[u32; 2]>,
    /// Number of edges of triangles.
    sides: usize,
    /// Rank of each edge by its ends, after those of other items.
    pub edge_ranks: Vec<u32>,
}

impl Items {
    /// Collects the vertices and sides of these triangles, and the edges and points that are in no
    /// triangle. Edges and points inside flat faces are left out. All rank after the items of
    /// `others`.
    pub fn new(
        triangles: impl IntoIterator<Item = [u32; 3]>,
        edges: impl IntoIterator<Item = [u32; 2]>,
        flat: &FlatFaces,
        others: &[&Self],
    ) -> Self {
        let mut items = Self::default();
        let (mut seen_vertices, mut seen_edges) = (flat.inside.clone(), flat.edges.clone());
        items.corners.extend(triangles);
        items.triangles = items.corners.len();
        for [a, b, c] in &items.corners {
            let sides = [[a, b], [b, c], [c, a]].map(|[i, j]| [*i.min(j), *i.max(j)]);
            let new = sides.into_iter().filter(|side| seen_edges.insert(*side));
            items.edges.extend(new);
        }
        items.sides = items.edges.len();
        for [a, b] in edges {
            let [a, b] = [a.min(b), a.max(b)];
            if seen_edges.insert([a, b]) {
                items.corners.push([a, b, b]);
                items.edges.push([a, b]);
            }
        }
        let all = items.corners.iter().flatten();
        let new = all.filter(|i| seen_vertices.insert(**i));
        items.vertices.extend(new);
        let before = |count: fn(&Self) -> usize| others.iter().map(|items| count(items)).sum();
        items.ranks = ranks(&items.corners, before(|items| items.corners.len()));
        items.edge_ranks = ranks(&items.edges, before(|items| items.edges.len()));
        items
    }

    /// Returns the corners of the triangles.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.corners[..self.triangles]
    }

    /// Returns whether edge k is a side of a triangle.
    pub fn is_side(&self, k: usize) -> bool {
        k < self.sides
    }
}

/// Ranks values, counted from `first`.
fn ranks<T: Ord>(values: &[T], first: usize) -> Vec<u32> {
    let mut order: Vec<_> = (0..values.len()).collect();
    order.sort_by_key(|k| &values[*k]);
    let mut ranks = vec![0; values.len()];
    for (rank, k) in order.into_iter().enumerate() {
        ranks[k] = (first + rank) as u32;
    }
    ranks
}
