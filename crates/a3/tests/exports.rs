//! Files for other programs, read back by readers that were written elsewhere, against the run that they are of.
//!
//! Khronos' own validator is asked too where it is here: `npm install gltf-validator`, and `A3_GLTF_VALIDATOR` set to that
//! `node_modules`.

#![allow(missing_docs, reason = "a test")]

mod common;

use std::fs;
use std::path::Path;

use a3_core::{Control, Simulation, integrators};
use common::{TEARING, a3, asked, command, complaint, is_missing, text};
use serde_json::Value;

/// Frames a second of what is compared, and how many: the last at 0.2 s, before the end.
const RATE: f64 = 25.0;
const COUNT: usize = 6;

/// What the program is asked for.
fn words<'a>(scene: &'a str, output: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    let run = [
        "simulate", "r", "0.007", "--scene", scene, "--until", "0.21", "--output", output,
    ];
    [&run[..], more].concat()
}

fn write(folder: &Path, scene: &str, output: &str, more: &[&str]) -> String {
    let output = a3(folder, &words(scene, output, more));
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(output.stderr.is_empty(), "{}", text(&output.stderr));
    text(&output.stdout).to_owned()
}

/// The same run by the library, at the times of its frames.
fn run(scene: &str, mut frame: impl FnMut(usize, &Simulation)) {
    let scene = a3_scenes::find(scene).unwrap().build(None).unwrap();
    let method = integrators::find("r").unwrap();
    let mut simulation = Simulation::new(scene, method, Control::Step(0.007)).unwrap();
    for k in 0..COUNT {
        simulation.advance_to(k as f64 / RATE).unwrap();
        frame(k, &simulation);
    }
}

/// Row i of an n x 3 matrix.
fn row(matrix: &[f64], i: usize) -> [f64; 3] {
    let n = matrix.len() / 3;
    [matrix[i], matrix[n + i], matrix[2 * n + i]]
}

/// Positions at a frame in single precision.
fn positions(simulation: &Simulation) -> Vec<[f32; 3]> {
    let n = simulation.particles();
    (0..n)
        .map(|i| row(&simulation.state()[..3 * n], i).map(|x| x as f32))
        .collect()
}

fn triangles(simulation: &Simulation) -> Vec<[u32; 3]> {
    simulation.scene().surface.triangles.clone()
}

/// Normals by the textbook: cross products of two sides, which are as long as the areas, summed over the triangles around.
fn normals(simulation: &Simulation) -> Vec<[f64; 3]> {
    let mut sums = vec![a3_core::Vector3::zeros(); simulation.particles()];
    for triangle in triangles(simulation) {
        let [a, b, c] = triangle.map(|i| simulation.position(i as usize));
        for i in triangle {
            sums[i as usize] += (b - a).cross(&(c - a));
        }
    }
    sums.iter().map(|n| n.normalize().into()).collect()
}

fn distance(a: [f32; 3], b: [f64; 3]) -> f64 {
    (0..3)
        .map(|k| (f64::from(a[k]) - b[k]).powi(2))
        .sum::<f64>()
        .sqrt()
}

#[test]
fn json_has_the_states_of_all_frames_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    for scene in ["cloth", "simple", "chain"] {
        write(folder.path(), scene, "x.json", &["--fps", "25"]);
        let read = fs::read_to_string(folder.path().join("x.json")).unwrap();
        let frames: Vec<Value> = serde_json::from_str(&read).unwrap();
        assert_eq!(frames.len(), COUNT);
        run(scene, |k, simulation| {
            let (n, v) = (simulation.particles(), simulation.velocities());
            assert_eq!(frames[k]["time"], k as f64 / RATE);
            let rows =
                |matrix: &[f64]| -> Vec<[f64; 3]> { (0..n).map(|i| row(matrix, i)).collect() };
            let x = &simulation.state()[..3 * n];
            assert_eq!(frames[k]["positions"], serde_json::json!(rows(x)));
            assert_eq!(frames[k]["velocities"], serde_json::json!(rows(&v)));
        });
    }
}

#[test]
fn csv_has_a_row_a_frame_and_particle_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    for scene in ["cloth", "simple", "pendulum"] {
        write(folder.path(), scene, "x.csv", &["--fps", "25"]);
        let mut reader = csv::Reader::from_path(folder.path().join("x.csv")).unwrap();
        let head = ["frame", "time", "particle", "x", "y", "z", "vx", "vy", "vz"];
        assert_eq!(reader.headers().unwrap(), &head[..]);
        let mut rows = reader.deserialize::<(usize, f64, usize, [f64; 3], [f64; 3])>();
        run(scene, |k, simulation| {
            let (n, v) = (simulation.particles(), simulation.velocities());
            for i in 0..n {
                let right = (
                    k,
                    k as f64 / RATE,
                    i,
                    row(&simulation.state()[..3 * n], i),
                    row(&v, i),
                );
                assert_eq!(rows.next().unwrap().unwrap(), right);
            }
        });
        assert!(rows.next().is_none());
    }
}

