//! Scenes from files: which are read, which are refused, and the places that errors name.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use crate::common::{Folder, a3, complaint, simulate, succeed, text};
use a3_scenes::Description;
use serde_json::Value;

const SQUARE: &str = "\
[[mesh]]
file = \"square.obj\"
density = 3
stiffness = [7, 2]
";

/// Scenes with states that other programs computed reach these states.
#[test]
fn listed_particles_and_springs_are_a_scene() {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../core/tests/reference"));
    for name in ["pendulum", "pendulum_drag", "chain", "mit", "cloth_damped"] {
        let file = format!("{name}.json");
        let listed: Value = serde_json::from_slice(&fs::read(folder.join(&file)).unwrap()).unwrap();
        let state = &listed["states"][0];
        let until = state["time"].to_string();
        let run = simulate(folder, format!("x 1e-11 --scene {file} --until {until}"));
        assert_eq!(run["scene"], listed["name"]);
        let rows = |value: &Value| -> Vec<f64> {
            let rows = value.as_array().unwrap().iter();
            rows.flat_map(|row| row.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()))
                .collect()
        };
        let (ours, theirs) = (rows(&run["positions"]), rows(&state["positions"]));
        let error = ours.iter().zip(&theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(ours.len() == theirs.len() && error < 1e-7, "{name}: {error:e}");
    }
}

/// The printed file of a scene gives the same scene.
#[test]
fn a_printed_scene_is_the_scene() {
    let folder = &Folder::new();
    for name in ["cloth", "simple", "mit-sphere", "jelly", "cantilever", "double-pendulum", "flag"]
    {
        let printed = a3(folder, format!("scenes --print {name}"));
        let file = format!("{name}.toml");
        folder.write(&file, &printed.stdout);
        let run = |scene: &str| {
            let run = format!("r 0.01 --scene {scene} --until 0.2");
            let mut state = simulate(folder, run);
            state.as_object_mut().unwrap().remove("wall_time");
            state
        };
        assert_eq!(run(name), run(&file), "{name}");
    }
    let schema = a3(folder, "scenes --schema");
    let schema: Value = serde_json::from_slice(&schema.stdout).unwrap();
    assert!(schema["properties"]["cloth"].is_object());
}

/// A scene names its solver, step and duration, and the command line takes precedence.
#[test]
fn a_scene_brings_its_solver_its_step_and_its_time() {
    let folder = &Folder::new();
    let scene = "solver = \"verlet\"\nstep = 0.02\nduration = 0.5\n\
        [[chain]]\nparticles = 2\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nmass = 1\nstiffness = 5\n";
    folder.write("own.toml", scene);
    let run = simulate(folder, "--scene own.toml");
    assert_eq!(
        (&run["scene"], &run["solver"], &run["step"], &run["time"]),
        (&"own".into(), &"verlet".into(), &0.02.into(), &0.5.into())
    );
    let run = simulate(folder, "r --scene own.toml --until 1");
    assert_eq!(
        (&run["solver"], &run["step"], &run["time"]),
        (&"rk4".into(), &0.01.into(), &1.0.into())
    );
    folder.write("no-time.toml", scene.replace("duration = 0.5\n", ""));
    let said = complaint(&a3(folder, "simulate --scene no-time.toml --output -"), 2);
    assert!(said.contains("--until"), "{said}");
}

