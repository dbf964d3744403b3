//! Tests of the lists of pairs, with all pairs one by one as the oracle.

use nalgebra::Vector3;

use super::candidates::{Candidates, Stretch};
use super::closest::{PairKind, closest};
use super::listing::Candidate;
use super::obstacle::Obstacle;
use super::shape::Shape;
use super::surface::{Skin, Surface};
use crate::path::Path;
use crate::random::SplitMix;
use crate::testing::cloth;
use crate::{Control, Grid, Model, Simulation, Touch, integrators};

/// Shares of margins and lengths of courses; the first pair are those that lists have.
const SHARES: [Option<[f64; 2]>; 4] = [None, Some([0.05, 1.0]), Some([0.5, 0.0]), Some([2.0, 9.0])];

fn skin(thickness: f64) -> Skin {
    Skin {
        thickness,
        stiffness: 40.0,
        damping: 0.5,
        friction: 0.3,
    }
}

fn obstacles() -> Vec<Obstacle> {
    let ball = Shape::Sphere { radius: 0.3 };
    let half_extents = Vector3::new(0.3, 0.2, 0.4);
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let cuboid = Shape::Box { half_extents, axes };
    let places = [
        (ball, -1.0, 0.2),
        (cuboid, 1.0, 0.05),
        (Shape::Floor, -0.9, 0.1),
    ];
    let obstacle = |(shape, height, thickness)| Obstacle {
        thickness,
        friction: 0.5,
        ..Obstacle::smooth(shape, Path::Still(Vector3::new(0.2, height, 0.0)))
    };
    places.map(obstacle).to_vec()
}

/// Keys of the pairs that are within their thickness at these positions (m), in canonical order:
/// every pair is looked at.
fn all_within(surface: &Surface, x: &[Vector3<f64>]) -> Vec<(PairKind, [u32; 4])> {
    let n = surface.particles() as u32;
    let (triangles, edges): (Vec<_>, Vec<_>) =
        (surface.triangles().collect(), surface.edges().collect());
    let vertices = surface
        .bodies
        .vertices
        .iter()
        .chain(&surface.obstacles.vertices);
    let mut pairs = vec![];
    let mut add = |kind: PairKind, points: [u32; 4]| {
        let [a, b] = [points[0], points[kind.first()]];
        let pair = Candidate { points, kind };
        let offset = closest(kind, &pair.of(x)).offset;
        let distance = if kind == PairKind::VertexFloor {
            offset.y
        } else {
            offset.norm()
        };
        let law = surface.law(kind, &points);
        if (a < n || b < n) && distance - law.radius < law.skin.thickness {
            pairs.push((kind, points));
        }
    };
    for &v in vertices {
        for &[p, q, r] in triangles.iter().filter(|corners| !corners.contains(&v)) {
            add(PairKind::VertexTriangle, [v, p, q, r]);
        }
    }
    for (k, e) in edges.iter().enumerate() {
        for f in edges[..k]
            .iter()
            .filter(|f| !e.iter().any(|i| f.contains(i)))
        {
            let ([a, b], [c, d]) = if e < f { (*e, *f) } else { (*f, *e) };
            add(PairKind::EdgeEdge, [a, b, c, d]);
        }
    }
    for &floor in &surface.floors {
        let points = surface.bodies.vertices.iter();
        points.for_each(|i| add(PairKind::VertexFloor, [*i, floor, floor, floor]));
    }
    pairs.sort_unstable();
    pairs
}

