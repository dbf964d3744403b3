//! Parts of a scene: bodies that are drawn as a surface, with their looks and their sharp edges,
//! and springs and particles that are drawn one by one.

use std::sync::Arc;

use a3_core::{Network, Simulation, Spring, SpringKind, Vector3};
use a3_render::{STEEL_LOOK, Spring as Drawn, Topology};
use a3_scenes::{Presentation, Surface};

use super::colours::INK;
use super::obstacles;
use super::springs::{KINDS, kind_look};
use crate::surfaces::whole_triangles;

/// Parts of a scene, which change only with the scene or when something tears.
#[derive(Clone, Default)]
pub struct Parts {
    presentation: Arc<Presentation>,
    /// Number of broken springs when the parts were found; `None` before.
    tears: Option<usize>,
    /// Look of each body.
    looks: Vec<f32>,
    /// Springs that are drawn one by one.
    loose: Vec<Spring>,
    /// Particles that are drawn one by one.
    single: Vec<usize>,
    /// Particles that were torn out of a body with a surface.
    crumbs: Vec<usize>,
    /// Kinds of springs in the scene.
    kinds: Vec<SpringKind>,
}

impl Parts {
    /// Finds the parts again if the scene has changed or something has torn.
    pub fn update(&mut self, presentation: &Arc<Presentation>, simulation: &Simulation) {
        let (surface, tears) = (&presentation.surface, Some(simulation.tears()));
        let known = Arc::ptr_eq(presentation, &self.presentation);
        if known && tears == self.tears {
            return;
        }
        if !known || self.tears.is_none() {
            self.looks = looks(surface);
        }
        (self.presentation, self.tears) = (presentation.clone(), tears);
        let is_there = |kind: &SpringKind| springs(simulation).any(|s| s.kind == *kind);
        self.kinds = KINDS.into_iter().filter(is_there).collect();
        let springs = springs(simulation);
        self.loose = springs.filter(|s| body(surface, s).is_none()).collect();
        let network = simulation.model().network();
        let is_rigid = |i: &usize| network.is_some_and(|n| n.body_of(*i).is_some());
        let uncovered = surface.particles()..simulation.particles();
        self.single = uncovered.filter(|i| !is_rigid(i)).collect();
        self.crumbs = network.map_or(vec![], |network| crumbs(network, surface));
    }

    /// Returns the springs of particles without a surface, and the springs between bodies.
    pub fn loose(&self) -> &[Spring] {
        &self.loose
    }

    /// Returns the particles without a surface that belong to no rigid body.
    pub fn single(&self) -> &[usize] {
        &self.single
    }

    /// Returns the particles that were torn out of a body with a surface.
    pub fn crumbs(&self) -> &[usize] {
        &self.crumbs
    }

    /// Returns the kinds of springs in the scene, in the order in which they are drawn.
    pub fn kinds(&self) -> &[SpringKind] {
        &self.kinds
    }

    /// Sets the look of each particle of a body.
    pub fn paint(&self, points: &mut [[f32; 4]]) {
        let mut start = 0;
        for (look, &end) in self.looks.iter().zip(&self.presentation.surface.bodies) {
            for point in &mut points[start..end] {
                point[3] = *look;
            }
            start = end;
        }
    }
}

/// Returns the particles of a surface that lost all their springs.
fn crumbs(network: &Network, surface: &Surface) -> Vec<usize> {
    let mut ends: Vec<_> = network.torn().iter().flatten().copied().collect();
    if ends.is_empty() {
        return ends;
    }
    let mut holds = vec![false; network.particles()];
    for spring in network.all_springs() {
        (holds[spring.i], holds[spring.j]) = (true, true);
    }
    ends.sort_unstable();
    ends.dedup();
    ends.retain(|i| *i < surface.particles() && !holds[*i]);
    ends
}

/// Returns a look for each body. Looks before that of steel are for cloth in their first half, and
/// for closed surfaces such as jelly in their second half.
fn looks(surface: &Surface) -> Vec<f32> {
    let mut edges: Vec<_> = surface
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
        .map(|(a, b)| (a.min(b), a.max(b)))
        .collect();
    edges.sort_unstable();
    let borders: Vec<_> = edges
        .chunk_by(|a, b| a == b)
        .filter(|triangles| triangles.len() == 1)
        .map(|border| border[0].0 as usize)
        .collect();
    let (mut start, half) = (0, STEEL_LOOK / 2);
    let look = |(k, &end): (usize, &usize)| {
        let from = borders.partition_point(|i| *i < start);
        let closed = borders.get(from).is_none_or(|i| *i >= end);
        start = end;
        (k % half + if closed { half } else { 0 }) as f32
    };
    surface.bodies.iter().enumerate().map(look).collect()
}

