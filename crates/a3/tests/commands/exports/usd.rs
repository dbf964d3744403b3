//! Universal Scene Description, by a reader of the part of its syntax that a3 writes. Pixar's own
//! library reads such files too; see docs/files.md.

use std::collections::BTreeMap;

use super::{COUNT, ELLIPSE, RATE, distance, normals, positions, run, triangles, write};
use crate::common::Folder;

/// Values of an attribute at each frame, as numbers one after another; at frame -1 if the attribute
/// is constant.
type Values = BTreeMap<i64, Vec<f64>>;

/// Attributes of each primitive, by the type and name of the primitive and of the attribute.
type Prims = BTreeMap<String, BTreeMap<String, Values>>;

/// Reads a file: its head, and its primitives.
fn read(text: &str) -> (String, Prims) {
    assert!(text.starts_with("#usda 1.0\n("));
    let (head, body) = text.split_once("\n)\n").unwrap();
    let balance = |open, close| body.matches(open).count() == body.matches(close).count();
    assert!(balance('{', '}') && balance('(', ')') && balance('[', ']'));
    let numbers = |text: &str| -> Vec<f64> {
        let number = |c: char| c.is_ascii_digit() || "+-.e".contains(c);
        let words = text.split(|c| !number(c)).filter(|word| !word.is_empty());
        words.map(|word| word.parse().unwrap()).collect()
    };
    let (mut prims, mut prim, mut attribute) = (Prims::new(), String::new(), String::new());
    for line in body.lines().map(str::trim) {
        if let Some(def) = line.strip_prefix("def ") {
            prim = def.replace('"', "");
        } else if let Some((name, _)) = line.split_once(".timeSamples = {") {
            name.clone_into(&mut attribute);
        } else if let Some((frame, values)) = line.split_once(": [") {
            let of = prims.entry(prim.clone()).or_default();
            let of = of.entry(attribute.clone()).or_default();
            assert!(of.insert(frame.parse().unwrap(), numbers(values)).is_none());
        } else if let Some((name, values)) = line.split_once(" = [") {
            let of = prims.entry(prim.clone()).or_default();
            of.insert(name.into(), [(-1, numbers(values))].into());
        }
    }
    (head.into(), prims)
}

/// Vectors in single precision from their numbers.
fn vectors(numbers: &[f64]) -> Vec<[f32; 3]> {
    let vectors = numbers.chunks_exact(3);
    vectors.map(|v| [0, 1, 2].map(|k| v[k] as f32)).collect()
}

#[test]
fn usd_moves_a_surface_with_smooth_normals() {
    let folder = &Folder::new();
    write(folder, "cloth", "f.usda --fps 25");
    let (head, prims) = read(&folder.read("f.usda"));
    for says in [
        "doc = \"a3: cloth\"",
        "startTimeCode = 0",
        "endTimeCode = 5",
        "timeCodesPerSecond = 25",
        "metersPerUnit = 1",
        "upAxis = \"Y\"",
    ] {
        assert!(head.contains(says), "{head}");
    }
    let mesh = &prims["Mesh surface"];
    run("cloth", |k, simulation| {
        let (frame, right) = (k as i64, positions(simulation));
        assert!((simulation.time() - k as f64 / RATE).abs() < 1e-12);
        assert_eq!(vectors(&mesh["point3f[] points"][&frame]), right);
        let written = vectors(&mesh["normal3f[] normals"][&frame]);
        for (written, right) in written.into_iter().zip(normals(simulation)) {
            assert!(distance(written, right) < 1e-6);
        }
        let extent = vectors(&mesh["float3[] extent"][&frame]);
        for axis in 0..3 {
            let all = right.iter().map(|x| x[axis]);
            assert_eq!(extent[0][axis], all.clone().fold(f32::INFINITY, f32::min));
            assert_eq!(extent[1][axis], all.fold(f32::NEG_INFINITY, f32::max));
        }
        let corners = &mesh["int[] faceVertexIndices"][&-1];
        let right = triangles(simulation).concat();
        assert_eq!(*corners, right.into_iter().map(f64::from).collect::<Vec<_>>());
        let counts = &mesh["int[] faceVertexCounts"][&-1];
        assert!(counts.iter().all(|count| *count == 3.0) && 3 * counts.len() == corners.len());
    });
    assert_eq!(mesh["point3f[] points"].len(), COUNT);
}

#[test]
fn usd_of_each_scene_is_whole() {
    let folder = &Folder::new();
    for (scene, kinds) in [
        ("chain", &["BasisCurves springs", "Points particles"][..]),
        ("double-pendulum", &["Points particles"]),
        ("jelly", &["Mesh surface"]),
        ("t-handle", &["Mesh surface"]),
        (ELLIPSE, &["Mesh liquid", "Points particles"]),
    ] {
        write(folder, scene, "f.usda --fps 25");
        let (_, prims) = read(&folder.read("f.usda"));
        let found = prims.keys().map(String::as_str);
        assert_eq!(found.collect::<Vec<_>>(), kinds, "{scene}");
        for (prim, attributes) in &prims {
            let points = &attributes["point3f[] points"];
            assert!(points.len() == COUNT && points.keys().copied().eq(0..COUNT as i64));
            // The mesh of a fluid has different triangles in each frame.
            for (frame, points) in points {
                let at = |name: &str| {
                    let values = attributes.get(name)?;
                    values.get(frame).or(values.get(&-1))
                };
                let sum = |name| at(name).map(|counts| counts.iter().sum::<f64>());
                let vertices = points.len() as f64 / 3.0;
                if let Some(corners) = at("int[] faceVertexIndices") {
                    let (counts, corners_count) = (sum("int[] faceVertexCounts"), corners.len());
                    assert_eq!(counts, Some(corners_count as f64));
                    assert_eq!(corners.iter().copied().fold(0.0, f64::max), vertices - 1.0);
                    assert_eq!(at("normal3f[] normals").map(Vec::len), Some(points.len()));
                }
                if prim.starts_with("BasisCurves") {
                    assert_eq!(sum("int[] curveVertexCounts"), Some(vertices));
                }
                assert!(vertices > 0.0 && points.iter().all(|x| x.is_finite()));
            }
        }
    }
}
