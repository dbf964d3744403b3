//! Tests of the lists of pairs, against all pairs one by one.

use nalgebra::Vector3;

use super::candidates::{Candidates, Stretch};
use super::layer::ContactLayer;
use super::listing::Candidate;
use super::obstacle::Obstacle;
use super::skin::Skin;
use super::surface::Surface;
use crate::geometry::Shape;
use crate::geometry::{PairKind, closest};
use crate::path::Path;
use crate::random::SplitMix;

/// Shares of margins and lengths of courses; the first entry is the default.
const SHARES: [Option<[f64; 2]>; 4] = [None, Some([0.05, 1.0]), Some([0.5, 0.0]), Some([2.0, 9.0])];

fn skin(thickness: f64) -> Skin {
    Skin { thickness, stiffness: 40.0, damping: 0.5, friction: 0.3, ..Skin::default() }
}

fn obstacles() -> Vec<Obstacle> {
    let ball = Shape::Sphere { radius: 0.3 };
    let half_extents = Vector3::new(0.3, 0.2, 0.4);
    let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
    let cuboid = Shape::Box { half_extents, axes };
    let places = [(ball, -1.0, 0.2), (cuboid, 1.0, 0.05), (Shape::Floor, -0.9, 0.1)];
    let obstacle = |(shape, height, thickness)| Obstacle {
        thickness,
        friction: 0.5,
        ..Obstacle::smooth(shape, Path::Still(Vector3::new(0.2, height, 0.0)))
    };
    places.map(obstacle).to_vec()
}