#[test]
fn obj_sequences_have_surfaces_with_smooth_normals() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "cloth", "f-##.obj", &["--fps", "25"]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), COUNT);
    run("cloth", |k, simulation| {
        let file = folder.path().join(format!("f-{:02}.obj", k + 1));
        let (models, _) = tobj::load_obj(file, &tobj::LoadOptions::default()).unwrap();
        let [model] = &models[..] else {
            panic!("one object")
        };
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
            assert_eq!(
                at(&mesh.positions, mesh.indices[c]),
                right[*corner as usize]
            );
            let normal = at(&mesh.normals, mesh.normal_indices[c]);
            assert!(distance(normal, normals[*corner as usize]) < 1e-6);
        }
    });
    // Without #, the state at the end.
    write(folder.path(), "cloth", "last.obj", &[]);
    let last = fs::read_to_string(folder.path().join("last.obj")).unwrap();
    assert!(last.contains("t = 0.21 s"));
}

/// No face of an OBJ spans a tear; formats that have one mesh for all frames say that theirs does.
#[test]
fn what_is_torn_is_no_face() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("tearing.toml"), TEARING).unwrap();
    let write = |output: &str, more: &[&str]| {
        let words = ["simulate", "--scene", "tearing.toml", "--until", "0.8"];
        let output = a3(
            folder.path(),
            &[&words[..], &["--output", output], more].concat(),
        );
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stderr).to_owned()
    };
    assert_eq!(
        write("f-#.obj", &["--fps", "10", "--summary", "s.json"]),
        ""
    );
    let faces = |k: usize| {
        let file = folder.path().join(format!("f-{k}.obj"));
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
    // Diagonals are of springs or across a square of four.
    assert!(longest < 1.4 * 2.0 * 0.2, "{longest} m");
    let summary = fs::read(folder.path().join("s.json")).unwrap();
    let summary: Value = serde_json::from_slice(&summary).unwrap();
    let torn = summary["torn"].as_u64().unwrap();
    assert!(torn > 5, "{torn}");
    for name in ["f.pc2", "f.glb"] {
        let said = write(name, &["--fps", "10"]);
        let right = format!("{torn} springs broke, but {name} has one mesh for all its frames");
        assert!(said.starts_with(&right), "{said}");
    }
}

/// The words of the lines of an OBJ that begin with this one.
fn lines<'a>(obj: &'a str, keyword: &'a str) -> impl Iterator<Item = Vec<&'a str>> {
    obj.lines()
        .map(|line| line.split(' ').collect::<Vec<_>>())
        .filter(move |words| words[0] == keyword)
}

#[test]
fn what_has_no_surface_is_points_and_lines() {
    let folder = tempfile::tempdir().unwrap();
    for (scene, points, springs) in [("chain", 4, 3), ("pendulum", 2, 1), ("simple", 1, 0)] {
        write(folder.path(), scene, "f-#.obj", &["--fps", "25"]);
        run(scene, |k, simulation| {
            let obj = fs::read_to_string(folder.path().join(format!("f-{}.obj", k + 1))).unwrap();
            let vertices: Vec<[f32; 3]> = lines(&obj, "v")
                .map(|words| [1, 2, 3].map(|k| words[k].parse().unwrap()))
                .collect();
            assert_eq!(vertices, positions(simulation));
            let counts = ["p", "l", "f", "vn"].map(|keyword| lines(&obj, keyword).count());
            assert_eq!(counts, [points, springs, 0, 0]);
            let network = simulation.model().network();
            let ends = network.into_iter().flat_map(a3_core::Network::springs);
            for (spring, words) in ends.zip(lines(&obj, "l")) {
                assert_eq!(
                    words[1..],
                    [(spring.i + 1).to_string(), (spring.j + 1).to_string()]
                );
            }
        });
    }
}

