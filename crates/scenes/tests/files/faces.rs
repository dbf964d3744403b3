//! Faces with many corners.

use std::fmt::Write;

use crate::{area, begins, data, obj, random, vector_area};

/// Returns a face in OBJ, whose corners in a plane are turned and stretched into space by a fixed
/// matrix, and its area.
fn face(corners: &[[f64; 2]]) -> (String, f64) {
    let (mut text, count) = (String::new(), corners.len());
    for [x, y] in corners {
        writeln!(text, "v {x} {y} 0").unwrap();
    }
    let numbers: Vec<_> = (1..=count).map(|k| k.to_string()).collect();
    writeln!(text, "f {}", numbers.join(" ")).unwrap();
    let cross = |k: usize| {
        let ([a, b], [c, d]) = (corners[k], corners[(k + 1) % count]);
        a * d - b * c
    };
    (text, 0.5 * (0..count).map(cross).sum::<f64>())
}

/// Asserts that the triangles cover the face, and no place twice.
fn is_covered(corners: &[[f64; 2]]) {
    let (text, expected) = face(corners);
    let mesh = obj(&text);
    let (sum, whole) = (area(&mesh), vector_area(&mesh)[2]);
    let off = (sum - expected.abs()).abs().max((whole - expected).abs());
    let is_same = off < 1e-5 * expected.abs();
    assert!(is_same, "{sum} {whole} {expected}\n{text}");
}

#[test]
fn concave_faces_keep_their_notches() {
    let mesh = obj(data("concave.obj"));
    assert_eq!((mesh.triangles.len(), area(&mesh)), (6, 7.0));
    // An arrow, beginning at each of its corners, in both directions.
    let mut arrow = vec![[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.5, 1.0]];
    for _ in 0..2 {
        for _ in 0..4 {
            is_covered(&arrow);
            arrow.rotate_left(1);
        }
        arrow.reverse();
    }
    // A comb with teeth of two lengths.
    let mut comb = vec![];
    for k in 0..40 {
        let (x, top) = (f64::from(k), if k % 2 == 0 { 5.0 } else { 6.0 });
        comb.extend([[x, top], [x + 0.3, 1.0]]);
    }
    comb.extend([[40.0, 0.0], [0.0, 0.0]]);
    is_covered(&comb);
    // A spiral of two turns, which no fan of triangles covers.
    let arm = |r: f64| {
        (0..60).map(move |k| {
            let (angle, r) = (f64::from(k) * 0.21, r + f64::from(k) * 0.1);
            [r * angle.cos(), r * angle.sin()]
        })
    };
    let back = arm(1.4).collect::<Vec<_>>().into_iter().rev();
    is_covered(&arm(1.0).chain(back).collect::<Vec<_>>());
}

/// Corners on straight sides are kept, so that neighbouring faces still meet them. Corners that are
/// there twice are harmless.
#[test]
fn corners_on_sides_stay() {
    #[rustfmt::skip]
    let tee =
        [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0], [0.0, 1.0]];
    is_covered(&tee);
    let mesh = obj(face(&tee).0);
    let sides_of = |&[a, b, c]: &[u32; 3]| [[a, b], [b, c], [c, a]];
    let all: Vec<_> = mesh.triangles.iter().flat_map(sides_of).collect();
    let is_outer = |[a, b]: &&[u32; 2]| !all.contains(&[*b, *a]);
    let mut sides: Vec<_> = all.iter().filter(is_outer).collect();
    sides.sort_unstable();
    assert!(sides.len() == 7 && (0..7).all(|k| *sides[k as usize] == [k, (k + 1) % 7]));
    #[rustfmt::skip]
    let twice =
        [[0.0, 0.0], [0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [3.0, 3.0], [1.5, 1.0], [0.0, 3.0]];
    is_covered(&twice);
}

/// Holes, each joined to the outer sides by a bridge that goes there and back.
#[test]
fn bridges_lead_to_holes() {
    let frame = |hole: [[f64; 2]; 4]| {
        let mut corners = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]];
        corners.extend(hole);
        corners.push(hole[0]);
        corners
    };
    let hole = [[1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 1.0]];
    let mut corners = frame(hole);
    for _ in 0..corners.len() {
        is_covered(&corners);
        corners.rotate_left(1);
    }
    // Two holes with bridges from the same corner.
    let small = |x: f64, y: f64| {
        let corners = [[0.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
        corners.map(|[u, v]| [x + u, y + v])
    };
    let mut two = vec![[0.0, 0.0], [5.0, 0.0], [5.0, 4.0], [0.0, 4.0], [0.0, 0.0]];
    two.extend(small(1.0, 2.0));
    two.push([0.0, 0.0]);
    two.extend(small(3.0, 1.0));
    for _ in 0..two.len() {
        is_covered(&two);
        two.rotate_left(1);
    }
}

/// Random polygons without crossings, in random planes of space: triangles cover each once.
#[test]
fn random_faces_are_covered_once() {
    let mut random = random(7);
    for round in 0..400 {
        let count = 4 + round % 37;
        let turn = std::f64::consts::TAU / f64::from(count);
        let corners: Vec<_> = (0..count)
            .map(|k| {
                let (angle, r) = (turn * (f64::from(k) + 0.4 * random()), 0.2 + 2.0 * random());
                [r * angle.cos(), r * angle.sin()]
            })
            .collect();
        is_covered(&corners);
    }
}

/// A face that crosses itself is cut in some way, and one that would take too long is refused.
#[test]
fn crossing_faces_come_to_an_end() {
    let star = |count: usize| {
        let corner = |k: usize| {
            let angle = k as f64 * 2.399_963;
            [1000.0 * angle.cos(), 1000.0 * angle.sin()]
        };
        face(&(0..count).map(corner).collect::<Vec<_>>()).0
    };
    assert_eq!(obj(star(5)).triangles.len(), 3);
    assert_eq!(obj(star(300)).triangles.len(), 298);
    let begun = std::time::Instant::now();
    let why = a3_scenes::Mesh::from_obj(star(20_000).as_bytes()).unwrap_err();
    let expected = "line 20001: faces that are not convex have too many corners, 20000 in this one";
    begins(why, expected);
    assert!(begun.elapsed().as_secs() < 5);
}