/// Lists the keys of the pairs that are within their thickness at these positions (m), in canonical
/// order, from a check of every pair.
fn all_within(surface: &Surface, x: &[Vector3<f64>]) -> Vec<(PairKind, [u32; 4])> {
    let n = surface.particles() as u32;
    let triangles: Vec<_> = surface.triangles().collect();
    let edges = surface.bodies.edges.iter().chain(&surface.obstacles.edges);
    let edges: Vec<_> = edges.filter(|[a, b]| a != b).collect();
    let vertices = surface.bodies.vertices.iter().chain(&surface.obstacles.vertices);
    let mut pairs = vec![];
    let mut add = |kind: PairKind, points: [u32; 4]| {
        let [a, b] = [points[0], points[kind.first()]];
        let pair = Candidate { points, kind };
        let offset = closest(kind, &pair.of(x)).offset;
        let distance = if kind == PairKind::VertexFloor { offset.y } else { offset.norm() };
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
        for f in edges[..k].iter().filter(|f| !e.iter().any(|i| f.contains(i))) {
            let ([a, b], [c, d]) = if e < f { (**e, **f) } else { (**f, **e) };
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

/// Two bodies of random triangles that fly about, some of whose vertices are kicked. The list has
/// all pairs that touch during a stretch, each once and in canonical order, and at an instant those
/// that touch then, for any margins.
#[test]
#[cfg_attr(miri, ignore = "takes hours there")]
fn lists_are_complete_and_in_order() {
    let mut random = SplitMix(7);
    let thicknesses = [0.05, 0.15];
    let skins: Vec<_> = (0..60).map(|i| skin(thicknesses[i / 30])).collect();
    let mut corner = |k: u32| 30 * (k % 2) + random.between(0.0, 30.0) as u32;
    let triangles: Vec<_> = (0..50).map(|k| [corner(k), corner(k), corner(k)]).collect();
    let distinct = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
    let triangles: Vec<_> = triangles.into_iter().filter(distinct).collect();
    let obstacles = obstacles();
    let surface = Surface::new(&skins, &triangles, &[], &[], &obstacles, true);
    let mut start = vec![];
    surface.place(&obstacles, 0.0, &[0.0; 180], &mut start);
    let mut vector = |size: f64| Vector3::from_fn(|_, _| random.between(-size, size));
    let mut v: Vec<_> = start.iter().map(|_| Vector3::zeros()).collect();
    for i in 0..60 {
        (start[i], v[i]) = (vector(1.0), vector(2.0));
    }
    let mut lists = SHARES.map(|shares| {
        let mut list = Candidates::default();
        if let Some(shares) = shares {
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
        v[..60].iter_mut().for_each(|v| *v += vector(kick) - *v * 0.02);
        let end: Vec<_> = start.iter().zip(&v).map(|(x, v)| x + v * h).collect();
        let middle: Vec<_> = start.iter().zip(&end).map(|(a, b)| (a + b) / 2.0).collect();
        let expected = all_within(&surface, &middle);
        touching += expected.len();
        for list in &mut lists {
            for (times, ends) in [([t + h / 2.0; 2], [&middle; 2]), ([t, t + h], [&start, &end])] {
                let speeds = Some(&v[..]);
                let ends = ends.map(|x| &x[..]);
                list.cover(&surface, &Stretch { times, ends, speeds });
                let keys: Vec<_> = list.near(0.0).map(|pair| (pair.kind, pair.points)).collect();
                assert!(keys.is_sorted_by(|a, b| a < b), "step {step}");
                let missing = expected.iter().find(|key| keys.binary_search(key).is_err());
                assert_eq!(missing, None, "step {step}");
            }
        }
        start = end;
    }
    assert!(touching > 10_000, "{touching} pairs touched");
}

/// Forces on triangles that fly about are bitwise equal for any margins of the list.
#[test]
#[cfg_attr(miri, ignore = "takes hours there")]
fn no_bit_depends_on_the_list() {
    let triangles: Vec<[u32; 3]> = (0..20).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
    let surface = Surface::new(&[skin(0.2); 60], &triangles, &[], &[], &obstacles(), true);
    let mut random = SplitMix(7);
    let start: Vec<f64> = (0..180).map(|_| random.between(-0.8, 0.8)).collect();
    let v: Vec<f64> = (0..180).map(|_| random.between(-2.0, 2.0)).collect();
    let forces = SHARES.map(|shares| {
        let layer = ContactLayer::new(surface.clone(), obstacles());
        layer.scratch.lend(|buffers| {
            if let Some(shares) = shares {
                buffers.candidates.set_shares(shares);
            }
        });
        let mut all = vec![];
        for step in 0..100 {
            let t = 0.005 * f64::from(step);
            let x: Vec<f64> = start.iter().zip(&v).map(|(x, v)| x + v * t).collect();
            let mut f = vec![0.0; 180];
            layer.add_repulsion(t, &x, &v, &mut f);
            all.extend(f);
        }
        all
    });
    assert!(forces[0].iter().any(|f| *f != 0.0), "nothing touched");
    assert!(forces.iter().all(|f| *f == forces[0]));
}

/// An instant after the end of a list's courses needs no other list where nothing has moved since
/// the list was used, as where a step begins; it needs one where a vertex has.
#[test]
fn a_list_serves_the_beginning_of_the_next_step() {
    let surface = Surface::new(&[skin(0.1); 6], &[[0, 1, 2], [3, 4, 5]], &[], &[], &[], true);
    let at = |i: usize, height: f64| Vector3::new((i % 3) as f64, height, f64::from(i % 3 == 1));
    let (h, speeds) = (0.02, [Vector3::y(); 6]);
    let mut list = Candidates::default();
    let mut cover = |times: [f64; 2], rises: [f64; 2], kick: f64| {
        let place = |i: usize, rise: f64| at(i, rise + [0.01, 0.0, 0.0, 0.0, 0.0, kick][i]);
        let ends = rises.map(|rise| (0..6).map(|i| place(i, rise)).collect::<Vec<_>>());
        let stretch = Stretch { times, ends: [&ends[0], &ends[1]], speeds: Some(&speeds) };
        list.cover(&surface, &stretch);
        (list.begin, list.near(0.0).count())
    };
    let (begin, count) = cover([1.0, 2.0], [0.0, h], 0.0);
    assert!(begin == 1.0 && count > 0);
    assert_eq!(cover([3.0; 2], [h; 2], 0.0), (begin, count));
    assert!(cover([4.0; 2], [h; 2], 1.0).0 > begin);
}
