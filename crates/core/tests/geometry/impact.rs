//! Times of impact, against tight inclusion, which misses no root, and against known cases.

use super::inclusion::{Verdict, meet};
use super::pairs::{FAMILIES, Pair};
use super::random::Random;
use a3_core::Vector3;
use a3_core::contact::PairKind::{EdgeEdge, VertexFloor, VertexTriangle};
use a3_core::contact::{PairKind, closest, time_of_impact};

/// Gaps in the tests (m).
const GAPS: [f64; 2] = [0.0, 1e-3];

impl Pair {
    fn time_of_impact(&self, gap: f64) -> Option<f64> {
        time_of_impact(self.kind, &self.from, &self.moves, 0.0, gap)
    }

    /// Verdict of tight inclusion on whether the pair comes nearer than a distance in a maximum
    /// norm (m).
    fn meets(&self, distance: f64) -> Verdict {
        meet(self.kind, &self.from, &self.at(1.0), distance)
    }

    fn at(&self, t: f64) -> [Vector3<f64>; 4] {
        std::array::from_fn(|i| self.from[i] + self.moves[i] * t)
    }

    fn distance(&self, t: f64) -> f64 {
        closest(self.kind, &self.at(t)).offset.norm()
    }
}

/// Numbers of pairs.
#[derive(Debug, Default)]
struct Tally {
    free: usize,
    undecided: usize,
    missed: usize,
    hit: usize,
    false_hits: usize,
}

/// Results of a family of pairs, with each hundredth hit compared too. A hit is false if tight
/// inclusion is certain that the pair stays 1e-8 m farther apart than it has to.
fn tally(family: &str, count: usize) -> Tally {
    let mut random = Random(7);
    let mut tally = Tally::default();
    for k in 0..count {
        let pair = Pair::random(family, &mut random);
        let gap = GAPS[k % 2];
        if let Some(t) = pair.time_of_impact(gap) {
            assert!((0.0..=1.0).contains(&t));
            if k % 100 < 2 {
                tally.hit += 1;
                let least = 1.1 * gap + 1e-8;
                tally.false_hits += usize::from(pair.meets(least) == Verdict::Apart);
            }
        } else {
            tally.free += 1;
            // A distance below this in the maximum norm is below the gap. Pairs that begin nearer
            // may lose a tenth.
            let least = gap.min(0.9 * pair.distance(0.0));
            match pair.meets(least / 3f64.sqrt()) {
                Verdict::Apart => {}
                Verdict::Meets => tally.missed += 1,
                Verdict::Undecided => tally.undecided += 1,
            }
        }
    }
    tally
}

/// Only parallel edges in parallel motion are undecided by tight inclusion.
#[test]
fn none_of_a_million_pairs_that_meet_is_free_and_few_that_do_not_are_hit() {
    let tallies: Vec<_> = std::thread::scope(|scope| {
        let runs = FAMILIES.map(|family| scope.spawn(move || tally(family, 125_000)));
        runs.into_iter().map(|run| run.join().unwrap()).collect()
    });
    for (family, tally) in FAMILIES.into_iter().zip(tallies) {
        println!("{family}: {tally:?}");
        assert_eq!(tally.missed, 0, "{family}: {tally:?}");
        assert!(tally.undecided * 10 < tally.free, "{family}: {tally:?}");
        assert!(tally.false_hits * 20 <= tally.hit, "{family}: {tally:?}");
    }
}

#[test]
fn distances_on_the_way_are_larger_than_the_gap_until_the_time_of_impact() {
    let mut random = Random(3);
    let (mut hits, mut early) = (0, 0);
    for k in 0..40_000 {
        let pair = Pair::random(FAMILIES[k % 6], &mut random);
        let gap = [1e-6, 1e-2][k / 6 % 2];
        let begin = pair.distance(0.0);
        if begin <= gap {
            continue;
        }
        let time = pair.time_of_impact(gap);
        let end = time.unwrap_or(1.0);
        for part in 0..=50 {
            let distance = pair.distance(end * f64::from(part) / 50.0);
            assert!(distance > gap - 1e-12, "{} at {end}", distance - gap);
        }
        if time.is_some() {
            let left = pair.distance(end) - gap;
            hits += 1;
            early += usize::from(left > 0.11 * gap + 1e-8);
        }
    }
    assert!(early * 8 < hits, "{early} of {hits} are hit before they have to be");
}