/// The same square as OBJ, as glTF with its data inside, and as GLB.
#[test]
fn meshes_are_read() {
    let folder = &Folder::new();
    let at = |name: &str| folder.join(name);
    // A quad, with a texture seam that has a corner twice.
    let obj = "mtllib none.mtl\no a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nusemtl red\nf 1/1 2/1 3/1 4/1\n";
    fs::write(at("square.obj"), obj).unwrap();
    let mut bytes = vec![];
    for x in [0f32, 0., 0., 1., 0., 0., 1., 1., 0., 0., 1., 0.] {
        bytes.extend(x.to_le_bytes());
    }
    for i in [0u16, 1, 2, 0, 2, 3] {
        bytes.extend(i.to_le_bytes());
    }
    let json = |uri: &str| {
        format!(
            "{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[0]}}],\"nodes\":[{{\"mesh\":0}}],\
             \"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0}},\"indices\":1}}]}}],\
             \"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,0]}},\
             {{\"bufferView\":1,\"componentType\":5123,\"count\":6,\"type\":\"SCALAR\"}}],\
             \"bufferViews\":[{{\"buffer\":0,\"byteOffset\":0,\"byteLength\":48}},{{\"buffer\":0,\"byteOffset\":48,\"byteLength\":12}}],\
             \"buffers\":[{{{uri}\"byteLength\":60}}]}}"
        )
    };
    fs::write(at("square.bin"), &bytes).unwrap();
    fs::write(at("square.gltf"), json("\"uri\":\"square.bin\",")).unwrap();
    let mut chunk = json("").into_bytes();
    chunk.resize(chunk.len().div_ceil(4) * 4, b' ');
    let mut glb = b"glTF\x02\0\0\0".to_vec();
    glb.extend((12 + 8 + chunk.len() as u32 + 8 + 60).to_le_bytes());
    for (kind, data) in [(b"JSON", &chunk), (b"BIN\0", &bytes)] {
        glb.extend((data.len() as u32).to_le_bytes());
        glb.extend(kind);
        glb.extend(data);
    }
    fs::write(at("square.glb"), glb).unwrap();
    let mut states = vec![];
    for ending in ["obj", "gltf", "glb"] {
        fs::write(at("scene.toml"), SQUARE.replace("obj", ending)).unwrap();
        states.push(simulate(folder, "r 0.01 --scene scene.toml --until 0.1"));
    }
    assert_eq!(states[0]["positions"].as_array().unwrap().len(), 4);
    assert!(states[0] == states[1] && states[1] == states[2]);
}

#[test]
fn what_is_wrong_is_said_with_file_and_line() {
    let folder = &Folder::new();
    let at = |name: &str| folder.join(name);
    let refused = |scene: &str| {
        let begun = Instant::now();
        let run = format!("simulate r 0.01 --scene {scene} --until 1 --output -");
        let said = complaint(&a3(folder, run), 2);
        assert!(begun.elapsed() < Duration::from_secs(5), "{said}");
        said
    };
    fs::write(at("typo.toml"), "gravity = [0, -9.81, 0]\n\n[[chian]]\n").unwrap();
    let said = refused("typo.toml");
    assert!(
        said.starts_with(
            "error: typo.toml:3: chian: there is no key `chian`; did you mean `chain`?"
        ),
        "{said}"
    );
    let said = refused("clth");
    assert!(
        said.contains("there is no such scene; did you mean cloth? The scenes are cloth, simple, "),
        "{said}"
    );
    assert_eq!(
        refused("gone.toml"),
        "error: gone.toml: it could not be read: there is no such file or folder"
    );
    fs::create_dir(at("folder.toml")).unwrap();
    assert!(refused("folder.toml").contains("folder.toml: it is not an ordinary file"));
    fs::write(at("latin.toml"), b"name = \"\xe9\"").unwrap();
    assert!(refused("latin.toml").contains("is not UTF-8 text: see byte 8"));
    fs::write(at("list.json"), "{\n\"mass\": [1],\n\"position\": []}").unwrap();
    assert!(refused("list.json").starts_with(
        "error: list.json:3: position: there is no key `position`; did you mean `positions`? The valid keys are name, "
    ));
    for (name, content) in [
        ("none.obj", ""),
        ("far.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"),
        ("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"),
        ("junk.glb", "glTF\x02\0\0\0\0\0\0\0"),
        ("junk.gltf", "{}"),
        ("deep.gltf", &"[".repeat(100_000)),
    ] {
        fs::write(at(name), content).unwrap();
        fs::write(at("scene.toml"), SQUARE.replace("square.obj", name)).unwrap();
        let said = refused("scene.toml");
        assert!(said.starts_with("error: scene.toml:2: mesh.file: "), "{name}: {said}");
    }
    for name in ["../square.obj", "/etc/passwd", "a/../../b.obj", ""] {
        fs::write(at("scene.toml"), SQUARE.replace("square.obj", name)).unwrap();
        let said = refused("scene.toml");
        assert!(said.contains("must be in the scene's folder or below it"), "{said}");
    }
    fs::write(at("long.toml"), vec![b'#'; 17 << 20]).unwrap();
    assert!(refused("long.toml").contains("long.toml: it is larger than 16 MiB"));
    fs::write(at("line.toml"), vec![b'#'; 9 << 20]).unwrap();
    assert!(
        refused("line.toml").contains("line 1 is longer than 8 MiB")
            || refused("line.toml").starts_with("error: line.toml:1")
    );
    let said = complaint(&a3(folder, "--scene cloth --watch"), 2);
    assert!(said.contains("--watch needs a scene file"), "{said}");
}