/// By the format's definition: 12 letters, four bytes each of version, points, start, rate and samples, then the points.
#[test]
fn pc2_has_the_positions_of_all_frames() {
    let folder = tempfile::tempdir().unwrap();
    for scene in ["cloth", "chain"] {
        let said = write(folder.path(), scene, "x.pc2", &["--fps", "25"]);
        assert!(said.contains("x.obj"), "{said}");
        let bytes = fs::read(folder.path().join("x.pc2")).unwrap();
        let word = |k: usize| <[u8; 4]>::try_from(&bytes[12 + 4 * k..16 + 4 * k]).unwrap();
        let n = u32::from_le_bytes(word(1)) as usize;
        assert_eq!(&bytes[..12], b"POINTCACHE2\0");
        assert_eq!(u32::from_le_bytes(word(0)), 1);
        assert_eq!([2, 3].map(|k| f32::from_le_bytes(word(k))), [0.0, 1.0]);
        assert_eq!(u32::from_le_bytes(word(4)) as usize, COUNT);
        assert_eq!(bytes.len(), 32 + 12 * n * COUNT);
        let at = |k: usize, i: usize| {
            [0, 1, 2].map(|c| f32::from_le_bytes(word(5 + 3 * (k * n + i) + c)))
        };
        // The mesh it belongs to has its points in the same order.
        let obj = fs::read_to_string(folder.path().join("x.obj")).unwrap();
        let vertices: Vec<_> = lines(&obj, "v").collect();
        assert_eq!(vertices.len(), n);
        run(scene, |k, simulation| {
            assert_eq!(simulation.particles(), n);
            for (i, right) in positions(simulation).into_iter().enumerate() {
                assert_eq!(at(k, i), right);
                let vertex = [1, 2, 3].map(|c| vertices[i][c].parse::<f32>().unwrap());
                assert!(k > 0 || vertex == right);
            }
        });
    }
}

#[test]
fn glb_goes_from_frame_to_frame() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "cloth", "x.glb", &["--fps", "25"]);
    let read = gltf::Gltf::from_slice(&fs::read(folder.path().join("x.glb")).unwrap()).unwrap();
    let blob = read.blob.as_deref().unwrap();
    let data = |_: gltf::Buffer<'_>| Some(blob);
    let node = read.default_scene().unwrap().nodes().next().unwrap();
    let primitive = node.mesh().unwrap().primitives().next().unwrap();
    assert_eq!(primitive.mode(), gltf::mesh::Mode::Triangles);
    let reader = primitive.reader(data);
    let base: Vec<_> = reader.read_positions().unwrap().collect();
    let base_normals: Vec<_> = reader.read_normals().unwrap().collect();
    let indices: Vec<_> = reader.read_indices().unwrap().into_u32().collect();
    let targets: Vec<(Vec<_>, Vec<_>)> = reader
        .read_morph_targets()
        .map(|(x, n, _)| (x.unwrap().collect(), n.unwrap().collect()))
        .collect();
    assert_eq!(targets.len(), COUNT - 1);

    let animation = read.animations().next().unwrap();
    let channel = animation.channels().next().unwrap();
    assert_eq!(
        channel.target().property(),
        gltf::animation::Property::MorphTargetWeights
    );
    assert_eq!(channel.target().node().index(), node.index());
    let reader = channel.reader(data);
    let times: Vec<_> = reader.read_inputs().unwrap().collect();
    let Some(gltf::animation::util::ReadOutputs::MorphTargetWeights(weights)) =
        reader.read_outputs()
    else {
        panic!("weights");
    };
    let weights: Vec<_> = weights.into_f32().collect();
    assert_eq!(weights.len(), COUNT * (COUNT - 1));

    run("cloth", |k, simulation| {
        assert_eq!(times[k], (k as f64 / RATE) as f32);
        assert_eq!(indices, triangles(simulation).concat());
        let weights = &weights[k * (COUNT - 1)..(k + 1) * (COUNT - 1)];
        // As a viewer does it: the base, and of each target as much as its weight.
        let sum = |base: [f32; 3], of: &dyn Fn(usize) -> [f32; 3]| {
            let mut sum = base;
            for (target, weight) in weights.iter().enumerate() {
                let offset = of(target);
                sum = [0, 1, 2].map(|c| sum[c] + weight * offset[c]);
            }
            sum
        };
        let right = normals(simulation);
        for i in 0..simulation.particles() {
            let x = sum(base[i], &|target| targets[target].0[i]);
            assert!(distance(x, simulation.position(i).into()) < 1e-6);
            let normal = sum(base_normals[i], &|target| targets[target].1[i]);
            assert!(distance(normal, right[i]) < 1e-6);
        }
    });

    // The ranges that positions have to say are true.
    for accessor in read
        .accessors()
        .filter(|accessor| accessor.min().is_some() && accessor.size() == 12)
    {
        let vectors: Vec<[f32; 3]> = gltf::accessor::Iter::new(accessor.clone(), data)
            .unwrap()
            .collect();
        let range = |pick: fn(f32, f32) -> f32| {
            let most = |c: usize| vectors.iter().map(|v| v[c]).reduce(pick).unwrap();
            serde_json::json!([most(0), most(1), most(2)])
        };
        assert_eq!(accessor.min().unwrap(), range(f32::min));
        assert_eq!(accessor.max().unwrap(), range(f32::max));
    }
}

