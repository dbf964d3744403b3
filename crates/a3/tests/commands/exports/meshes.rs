//! Meshes as OBJ.

use super::{COUNT, ELLIPSE, distance, normals, positions, run, triangles, write};
use crate::common::{Folder, TEARING, succeed, text};
use serde_json::Value;

#[test]
fn obj_sequences_have_surfaces_with_smooth_normals() {
    let folder = &Folder::new();
    write(folder, "cloth", "f-##.obj --fps 25");
    assert_eq!(folder.count(), COUNT);
    run("cloth", |k, simulation| {
        let file = folder.join(format!("f-{:02}.obj", k + 1));
        let (models, _) = tobj::load_obj(file, &tobj::LoadOptions::default()).unwrap();
        let [model] = &models[..] else { panic!("one object") };
        assert_eq!(model.name, "cloth");
        let mesh = &model.mesh;
        let (right, normals) = (positions(simulation), normals(simulation));
        let corners = triangles(simulation).concat();
        assert_eq!(mesh.indices.len(), corners.len());
        let at = |numbers: &[f32], i: u32| {
            let i = 3 * i as usize;
            [numbers[i], numbers[i + 1], numbers[i + 2]]
        };
        for (c, corner) in corners.iter().enumerate() {
            assert_eq!(at(&mesh.positions, mesh.indices[c]), right[*corner as usize]);
            let normal = at(&mesh.normals, mesh.normal_indices[c]);
            assert!(distance(normal, normals[*corner as usize]) < 1e-6);
        }
    });
    // Without #, the state at the end.
    write(folder, "cloth", "last.obj");
    let last = folder.read("last.obj");
    assert!(last.contains("t = 0.21 s"));
}

/// No face of an OBJ spans a tear; for formats with one mesh for all frames, a warning says that
/// their faces do.
#[test]
fn what_is_torn_is_no_face() {
    let folder = &Folder::new();
    folder.write("tearing.toml", TEARING);
    let write = |output: &str| {
        let words = format!("simulate --scene tearing.toml --until 0.8 --fps 10 --output {output}");
        text(&succeed(folder, words).stderr).to_owned()
    };
    assert_eq!(write("f-#.obj --summary s.json"), "");
    let faces = |k: usize| {
        let file = folder.join(format!("f-{k}.obj"));
        let (models, _) = tobj::load_obj(file, &tobj::LoadOptions::default()).unwrap();
        let mesh = &models[0].mesh;
        let corner = |i: u32| {
            let i = 3 * i as usize;
            [0, 1, 2].map(|k| mesh.positions[i + k])
        };
        let corners = mesh.indices.chunks_exact(3);
        let longest = corners.map(|f| {
            let [a, b, c] = [0, 1, 2].map(|k| corner(f[k]));
            let side = |a, b: [f32; 3]| distance(a, b.map(f64::from));
            side(a, b).max(side(b, c)).max(side(c, a))
        });
        let longest: Vec<_> = longest.collect();
        (longest.len(), longest.into_iter().fold(0.0, f64::max))
    };
    assert_eq!(faces(1).0, 50);
    let (left, longest) = faces(9);
    assert!((20..50).contains(&left), "{left} faces are left");
    // Diagonals are springs, or lie across a square of four.
    assert!(longest < 1.4 * 2.0 * 0.2, "{longest} m");
    let summary = folder.bytes("s.json");
    let summary: Value = serde_json::from_slice(&summary).unwrap();
    let torn = summary["torn"].as_u64().unwrap();
    assert!(torn > 5, "{torn}");
    for name in ["f.glb", "f.usda"] {
        let said = write(name);
        let right = format!("{torn} springs broke, but {name} has one mesh for all its frames");
        assert!(said.starts_with(&right), "{said}");
    }
}

/// Returns the words of the lines of an OBJ that begin with a keyword.
fn lines<'a>(obj: &'a str, keyword: &'a str) -> impl Iterator<Item = Vec<&'a str>> {
    obj.lines()
        .map(|line| line.split(' ').collect::<Vec<_>>())
        .filter(move |words| words[0] == keyword)
}

#[test]
fn what_has_no_surface_is_points_and_lines() {
    let folder = &Folder::new();
    for (scene, points, springs) in [("chain", 4, 3), ("pendulum", 2, 1), ("simple", 1, 0)] {
        write(folder, scene, "f-#.obj --fps 25");
        run(scene, |k, simulation| {
            let obj = folder.read(&format!("f-{}.obj", k + 1));
            let vertices: Vec<[f32; 3]> = lines(&obj, "v")
                .map(|words| [1, 2, 3].map(|k| words[k].parse().unwrap()))
                .collect();
            assert_eq!(vertices, positions(simulation));
            let counts = ["p", "l", "f", "vn"].map(|keyword| lines(&obj, keyword).count());
            assert_eq!(counts, [points, springs, 0, 0]);
            let network = simulation.model().network();
            let ends = network.into_iter().flat_map(a3_core::Network::springs);
            for (spring, words) in ends.zip(lines(&obj, "l")) {
                assert_eq!(words[1..], [(spring.i + 1).to_string(), (spring.j + 1).to_string()]);
            }
        });
    }
}

/// Times have no digits from rounding errors.
#[test]
fn times_are_short() {
    let folder = &Folder::new();
    for (name, fps, expected) in [
        ("x.obj", "", "t = 0.006 s"),
        ("x.json", "", "\"time\":0.006,"),
        ("x.csv", "--fps 500", ",0.006,"),
    ] {
        let run = "simulate r 0.001 --scene simple --until 0.006";
        succeed(folder, format!("{run} --output {name} {fps}"));
        let file = folder.read(name);
        assert!(file.contains(expected) && !file.contains("99999999"), "{file}");
    }
}

/// Readers such as meshio expect a normal for each vertex, or none.
#[test]
fn normals_are_as_many_as_vertices() {
    let folder = &Folder::new();
    for (scene, has_normals) in
        [("cloth", true), ("chain", false), ("boxes", true), (ELLIPSE, true)]
    {
        write(folder, scene, "x.obj");
        let obj = folder.read("x.obj");
        let (vertices, normals) = (lines(&obj, "v").count(), lines(&obj, "vn").count());
        assert_eq!(normals, if has_normals { vertices } else { 0 }, "{scene}");
    }
}