/// A chart of a scene file does not continue from the data of another scene with the same name.
#[test]
fn a_chart_knows_which_scene_it_has() {
    let folder = &Folder::new();
    let chain = |stiffness: &str| {
        format!(
            "name = \"own\"\n[[chain]]\nparticles = 2\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nmass = 1\nstiffness = {stiffness}\nvelocity = [0, 1, 0]\npin = [{{ at = [\"first\"] }}]\n"
        )
    };
    let chart = |stiffness: &str| {
        folder.write("own.toml", chain(stiffness));
        let words = "chart --scene own.toml --solvers r --until 0.2 --work evaluations --data own.csv --output own.svg";
        succeed(folder, words);
        folder.read("own.csv").lines().count()
    };
    let first = chart("5");
    assert_eq!(chart("5"), first);
    assert!(chart("500") > first);
}

/// The scenes in the documentation run for their duration, and the examples in its text can be
/// read.
#[test]
fn documented_scenes_are_scenes() {
    let docs = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs"));
    let files = fs::read_dir(docs.join("scenes")).unwrap();
    let files = files.map(|entry| entry.unwrap().path());
    let scenes: Vec<_> =
        files.filter(|file| file.extension().is_some_and(|e| e == "toml")).collect();
    assert_eq!(scenes.len(), 25);
    for file in scenes {
        let text = fs::read_to_string(&file).unwrap();
        let description = Description::parse(&text).unwrap();
        let run = simulate(docs, ["--scene", file.to_str().unwrap()]);
        assert_eq!(run["time"].as_f64(), description.duration, "{file:?}");
    }
    let guide = fs::read_to_string(docs.join("scenes.md")).unwrap();
    let examples: Vec<_> = guide.split("```toml\n").skip(1).collect();
    assert!(examples.len() >= 9, "{}", examples.len());
    for example in examples {
        let text = example.split("```").next().unwrap();
        if let Err(fault) = Description::parse(text) {
            panic!("{fault}\n{text}");
        }
    }
}

/// A level mesh that is pinned by its top is pinned everywhere, and a note says so.
#[test]
fn a_scene_that_is_pinned_all_over_says_so() {
    let folder = &Folder::new();
    let square = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nf 1 2 3 4\n";
    folder.write("square.obj", square);
    folder.write("level.toml", format!("{SQUARE}pin = [{{ at = [\"top\"] }}]\n"));
    let words = "simulate r 0.01 --scene level.toml --until 0.1 --output -";
    let output = succeed(folder, words);
    let said = text(&output.stderr);
    assert_eq!(said, "note: all 4 particles of the scene level are pinned\n");
}

/// A bead whose velocity has a part across its wire loses that part, and a command that builds the
/// scene several times says so once.
#[test]
fn a_start_that_does_not_fit_is_told_once() {
    let folder = &Folder::new();
    let wire = "[particles]\npositions = [[1, 0, 0]]\nmass = 1\nvelocities = [[0.6, 1, 0]]\n\
                [[constraint]]\nparticle = 0\n\
                circle = { center = [0, 0, 0], normal = [0, 0, 1], radius = 1 }\n";
    folder.write("wire.toml", wire);
    let words = "simplify --error 1e-2 --until 0.2 --scene";
    let output = succeed(folder, format!("{words} wire.toml"));
    let said = text(&output.stderr);
    let note = "note: the velocities at the start do not fit the constraints: impulses changed \
                them by up to 0.6 m/s";
    assert_eq!(said.lines().filter(|line| *line == note).count(), 1, "{said}");
    // A request that cannot be met ends with one line.
    let refused = a3(folder, "simulate xpbd --until 1 -o x.json --scene wire.toml");
    complaint(&refused, 2);
    let refused = a3(folder, "simulate r --until 1 -o nowhere/x.json --scene wire.toml");
    complaint(&refused, 1);
}
