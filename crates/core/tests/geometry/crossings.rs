//! Edges that cross triangles, against integer arithmetic and known cases.

use super::random::Random;
use a3_core::Vector3;
use a3_core::contact::{Crossing, crossings};
use std::collections::BTreeSet;

type Point = [i64; 3];

/// All edges of triangles, once each.
fn edges_of(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let sides = triangles.iter().flat_map(|[a, b, c]| [[*a, *b], [*b, *c], [*c, *a]]);
    let edges: BTreeSet<_> = sides.map(|[a, b]| [a.min(b), a.max(b)]).collect();
    edges.into_iter().collect()
}

/// Triangles of a grid of n x n points.
fn cloth(n: u32) -> Vec<[u32; 3]> {
    let corner = |k: u32| k / (n - 1) * n + k % (n - 1);
    let cells = (0..(n - 1) * (n - 1)).map(corner);
    cells.flat_map(|a| [[a, a + 1, a + n], [a + 1, a + n + 1, a + n]]).collect()
}

/// Column-major coordinates of points.
fn columns(points: &[Point]) -> Vec<f64> {
    (0..3).flat_map(|axis| points.iter().map(move |x| x[axis] as f64)).collect()
}

fn minus(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[k] - b[k])
}

fn cross(a: Point, b: Point) -> Point {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

/// Whether no axis separates an edge from a triangle, in integer arithmetic. The axes are
/// differences of their points, their cross products, and cross products of those with the
/// differences.
fn meet(edge: &[Point], triangle: &[Point]) -> bool {
    let all: Vec<Point> = edge.iter().chain(triangle).copied().collect();
    let differences: Vec<Point> = (0..5)
        .flat_map(|i| (0..i).map(move |j| (i, j)))
        .map(|(i, j)| minus(all[i], all[j]))
        .collect();
    let crosses = |first: &[Point]| -> Vec<Point> {
        let with = |a: &Point| differences.iter().map(|b| cross(*a, *b)).collect::<Vec<_>>();
        first.iter().flat_map(with).collect()
    };
    let normals = crosses(&differences);
    let within = crosses(&normals);
    !differences.iter().chain(&normals).chain(&within).any(|axis| {
        let along = |x: &Point| (0..3).map(|k| axis[k] * x[k]).sum::<i64>();
        edge.iter().map(along).max() < triangle.iter().map(along).min()
    })
}

/// Small integers cover every degeneracy, large ones none.
#[test]
fn what_is_found_among_random_triangles_is_what_whole_numbers_say() {
    let mut random = Random(2);
    for round in 0..60 {
        let range = [3, 5, 40][round % 3];
        let count = 3 + random.below(12);
        let points: Vec<Point> =
            (0..count).map(|_| std::array::from_fn(|_| random.below(range) as i64)).collect();
        let mut corner = || random.below(count) as u32;
        let triangles: Vec<_> = (0..count).map(|_| [corner(), corner(), corner()]).collect();
        let edges: Vec<_> = (0..count).map(|_| [corner(), corner()]).collect();
        let mut expected = Vec::new();
        for (edge, p) in edges.iter().enumerate() {
            for (triangle, a) in triangles.iter().enumerate() {
                let at = |i: &u32| points[*i as usize];
                let apart = !p.iter().any(|i| a.contains(i));
                if apart && meet(&p.map(|i| at(&i)), &a.map(|i| at(&i))) {
                    expected.push(Crossing { edge, triangle });
                }
            }
        }
        // The last points may also be passed separately.
        let split = random.below(count);
        let others: Vec<_> =
            points[split..].iter().map(|x| Vector3::from(x.map(|x| x as f64))).collect();
        let found = crossings(&columns(&points[..split]), &others, &triangles, &edges);
        assert_eq!(found, expected, "round {round}");
    }
}

#[test]
fn a_touch_counts_and_a_miss_by_a_rounding_does_not() {
    let triangle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let count = |p: [f64; 3], q: [f64; 3]| {
        let points: Vec<_> = triangle.iter().chain([&p, &q]).map(|x| Vector3::from(*x)).collect();
        crossings(&[], &points, &[[0, 1, 2]], &[[3, 4]]).len()
    };
    let least = 1e-30;
    // Through a corner, a side and the inside; down to a corner and to the inside.
    assert_eq!(count([1.0, 0.0, -1.0], [1.0, 0.0, 1.0]), 1);
    assert_eq!(count([0.5, 0.5, -1.0], [0.5, 0.5, 1.0]), 1);
    assert_eq!(count([0.3, 0.3, -1.0], [0.3, 0.3, 1.0]), 1);
    assert_eq!(count([0.0, 1.0, 1.0], [0.0, 1.0, 0.0]), 1);
    assert_eq!(count([0.3, 0.3, 1.0], [0.3, 0.3, 0.0]), 1);
    assert_eq!(count([0.3, 0.3, 1.0], [0.3, 0.3, least]), 0);
    assert_eq!(count([0.5, 0.5f64.next_up(), -1.0], [0.5, 0.5f64.next_up(), 1.0]), 0);
    // In the plane: inside, across, along a side, at a corner, and beside it.
    assert_eq!(count([0.2, 0.2, 0.0], [0.3, 0.4, 0.0]), 1);
    assert_eq!(count([-1.0, 0.2, 0.0], [2.0, 0.3, 0.0]), 1);
    assert_eq!(count([2.0, 0.0, 0.0], [0.5, 0.0, 0.0]), 1);
    assert_eq!(count([1.0, -1.0, 0.0], [1.0, 1.0, 0.0]), 1);
    assert_eq!(count([1.0f64.next_up(), -1.0, 0.0], [1.0f64.next_up(), 1.0, 0.0]), 0);
}

/// Cloth on y = 0, flat and folded in half onto itself along a line of points.
#[test]
fn flat_cloth_has_no_crossing_and_folded_cloth_has() {
    const N: u32 = 9;
    let triangles = cloth(N);
    let edges = edges_of(&triangles);
    let found = |fold: i64| {
        let point = |k: u32| {
            let u = i64::from(k % N);
            [u.min(2 * fold - u), 0, i64::from(k / N)]
        };
        let points: Vec<Point> = (0..N * N).map(point).collect();
        crossings(&columns(&points), &[], &triangles, &edges)
    };
    assert_eq!(found(i64::from(N)), []);
    let found = found(4);
    // The edge from the first point to the next lies on the mirror image of its own triangle.
    let edge = edges.iter().position(|e| *e == [0, 1]).unwrap();
    let triangle = triangles.iter().position(|t| *t == [N - 2, N - 1, 2 * N - 2]).unwrap();
    assert!(found.contains(&Crossing { edge, triangle }));
    assert!(found.is_sorted());
}