/// Returns the body to whose surface both ends of the spring belong, if there is one.
fn body(surface: &Surface, spring: &Spring) -> Option<usize> {
    let [a, b] = [spring.i, spring.j].map(|i| surface.bodies.partition_point(|end| *end <= i));
    (a == b && a < surface.bodies.len()).then_some(a)
}

/// Returns all springs.
fn springs(simulation: &Simulation) -> impl Iterator<Item = Spring> {
    let network = simulation.model().network();
    network.into_iter().flat_map(Network::all_springs)
}

/// Returns the triangles and wires, which stay the same from frame to frame until something tears.
/// Parts without a surface are drawn by balls and coils instead. Meshes of obstacles come last.
pub fn topology(surface: &Surface, simulation: &Simulation) -> Topology {
    let mut topology = Topology {
        points: simulation.particles(),
        triangles: whole_triangles(simulation).collect(),
        wires: springs(simulation)
            .filter(|s| s.kind == SpringKind::Structural && body(surface, s).is_some())
            .map(|s| [s.i as u32, s.j as u32])
            .collect(),
        ..Topology::default()
    };
    let structural = topology.wires.len();
    add_edges(&mut topology, surface);
    let network = simulation.model().network();
    for (mesh, first) in network.into_iter().flat_map(obstacles::meshes_of_bodies) {
        let of = |i: &u32| first as u32 + i;
        let triangles = mesh.triangles().iter().map(|t| t.each_ref().map(of));
        topology.triangles.extend(triangles);
        let edges = mesh.edges().iter().map(|e| e.each_ref().map(of));
        topology.wires.extend(edges);
    }
    for (mesh, _) in network.into_iter().flat_map(obstacles::meshes) {
        let first = topology.points as u32;
        let triangles = mesh.triangles().iter();
        topology.triangles.extend(triangles.map(|t| t.map(|i| first + i)));
        let edges = mesh.edges().iter();
        topology.wires.extend(edges.map(|e| e.map(|i| first + i)));
        topology.points += mesh.points().len();
    }
    add_springs(&mut topology, structural, surface, simulation);
    let places = places_of_closed(surface, simulation, topology.points);
    split(&mut topology, &places);
    topology
}

/// Returns the places at rest (m) of the points of closed surfaces; `None` for other points.
fn places_of_closed(
    surface: &Surface,
    simulation: &Simulation,
    points: usize,
) -> Vec<Option<Vector3<f64>>> {
    let mut places = vec![None; points];
    let (state, n) = (&simulation.scene().state, simulation.particles());
    let mut start = 0;
    for (look, &end) in looks(surface).iter().zip(&surface.bodies) {
        if *look as usize >= STEEL_LOOK / 2 {
            for (i, place) in (start..end).zip(&mut places[start..end]) {
                *place = Some(Vector3::new(state[i], state[n + i], state[2 * n + i]));
            }
        }
        start = end;
    }
    let network = simulation.model().network();
    let bodies = network.into_iter().flat_map(obstacles::meshes_of_bodies);
    let mut next = n;
    let obstacles = network.into_iter().flat_map(obstacles::meshes);
    let obstacles = obstacles.map(|(mesh, _)| {
        let first = next;
        next += mesh.points().len();
        (mesh, first)
    });
    for (mesh, first) in bodies.chain(obstacles) {
        for (place, point) in places[first..].iter_mut().zip(mesh.points()) {
            *place = Some(*point);
        }
    }
    places
}

/// Adds the edges of the triangles of bodies that have no wires, such as solids.
fn add_edges(topology: &mut Topology, surface: &Surface) {
    let of = |i: u32| surface.bodies.partition_point(|end| *end <= i as usize);
    let mut wired = vec![false; surface.bodies.len() + 1];
    topology.wires.iter().for_each(|[i, _]| wired[of(*i)] = true);
    let triangles = topology.triangles.iter();
    let bare = triangles.filter(|[a, _, _]| !wired[of(*a)]);
    let mut edges: Vec<_> = bare
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[a, b]| [a.min(b), a.max(b)])
        .collect();
    edges.sort_unstable();
    edges.dedup();
    topology.wires.extend(edges);
}

/// Adds the springs of bodies with a surface, in the order in which kinds are drawn, and the wires
/// that are no springs: those after the first `structural`.
fn add_springs(
    topology: &mut Topology,
    structural: usize,
    surface: &Surface,
    simulation: &Simulation,
) {
    let edges = topology.wires[structural..].iter();
    topology.springs = edges
        .map(|ends| line_of(*ends, (INK, 1.35)))
        .chain(KINDS.into_iter().flat_map(|kind| {
            let of_kind = move |s: &Spring| s.kind == kind && body(surface, s).is_some();
            springs(simulation)
                .filter(of_kind)
                .map(move |s| line_of([s.i as u32, s.j as u32], kind_look(kind)))
        }))
        .collect();
}