/// The far end of a long primitive that turns about its near end moves by half its length: a
/// primitive near that end is hit when the far end arrives, and not after a few planes.
#[test]
fn a_long_primitive_meets_what_is_near_its_slow_end_in_time() {
    let gap: f64 = 0.1;
    // At the share t the primitive has the direction (t / 2, 0, -1) from the y axis, and is |2 - 5
    // t| / sqrt(1 + t^2 / 4) away from x = 2, z = -10.
    let [a, b, c] = [25.0 - gap * gap / 4.0, -20.0, 4.0 - gap * gap];
    let exact = (-b - (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
    for length in [1e2, 1e5, 1e9] {
        for (kind, beside) in
            [(EdgeEdge, 0.0), (EdgeEdge, 1.3), (VertexTriangle, 0.0), (VertexTriangle, 1.3)]
        {
            let [p, q] = [0.0, 1.0].map(|y| Vector3::new(2.0, beside + y, -10.0));
            let far = Vector3::new(0.0, 0.0, -length);
            let from = match kind {
                EdgeEdge => [p, q, Vector3::zeros(), far],
                _ => [p, -Vector3::y(), Vector3::y(), far],
            };
            let mut moves = [Vector3::zeros(); 4];
            moves[3].x = 0.5 * length;
            let pair = Pair { kind, from, moves };
            let time = pair.time_of_impact(gap);
            if beside > 0.0 {
                assert_eq!(time, None, "{kind:?} {length:e}");
                continue;
            }
            let tolerance = 1e-12 * length;
            let left = pair.distance(time.unwrap()) - gap;
            assert!(time.unwrap() <= exact + tolerance, "{kind:?} {length:e}: {time:?}");
            // When planes run out, the time is too early.
            let decided = kind == EdgeEdge || length < 1e9;
            assert!(!decided || left < 0.11 * gap + tolerance, "{kind:?} {length:e}: {left}");
        }
    }
}

/// Points of a vertex at a height above a triangle (m).
fn above(height: f64) -> [Vector3<f64>; 4] {
    [
        Vector3::new(0.2, height, 0.1),
        Vector3::new(-1.0, 0.0, -1.0),
        Vector3::new(1.0, 0.0, -1.0),
        Vector3::new(0.0, 0.0, 2.0),
    ]
}

/// Displacements of points by heights (m).
fn lifted(heights: [f64; 4]) -> [Vector3<f64>; 4] {
    heights.map(|y| Vector3::new(0.3, y, -0.2))
}

/// A vertex 22 nm above a triangle of 2 m, 7 m from the origin, moves with it, by far more than
/// that distance. Rounding turns the line through their closest points by 2e-8.
#[test]
fn what_a_large_triangle_carries_is_not_hit() {
    let (top, height) = (0.124_608_926_362_499_2, 2.2085e-8);
    let at = |x, y, z| Vector3::new(x, y, z);
    let vertex = at(6.923_948_888_533_38, top + height, 0.923_941_306_321_096);
    let from = [vertex, at(6.0, top, 0.0), at(8.0, top, 2.0), at(8.0, top, 0.0)];
    let mut moves = [Vector3::y() * 4.6308e-5; 4];
    moves[0] += at(-7.9e-7, 0.0, -8.2e-7);
    let of = |moves| time_of_impact(VertexTriangle, &from, &moves, 0.0, 0.9 * height);
    assert_eq!(of(moves), None);
    moves[0].y -= 0.3 * height;
    assert!(of(moves).is_some());
}

#[test]
fn what_begins_nearer_than_the_gap_is_held_only_if_it_approaches() {
    let of = |kind, height, moves| time_of_impact(kind, &above(height), &lifted(moves), 0.0, 1e-3);
    for kind in [VertexTriangle, VertexFloor] {
        assert_eq!(of(kind, 5e-4, [0.0; 4]), None);
        assert_eq!(of(kind, 5e-4, [0.1, 0.0, 0.0, 0.0]), None);
        assert_eq!(of(kind, 5e-4, [-1e-6, 0.0, 0.0, 0.0]), Some(0.0));
        assert_eq!(of(kind, 5e-4, [0.0, 1e-5, 1e-5, 1e-5]), Some(0.0));
        assert_eq!(of(kind, 0.5, [-0.4, 0.0, 0.0, 0.0]), None);
        // Down to the gap and a hundredth of it.
        let t = of(kind, 0.5, [-1.0, 0.0, 0.0, 0.0]).unwrap();
        assert!((t - 0.49899).abs() < 1e-8, "{t}");
    }
    // Round primitives that touch may separate, and slide.
    let round = |height: f64, rise: f64| {
        let moves = lifted([rise, 0.0, 0.0, 0.0]);
        time_of_impact(VertexTriangle, &above(height), &moves, 0.5, 0.501)
    };
    for height in [0.5, 0.5 - 1e-12, 0.5 + 1e-12] {
        assert_eq!([0.0, 0.1].map(|rise| round(height, rise)), [None; 2]);
        assert_eq!(round(height, -1e-11), Some(0.0));
    }
    // They may lose a tenth of their room, but not a tenth of the radius.
    assert_eq!(round(0.5001, -1e-12), None);
    assert_eq!(round(0.5001, -1e-4), Some(0.0));
    // Touching: only for a floor it is known which side is up.
    assert_eq!(of(VertexTriangle, 0.0, [0.1, 0.0, 0.0, 0.0]), Some(0.0));
    assert_eq!(of(VertexFloor, 0.0, [0.1, 0.0, 0.0, 0.0]), None);
    assert_eq!(of(VertexFloor, -0.1, [-0.1, 0.0, 0.0, 0.0]), Some(0.0));
    assert_eq!(of(VertexFloor, -0.1, [0.0; 4]), None);
    // The closest points separate while a corner rises past the vertex.
    assert_eq!(of(VertexTriangle, 5e-4, [0.0, 0.5, -0.5, 0.0]), None);
}

#[test]
fn numbers_that_are_not_finite_are_a_hit() {
    for bad in [f64::NAN, f64::INFINITY] {
        for kind in [VertexTriangle, EdgeEdge, VertexFloor] {
            assert_eq!(time_of_impact(kind, &above(bad), &lifted([0.0; 4]), 0.0, 1e-3), Some(0.0));
            let moves = lifted([bad, 0.0, 0.0, 0.0]);
            let hit = time_of_impact(kind, &above(1.0), &moves, 0.0, 1e-3);
            assert_eq!(hit, Some(0.0));
        }
    }
}

/// Unit tests of the benchmark of Wang et al. (2021), with its answers: points at the beginning and
/// at the end of the step; e = 2^-23.
#[test]
fn handcrafted_cases_are_decided_as_in_the_benchmark() {
    let e = 2f64.powi(-23);
    let check = |kind: PairKind, hit: bool, from: [[f64; 3]; 4], to: [[f64; 3]; 4]| {
        let from = from.map(Vector3::from);
        let moves = std::array::from_fn(|i| Vector3::from(to[i]) - from[i]);
        assert_eq!(time_of_impact(kind, &from, &moves, 0.0, 0.0).is_some(), hit, "{kind:?} {to:?}");
    };
    let face = |y| [[-1.0, y, 1.0], [1.0, y, 1.0], [0.0, y, -1.0]];
    let with = |v: [f64; 3], [a, b, c]: [[f64; 3]; 3]| [v, a, b, c];
    let start = with([0.0, 1.0, 0.0], face(0.0));
    check(VertexTriangle, false, start, with([0.0, 2.0, -e], face(-1.0)));
    check(VertexTriangle, false, start, with([0.0, 2.0, -e], face(0.0)));
    check(VertexTriangle, true, start, with([0.0, 0.5 + e, e], face(2.0)));
    check(VertexTriangle, false, start, with([0.0, 0.5, -e], face(-1.0)));
    let edges = |y: f64, z: f64| {
        let x = -1.0 - e;
        [[-1.0, y, 0.0], [1.0, y, 0.0], [x, z, -1.0], [x, z, 1.0]]
    };
    check(EdgeEdge, false, edges(-1.0, 1.0), edges(-2.0, 2.0));
    check(EdgeEdge, false, edges(-1.0, 1.0), edges(-e, e));
    check(EdgeEdge, false, edges(-1.0, 1.0), edges(1.0, -1.0));
}