/// Two bodies of random triangles that fly about, some of whose vertices are kicked: the list gives
/// all pairs that touch on a stretch, each once and in canonical order, and at an instant those
/// that touch then, whatever its margins.
#[test]
fn lists_are_complete_and_in_order() {
    let mut random = SplitMix(7);
    let thicknesses = [0.05, 0.15];
    let skins: Vec<_> = (0..60).map(|i| skin(thicknesses[i / 30])).collect();
    let mut corner = |k: u32| 30 * (k % 2) + random.between(0.0, 30.0) as u32;
    let triangles: Vec<_> = (0..50).map(|k| [corner(k), corner(k), corner(k)]).collect();
    let distinct = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    let triangles: Vec<_> = triangles.into_iter().filter(distinct).collect();
    let obstacles = obstacles();
    let surface = Surface::new(&skins, &triangles, &[], &obstacles, true);
    let mut start = vec![];
    surface.place(&obstacles, 0.0, &[0.0; 180], &mut start);
    let mut vector = |size: f64| Vector3::from_fn(|_, _| random.between(-size, size));
    let mut v: Vec<_> = start.iter().map(|_| Vector3::zeros()).collect();
    for i in 0..60 {
        (start[i], v[i]) = (vector(1.0), vector(2.0));
    }
    let mut lists = SHARES.map(|shares| {
        let mut list = Candidates::default();
        for shares in shares {
            list.set_shares(shares);
        }
        list
    });
    let (h, mut touching) = (0.005, 0);
    for step in 0..200 {
        let t = h * f64::from(step);
        if step % 4 == 3 {
            v[step as usize % 60] += vector(30.0);
        }
        let kick = if step % 50 == 49 { 40.0 } else { 0.05 };
        v[..60]
            .iter_mut()
            .for_each(|v| *v += vector(kick) - *v * 0.02);
        let end: Vec<_> = start.iter().zip(&v).map(|(x, v)| x + v * h).collect();
        let middle: Vec<_> = start.iter().zip(&end).map(|(a, b)| (a + b) / 2.0).collect();
        let expected = all_within(&surface, &middle);
        touching += expected.len();
        for list in &mut lists {
            for (times, ends) in [
                ([t + h / 2.0; 2], [&middle; 2]),
                ([t, t + h], [&start, &end]),
            ] {
                let speeds = Some(&v[..]);
                let ends = ends.map(|x| &x[..]);
                list.cover(
                    &surface,
                    &Stretch {
                        times,
                        ends,
                        speeds,
                    },
                );
                let keys: Vec<_> = list
                    .near(0.0)
                    .map(|pair| (pair.kind, pair.points))
                    .collect();
                assert!(keys.is_sorted_by(|a, b| a < b), "step {step}");
                let missing = expected.iter().find(|key| keys.binary_search(key).is_err());
                assert_eq!(missing, None, "step {step}");
            }
        }
        start = end;
    }
    assert!(touching > 10_000, "{touching} pairs touched");
}

/// A cloth flutters against a ball and a floor: its state has the same bits whatever the margins.
#[test]
fn no_bit_depends_on_the_list() {
    let grid = Grid::new(8, 8).unwrap();
    let mut scene = cloth(grid, 0.01);
    let Model::Network(network) = &mut scene.model else {
        unreachable!("a cloth is a network")
    };
    network.set_triangles(grid.triangles()).unwrap();
    let ball = Shape::Sphere { radius: 0.3 };
    for (shape, place) in [(ball, [0.7, -0.8, 0.4]), (Shape::Floor, [0.0, -1.5, 0.0])] {
        let obstacle = Obstacle::smooth(shape, Path::Still(Vector3::from(place)));
        network.add_obstacle(obstacle).unwrap();
    }
    let touch = Touch {
        skins: vec![skin(0.05); 64],
        edges: vec![],
        bodies: true,
    };
    network.set_touch(Some(touch)).unwrap();
    let states = SHARES.map(|shares| {
        let method = integrators::find("rk4").unwrap();
        let mut run = Simulation::new(scene.clone(), method, Control::Step(2e-3)).unwrap();
        let layer = run
            .model()
            .network()
            .and_then(|network| network.contact_layer())
            .unwrap();
        layer.with_scratch(|scratch| {
            for shares in shares {
                scratch.candidates.set_shares(shares);
            }
        });
        run.advance_to(0.8).unwrap();
        assert!(run.guarded().impulse > 0.0, "nothing touched");
        run.state().to_vec()
    });
    assert!(states.iter().all(|state| *state == states[0]));
}