/// Returns a spring or an edge with a colour and width (points).
fn line_of(ends: [u32; 2], ([r, g, b, _], width): ([f32; 4], f32)) -> Drawn {
    Drawn { ends, width, color: [r, g, b] }
}

/// Cosine of the largest angle between the normals of two triangles that are smooth at their common
/// point (40 degrees).
const MIN_COSINE: f64 = 0.766;

/// Splits the points at which the surface has a sharp edge. `places` are the places of the points
/// at rest (m), `None` for those of surfaces that have no sharp edges, such as cloth.
pub fn split(topology: &mut Topology, places: &[Option<Vector3<f64>>]) {
    let normal = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|i| places[i as usize]);
        let (a, b, c) = (a?, b?, c?);
        (b - a).cross(&(c - a)).try_normalize(0.0)
    };
    let normals: Vec<_> = topology.triangles.iter().map(normal).collect();
    let mut corners: Vec<_> = (0..topology.triangles.len())
        .filter(|t| normals[*t].is_some())
        .flat_map(|t| (0..3).map(move |k| (t, k)))
        .collect();
    corners.sort_by_key(|(t, k)| topology.triangles[*t][*k]);
    let of = |(t, k): &(usize, usize)| topology.triangles[*t][*k];
    let around: Vec<Vec<_>> = corners.chunk_by(|a, b| of(a) == of(b)).map(<[_]>::to_vec).collect();
    for corners in around {
        let smooth = |a: usize, b: usize| match (normals[a], normals[b]) {
            (Some(a), Some(b)) => a.dot(&b) > MIN_COSINE,
            _ => false,
        };
        let groups = groups(corners.len(), |a, b| smooth(corners[a].0, corners[b].0));
        if groups.iter().all(|group| *group == 0) {
            continue;
        }
        let (t, k) = corners[0];
        let point = topology.triangles[t][k];
        let first = topology.points + topology.splits.len();
        let count = groups.iter().max().map_or(0, |last| last + 1);
        topology.splits.extend(std::iter::repeat_n(point, count));
        for ((t, k), group) in corners.into_iter().zip(groups) {
            topology.triangles[t][k] = (first + group) as u32;
        }
    }
}

/// Returns the number of the group of each of `count` items: those that are joined, also by way of
/// others, are in one group. Groups are numbered from 0 in the order of their first items.
fn groups(count: usize, joined: impl Fn(usize, usize) -> bool) -> Vec<usize> {
    let mut of = vec![usize::MAX; count];
    let mut next = 0;
    for start in 0..count {
        if of[start] != usize::MAX {
            continue;
        }
        let mut open = vec![start];
        of[start] = next;
        while let Some(item) = open.pop() {
            for (other, group) in of.iter_mut().enumerate() {
                if *group == usize::MAX && joined(item, other) {
                    *group = next;
                    open.push(other);
                }
            }
        }
        next += 1;
    }
    of
}

#[cfg(test)]
mod tests {
    use a3_core::{Control, integrators};

    use super::*;

    fn run(scene: &str) -> (Simulation, Arc<Presentation>) {
        let setup = a3_scenes::find(scene).unwrap().build(None).unwrap();
        let (method, control) = (integrators::find("t").unwrap(), Control::Step(0.01));
        let simulation = Simulation::new(setup.scene, method, control).unwrap();
        (simulation, setup.presentation)
    }

    #[test]
    fn cloth_is_red_and_jelly_is_green() {
        for (scene, look, loose) in [("cloth", 0.0, 0), ("jelly", 4.0, 0), ("chain", 0.0, 3)] {
            let ((simulation, presentation), mut parts) = (run(scene), Parts::default());
            parts.update(&presentation, &simulation);
            let mut points = vec![[0.0; 4]; simulation.particles()];
            parts.paint(&mut points);
            assert!(points.iter().all(|p| p[3] == look), "{scene}");
            assert_eq!(parts.loose().len(), loose, "{scene}");
        }
    }

    /// A particle whose springs are all torn is drawn by itself, and one that holds is not.
    #[test]
    fn what_is_torn_out_is_seen() {
        let mut description = a3_scenes::find("flag").unwrap().description().unwrap();
        let (whole, _) = run("flag");
        let network = whole.model().network().unwrap();
        let pairs = |i| network.springs_of(i).map(|s| [s.i.min(s.j), s.i.max(s.j)]);
        description.torn = pairs(20).chain(pairs(70).skip(1)).collect();
        let setup = description.build(None, &mut |_| Err("no file".into())).unwrap();
        let (method, control) = (integrators::find("t").unwrap(), Control::Step(0.001));
        let simulation = Simulation::new(setup.scene, method, control).unwrap();
        let mut parts = Parts::default();
        parts.update(&setup.presentation, &simulation);
        assert_eq!(parts.crumbs(), [20]);
    }