#[test]
fn glb_without_a_surface_is_lines_and_points() {
    use gltf::mesh::Mode;
    let folder = tempfile::tempdir().unwrap();
    for (scene, modes) in [
        ("chain", &[(Mode::Lines, 6), (Mode::Points, 4)][..]),
        ("simple", &[(Mode::Points, 1)]),
    ] {
        write(folder.path(), scene, "x.glb", &[]);
        let read = gltf::Gltf::from_slice(&fs::read(folder.path().join("x.glb")).unwrap()).unwrap();
        let mesh = read.meshes().next().unwrap();
        let found: Vec<_> = mesh
            .primitives()
            .map(|primitive| (primitive.mode(), primitive.indices().unwrap().count()))
            .collect();
        assert_eq!(found, modes);
        assert!(
            mesh.primitives()
                .all(|primitive| primitive.morph_targets().len() == 6)
        );
    }
}

#[test]
fn assimp_reads_surfaces_and_animations() {
    let folder = tempfile::tempdir().unwrap();
    if is_missing("assimp") {
        return;
    }
    write(folder.path(), "cloth", "x.glb", &[]);
    write(folder.path(), "cloth", "x.obj", &[]);
    for (file, animations) in [("x.glb", "1"), ("x.obj", "0")] {
        let says = asked(folder.path(), "assimp", &["info", file]);
        for (what, right) in [
            ("Vertices:", "400"),
            ("Faces:", "722"),
            ("Animations:", animations),
        ] {
            let line = says.lines().find(|line| line.starts_with(what));
            let line = line.unwrap_or_else(|| panic!("no {what} in\n{says}"));
            assert_eq!(
                line.split_whitespace().last(),
                Some(right),
                "{file}: {line}"
            );
        }
    }
}

#[test]
fn khronos_finds_nothing_to_complain_of() {
    let Some(modules) = std::env::var_os("A3_GLTF_VALIDATOR") else {
        return common::skip("A3_GLTF_VALIDATOR is not set", "A3_REQUIRE_GLTF_VALIDATOR");
    };
    let folder = tempfile::tempdir().unwrap();
    let script = "require('gltf-validator').validateBytes(new Uint8Array(require('fs').readFileSync('x.glb')))
        .then(r => console.log(r.issues.numErrors, r.issues.numWarnings, r.issues.numInfos, r.issues.numHints))";
    for scene in ["cloth", "chain", "simple"] {
        for until in ["0", "0.2"] {
            let words = [
                "simulate", "r", "0.01", "--scene", scene, "--until", until, "--output", "x.glb",
            ];
            assert!(a3(folder.path(), &words).status.success());
            let output = std::process::Command::new("node")
                .args(["-e", script])
                .env("NODE_PATH", &modules)
                .current_dir(folder.path())
                .output()
                .unwrap();
            assert_eq!(
                text(&output.stdout),
                "0 0 0 0\n",
                "{}",
                text(&output.stderr)
            );
        }
    }
}

#[test]
fn a_summary_says_what_became_of_the_energy() {
    let folder = tempfile::tempdir().unwrap();
    let read = |name: &str| -> Value {
        serde_json::from_slice(&fs::read(folder.path().join(name)).unwrap()).unwrap()
    };
    write(
        folder.path(),
        "cloth",
        "x.json",
        &["--fps", "25", "--summary", "s.json"],
    );
    let (summary, states) = (read("s.json"), read("x.json"));
    let last = &states[COUNT - 1];
    assert_eq!(summary["frames"], COUNT);
    for number in ["time", "steps", "evaluations"] {
        assert_eq!(summary[number], last[number]);
    }
    let energy = |k: usize| states[k]["energy"].as_f64().unwrap();
    assert_eq!(summary["energy"]["begin"], energy(0));
    assert_eq!(summary["energy"]["end"], energy(COUNT - 1));
    let drift = summary["energy"]["largest_drift"].as_f64().unwrap();
    let at_frames = (0..COUNT).map(|k| (energy(k) - energy(0)).abs());
    assert!(drift >= at_frames.fold(0.0, f64::max) && drift > 0.0);
    let stretch = summary["largest_stretch"].as_f64().unwrap();
    assert!(stretch > 1.0 && stretch < 3.0, "{stretch}");
    assert!(summary["wall_time"].as_f64().unwrap() > 0.0);
    // A system without forces has no energy and no springs.
    let said = write(folder.path(), "simple", "x.csv", &["--summary", "-"]);
    let summary: Value = serde_json::from_str(&said).unwrap();
    assert!(summary["energy"].is_null() && summary["largest_stretch"].is_null());
    assert_eq!(summary["frames"], 7);
}

