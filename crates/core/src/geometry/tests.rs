//! Closed meshes of several parts.

use nalgebra::Vector3;

use super::ClosedMesh;
use crate::random::SplitMix;

/// Creates a box between two corners, as points and triangles whose corners count from `first`.
fn cuboid(low: [f64; 3], high: [f64; 3], first: u32) -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
    let points = (0..8).map(|k| Vector3::from_fn(|axis, _| [low, high][k >> axis & 1][axis]));
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = faces.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]);
    let triangles = halves.map(|t| t.map(|i: u32| i + first));
    (points.collect(), triangles.collect())
}

/// Creates one mesh of boxes, some of them inside out, with equal points merged.
fn boxes(of: &[([f64; 3], [f64; 3], bool)]) -> ClosedMesh {
    let (mut points, mut triangles): (Vec<Vector3<f64>>, Vec<[u32; 3]>) = (vec![], vec![]);
    for (low, high, is_turned) in of {
        let (own, sides) = cuboid(*low, *high, 0);
        let places: Vec<_> = own
            .into_iter()
            .map(|p| {
                points.iter().position(|q| *q == p).unwrap_or_else(|| {
                    points.push(p);
                    points.len() - 1
                }) as u32
            })
            .collect();
        triangles.extend(sides.iter().map(|t| {
            let [a, b, c] = t.map(|i| places[i as usize]);
            if *is_turned { [a, c, b] } else { [a, b, c] }
        }));
    }
    ClosedMesh::new(points, triangles).unwrap()
}

/// Returns the distance of a point from a box, below 0 inside.
fn distance(low: [f64; 3], high: [f64; 3], d: Vector3<f64>) -> f64 {
    let beyond = Vector3::from_fn(|k, _| (low[k] - d[k]).max(d[k] - high[k]));
    let outside = beyond.map(|x| x.max(0.0)).norm();
    if outside > 0.0 { outside } else { beyond.max() }
}

fn random_point(random: &mut SplitMix) -> Vector3<f64> {
    Vector3::from_fn(|_, _| random.between(0.01, 3.99))
}

/// Points in any of the boxes are inside, whether these overlap, touch or wind clockwise, and are
/// moved out of all of them.
#[test]
fn parts_decide_by_themselves_what_is_inside() {
    let corner = ([0.0; 3], [4.0; 3]);
    for (what, second) in [
        ("overlap", ([1.0, 1.0, 1.0], [6.0, 3.0, 2.5])),
        ("a corner in common", ([4.0; 3], [5.0; 3])),
        ("an edge in common", ([4.0, 4.0, 0.0], [6.0, 6.0, 4.0])),
        ("a side in common", ([4.0, 0.0, 0.0], [6.0, 4.0, 4.0])),
        ("apart", ([5.0, 0.0, 0.0], [6.0, 1.0, 1.0])),
        ("the same", corner),
        ("within", ([1.0; 3], [2.0; 3])),
    ] {
        // A reversed box within another is a hole.
        for turned in [[false, false], [true, true], [false, true], [true, false]] {
            if turned[0] != turned[1] && what != "overlap" && what != "apart" {
                continue;
            }
            let mesh = boxes(&[(corner.0, corner.1, turned[0]), (second.0, second.1, turned[1])]);
            let mut random = SplitMix(3);
            for _ in 0..500 {
                let d = random_point(&mut random) * 1.5 - Vector3::repeat(0.5);
                let least = distance(corner.0, corner.1, d).min(distance(second.0, second.1, d));
                let found = mesh.nearest(d);
                assert_eq!(found.is_some(), least < 0.0, "{what} {turned:?} {d}");
                if let Some(found) = found {
                    let out = |(low, high)| distance(low, high, found.point) > -1e-12;
                    assert!(out(corner) && out(second), "{what} {d} {}", found.point);
                    let separation = mesh.separation(d);
                    assert!(
                        (separation.distance - least).abs() < 1e-12,
                        "{what} {separation:?} {least}"
                    );
                }
            }
        }
    }
}

/// A hole stays a hole, a solid in it a solid, and a box in a box of the same orientation is no
/// hole.
#[test]
fn holes_are_outside() {
    let at = |low: f64| ([low; 3], [4.0 - low; 3]);
    let (whole, hole, core) = (at(0.0), at(0.5), at(1.5));
    for turned in [false, true] {
        let mesh = boxes(&[
            (core.0, core.1, turned),
            (hole.0, hole.1, !turned),
            (whole.0, whole.1, turned),
        ]);
        let mut random = SplitMix(4);
        for _ in 0..500 {
            let d = random_point(&mut random);
            let [whole, hole, core] = [whole, hole, core].map(|(low, high)| distance(low, high, d));
            let is_inside = whole < 0.0 && hole > 0.0 || core < 0.0;
            assert_eq!(mesh.nearest(d).is_some(), is_inside, "{d}");
            let expected = [whole, hole, core].map(f64::abs).into_iter().fold(9.0, f64::min);
            let separation = mesh.separation(d);
            assert!((separation.distance.abs() - expected).abs() < 1e-12);
            assert_eq!(separation.distance < 0.0, is_inside);
        }
    }
}

/// Each part gets its own copy of shared points.
#[test]
fn parts_have_their_own_points() {
    let count = |second: ([f64; 3], [f64; 3])| {
        let mesh = boxes(&[([0.0; 3], [4.0; 3], false), (second.0, second.1, false)]);
        assert_eq!(mesh.edges().len(), 36);
        (mesh.points().len(), mesh.normals().iter().all(|n| (n.norm() - 1.0).abs() < 1e-12))
    };
    assert_eq!(count(([4.0; 3], [5.0; 3])), (16, true));
    assert_eq!(count(([4.0, 0.0, 0.0], [6.0, 4.0, 4.0])), (16, true));
}