    /// Returns the number of edges of a closed surface.
    fn edges_of_closed(simulation: &Simulation) -> usize {
        3 * whole_triangles(simulation).count() / 2
    }

    #[test]
    fn all_springs_are_there_by_kind() {
        for (scene, kinds) in
            [("cloth", [720, 722, 760].as_slice()), ("jelly", &[]), ("cantilever", &[0, 0, 0])]
        {
            let (simulation, presentation) = run(scene);
            let Topology { springs, wires, .. } = topology(&presentation.surface, &simulation);
            let count = |kind: SpringKind| {
                let ([r, g, b, _], width) = kind_look(kind);
                let look = |s: &&Drawn| s.color == [r, g, b] && s.width == width;
                springs.iter().filter(look).count()
            };
            let network = simulation.model().network().unwrap();
            let counts = KINDS.map(count);
            assert_eq!(counts.iter().sum::<usize>(), network.all_springs().count());
            let structural = counts[2];
            if structural > 0 {
                assert_eq!(structural, wires.len(), "{scene}: they are the wires");
            } else {
                assert_eq!(wires.len(), edges_of_closed(&simulation), "{scene}");
            }
            if !kinds.is_empty() {
                assert_eq!(counts, kinds, "{scene}");
            }
            assert!(springs.is_sorted_by_key(|s| s.width != 2.0 * 1.6), "{scene}");
        }
    }

    /// The edges of boxes are sharp: a corner has three sides, an edge has two. Cloth has no edges.
    #[test]
    fn boxes_are_split_along_their_edges() {
        for (scene, [a, b, c]) in [("jelly", [7, 7, 7]), ("cantilever", [7, 3, 3])] {
            let (simulation, presentation) = run(scene);
            let Topology { splits, .. } = topology(&presentation.surface, &simulation);
            let along_edges = 4 * (a + b + c - 6);
            assert_eq!(splits.len(), 3 * 8 + 2 * along_edges, "{scene}");
        }
        let (simulation, presentation) = run("cloth");
        assert!(topology(&presentation.surface, &simulation).splits.is_empty());
    }

    /// Two squares of two triangles beside a tetrahedron, and a particle that belongs to none.
    #[test]
    fn every_body_has_its_look() {
        let triangles = vec![
            [0, 1, 2],
            [2, 1, 3],
            [4, 5, 6],
            [4, 6, 7],
            [4, 7, 5],
            [5, 7, 6],
            [8, 9, 10],
            [10, 9, 11],
        ];
        let surface = Surface { triangles, bodies: vec![4, 8, 12] };
        assert_eq!(looks(&surface), [0.0, 5.0, 2.0]);
        let spring = |i, j| Spring {
            i,
            j,
            ..run("chain").0.model().network().unwrap().springs().next().unwrap()
        };
        let bodies = [(0, 3), (3, 4), (4, 7), (11, 12), (8, 11)];
        let found = bodies.map(|(i, j)| body(&surface, &spring(i, j)));
        assert_eq!(found, [Some(0), None, Some(1), None, Some(2)]);
    }

    /// Returns a roof of two slopes, at an angle of 90 degrees or nearly flat.
    fn roof(height: f64) -> Topology {
        let places = [
            [-1.0, 0.0, 0.0],
            [-1.0, 0.0, 1.0],
            [0.0, height, 0.0],
            [0.0, height, 1.0],
            [1.0, 0.0, 0.0],
            [1.0, 0.0, 1.0],
        ];
        let places = places.map(|place| Some(Vector3::from(place)));
        let mut topology = Topology {
            points: 6,
            triangles: vec![[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]],
            ..Topology::default()
        };
        split(&mut topology, &places);
        topology
    }

    #[test]
    fn points_are_split_at_sharp_edges_only() {
        let flat = roof(0.1);
        assert_eq!(flat.triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]]);
        assert_eq!(flat.splits, [0; 0]);
        let steep = roof(1.0);
        assert_eq!(steep.splits, [2, 2, 3, 3]);
        assert_eq!(steep.triangles, [[0, 1, 6], [6, 1, 8], [7, 9, 4], [4, 9, 5]]);
    }

    #[test]
    fn surfaces_without_places_stay_whole() {
        let mut topology = roof(1.0);
        let triangles = vec![[0, 1, 2], [2, 1, 3], [2, 3, 4], [4, 3, 5]];
        (topology.triangles, topology.splits) = (triangles.clone(), vec![]);
        split(&mut topology, &[None; 6]);
        assert_eq!((topology.triangles, topology.splits), (triangles, vec![]));
    }
}