#[test]
fn exports_that_cannot_be_are_refused_before_the_work() {
    let folder = tempfile::tempdir().unwrap();
    let long = |grid, output, more: &[&'static str]| {
        let run = [
            "simulate", "v", "0.01", "--until", "100", "--grid", grid, "--output", output,
        ];
        [&run[..], more].concat()
    };
    for (words, says) in [
        (long("5x5", "x.txt", &[]), ".json, .csv, .obj, .pc2 or .glb"),
        (long("5x5", "-", &["--fps", "25"]), "final state"),
        (long("5x5", "-", &["--summary", "-"]), "not both"),
        (long("5x5", "x.json", &["--summary", "s.txt"]), ".json"),
        (long("5x5", "x.json", &["--fps", "0"]), "such as 30"),
        (long("5x5", "x.obj", &["--fps", "25"]), "cloth-####.obj"),
        (long("5x5", "x-###.obj", &[]), "4 digits"),
        (
            long("5x5", "x.glb", &[]),
            "3001 frames are too many for a .glb, which has at most 600",
        ),
        (
            long("1000x1000", "x.glb", &["--fps", "5"]),
            "11.2 GiB, and 4 GiB",
        ),
        (long("1000x1000", "x.pc2", &[]), "33.5 GiB, and 16 GiB"),
        (long("1000x1000", "x.csv", &[]), "GiB"),
        (long("1000x1000", "x-####.obj", &[]), "GiB"),
        (long("1000x1000", "x.json", &["--fps", "30"]), "GiB"),
    ] {
        let line = complaint(&a3(folder.path(), &words), 2);
        assert!(
            line.starts_with("error: ") && line.contains(says),
            "{words:?}: {line}"
        );
    }
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// Files are whole or absent, and hold nothing that is no number.
#[test]
fn a_run_that_blows_up_leaves_only_the_whole_files_of_a_sequence() {
    let folder = tempfile::tempdir().unwrap();
    let run = |more: &[&str]| {
        let words = [
            "simulate",
            "rk4",
            "0.04",
            "--scene",
            "mit",
            "--until",
            "8",
            "--summary",
            "s.json",
            "--output",
        ];
        complaint(&a3(folder.path(), &[&words[..], more].concat()), 1)
    };
    // Frames a step, which none shortens.
    let several = ["--fps", "25"];
    for output in ["x.json", "x.obj"] {
        assert!(run(&[output]).contains("blew up at step"));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "{output}");
    }
    for output in ["x.json", "x.csv", "x.pc2", "x.glb"] {
        let line = run(&[&[output], &several[..]].concat());
        assert!(
            line.contains("blew up at step") && line.ends_with("nothing was written"),
            "{line}"
        );
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0, "{output}");
    }
    let line = run(&[&["x-###.obj"], &several[..]].concat());
    let count = fs::read_dir(folder.path()).unwrap().count();
    assert!((2..200).contains(&count), "{count}");
    assert!(
        line.ends_with(&format!("x-###.obj has the first {count} of 201 frames")),
        "{line}"
    );
    for entry in fs::read_dir(folder.path()).unwrap() {
        let obj = fs::read_to_string(entry.unwrap().path()).unwrap();
        assert!(obj.contains("\nf ") && !obj.contains("NaN") && !obj.contains("inf"));
    }
}

#[test]
#[cfg(unix)]
fn an_interrupted_export_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    for output in ["x.csv", "x.pc2", "x.glb"] {
        let words = ["simulate", "v", "1e-5", "--until", "19", "--output", output];
        let child = command(folder.path(), &words).spawn().unwrap();
        std::thread::sleep(std::time::Duration::from_millis(400));
        let interrupt = std::process::Command::new("kill")
            .args(["-INT", &child.id().to_string()])
            .status();
        assert!(interrupt.unwrap().success());
        let line = complaint(&child.wait_with_output().unwrap(), 130);
        assert_eq!(line, "interrupted: nothing was written");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
