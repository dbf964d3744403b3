//! Hostile files: each is accepted or refused, without a panic and within the memory budget.

#[path = "../common/mod.rs"]
mod common;
mod memory;
mod mutation;

use a3_core::Element;
use a3_scenes::{Description, Fault, Mesh, Places, SCENES, Setup, parse_json, parse_toml};

use common::seed;
use memory::taken;
use mutation::{Random, seeds};

/// Number of inputs of each kind.
const INPUTS: usize = 10_000;

/// Largest memory at once, and in total (bytes).
const MOST: [usize; 2] = [256 << 20, 1 << 30];

/// Gives mutated seeds to a reader, and asserts that it needs little memory and takes some.
fn feed(seeds: &[Vec<u8>], mut takes: impl FnMut(&[u8]) -> bool) {
    let mut random = Random(1);
    let mut count = 0;
    for k in 0..INPUTS {
        let input = random.mutated(seeds);
        let memory = taken(|| count += usize::from(takes(&input)));
        let shown = String::from_utf8_lossy(&input);
        let is_little = memory < MOST && memory[1] < MOST[1];
        assert!(is_little, "input {k} takes {memory:?} bytes:\n{shown}");
    }
    assert!(count > INPUTS / 25, "{count}");
}

/// Gives mutated texts to a reader of scenes.
fn feed_texts(texts: &[Vec<u8>], read: fn(&str) -> Result<(Description, Places), Fault>) {
    feed(texts, |bytes| {
        let Ok(text) = str::from_utf8(bytes) else {
            return false;
        };
        let parsed = read(text).map_err(|fault| said(&fault.to_string()));
        parsed.is_ok_and(|parsed| is_scene(&parsed, text))
    });
}

/// Refuses any file.
fn no_file(name: &str) -> Result<Vec<u8>, String> {
    Err(format!("{name}: there is no such file"))
}

fn mesh(name: &str) -> Result<Mesh, String> {
    let [solid, square] = &seeds("obj")[..] else { panic!("other seeds") };
    match name {
        "solid.obj" => Mesh::from_obj(solid),
        "square.obj" => Mesh::from_obj(square),
        "two.msh" => Mesh::from_gmsh(&seeds("msh")[1]),
        other => no_file(other).map(|_| Mesh::default()),
    }
}

/// Whether a scene can be built. Asserts that all its numbers are finite.
fn is_scene((description, places): &(Description, Places), text: &str) -> bool {
    let built = description.build(None, &mut mesh);
    let Ok(Setup { scene, .. }) = built.map_err(|fault| said(&places.locate(fault).to_string()))
    else {
        return false;
    };
    let mut numbers = scene.state.clone();
    if let Some(network) = scene.model.network() {
        numbers.extend(network.masses());
        for element in network.elements() {
            if let Element::Solid(solid) = element {
                numbers.extend(solid.volumes());
                numbers.extend(solid.material().lame());
            }
        }
        let laws = network.springs().map(|s| s.law);
        numbers.extend(laws.flat_map(|law| [law.stiffness, law.rest_length, law.damping]));
        let obstacles = network.obstacles().iter().map(|obstacle| obstacle.path);
        let paths = obstacles.chain(network.pins().map(|(_, path)| path));
        let points = paths.map(|path| path.at(1.0).position);
        numbers.extend(points.flat_map(|p| [p.x, p.y, p.z]));
    }
    assert!(numbers.iter().all(|x| x.is_finite()), "{text}");
    true
}

/// Asserts that an error has a line or a few, and not a whole file.
fn said(why: &str) {
    assert!(!why.is_empty() && why.len() < 5000, "{why}");
}

#[test]
fn scenes_are_taken_or_refused() {
    let small = SCENES.iter().filter(|entry| entry.text.len() < 2000);
    let mut texts = seeds("scene");
    texts.extend(small.map(|entry| entry.text.into()));
    feed_texts(&texts, parse_toml);
}

#[test]
fn lists_of_particles_are_taken_or_refused() {
    feed_texts(&seeds("list"), parse_json);
}

#[test]
fn obj_stl_and_ply_files_are_taken_or_refused() {
    feed(&seeds("obj"), |bytes| is_mesh(Mesh::from_obj(bytes)));
    feed(&seeds("stl"), |bytes| is_mesh(Mesh::from_stl(bytes)));
    feed(&seeds("ply"), |bytes| is_mesh(Mesh::from_ply(bytes)));
}

#[test]
fn gltf_files_are_taken_or_refused() {
    let buffer = vec![0; 60];
    let mut file = |name: &str| match name {
        "square.bin" => Ok(buffer.clone()),
        other => no_file(other),
    };
    feed(&seeds("gltf"), |bytes| is_mesh(Mesh::from_gltf(bytes, &mut file)));
}

#[test]
fn files_of_gmsh_and_tetgen_are_taken_or_refused() {
    feed(&seeds("msh"), |bytes| is_mesh(Mesh::from_gmsh(bytes)));
    let [ele, node] = &seeds("ele")[..] else { panic!("other seeds") };
    feed(std::slice::from_ref(ele), |bytes| is_mesh(Mesh::from_tetgen(node, bytes)));
    feed(std::slice::from_ref(node), |bytes| is_mesh(Mesh::from_tetgen(bytes, ele)));
}

/// Whether there is a mesh. Asserts that it is complete.
fn is_mesh(mesh: Result<Mesh, String>) -> bool {
    let Ok(mesh) = mesh.map_err(|why| said(&why)) else {
        return false;
    };
    let is_there = |i: &u32| (*i as usize) < mesh.positions.len();
    assert!(mesh.triangles.iter().flatten().all(is_there));
    assert!(mesh.tetrahedra.iter().flatten().all(is_there));
    assert!(mesh.positions.iter().flatten().all(|x| x.is_finite()));
    if !mesh.tetrahedra.is_empty() {
        // A solid with this mesh is refused, or has finite masses.
        let text =
            "solid = [{ file = 'a.msh', density = 1, young = 1, poisson = 0.3, at = [0, 0, 0] }]";
        let description = Description::parse(text).unwrap();
        match description.build(None, &mut |_| Ok(mesh.clone())) {
            Ok(setup) => {
                let network = setup.scene.model.network().unwrap();
                assert!(network.masses().iter().all(|m| m.is_finite() && *m > 0.0));
            }
            Err(fault) => said(&fault.to_string()),
        }
    }
    true
}

/// Inputs of a few hundred bytes that would need hours or gigabytes are refused, for the expected
/// reason and with little memory.
#[test]
fn what_is_too_much_is_refused() {
    let refused = |expected: &str, answer: &mut dyn FnMut() -> Result<Mesh, String>| {
        let mut why = String::new();
        let memory = taken(|| why = answer().unwrap_err());
        let is_brief = why.len() < 5000;
        assert!(why.contains(expected) && is_brief, "{expected}: {why}");
        assert!(memory[0] < MOST[0], "{expected}: {memory:?}");
    };
    let many = "4000000000";
    let (nodes, blocks) = ("$Nodes\nmany\n1 0 0 0\n", "$Nodes\nmany many 1 1\n0 0 0 many\n");
    let elements = "$Elements\nmany 1 1 1\n3 0 4 many\n1 2";
    let gmsh = |version: &str, rest: &str| {
        format!("$MeshFormat\n{version} 8\n{}", rest.replace("many", many))
    };
    for (text, expected) in [
        (gmsh("2.2 0", nodes), "ends within $Nodes"),
        (gmsh("4.1 0", blocks), "ends within"),
        (gmsh("4.1 0", elements), "four corners"),
        (gmsh("4.1 1", ""), "it is Gmsh's format 4.1, binary"),
        (String::new(), "no Gmsh file"),
    ] {
        refused(expected, &mut || Mesh::from_gmsh(text.as_bytes()));
    }
    let face = "element face many\nproperty int a\nend_header\n1 2 3";
    let none = "element none many\nend_header\n";
    for (elements, expected) in [(face, "ends within it"), (none, "no triangles")] {
        let text = format!("ply\nformat ascii 1.0\n{}", elements.replace("many", many));
        refused(expected, &mut || Mesh::from_ply(text.as_bytes()));
    }
    let long = format!("{many} 3 0 0\n0 1 2 3\n");
    refused("ends before all", &mut || Mesh::from_tetgen(long.as_bytes(), b"0 4"));
    for (name, expected) in [("g_dag", "two parents"), ("g_sparse", "more than")] {
        let bytes = seed(&format!("gltf/{name}.gltf"));
        refused(expected, &mut || Mesh::from_gltf(&bytes, &mut no_file));
    }
    let text = |name: &str| String::from_utf8(seed(&format!("scene/{name}"))).unwrap();
    let pinned = |text: &str, count: usize| format!("{CHAIN}pin = [{}]", text.repeat(count));
    for (scene, expected) in [
        (text("pinbomb.toml"), "1440 MiB"),
        (text("folds.toml"), "cloth.folds: it must be"),
        (pinned("{ particles = [0] }, ", 140_000), "it is too long"),
        (pinned("{ at = [\"first\"] }, ", 110_000), "it is too long"),
        (CHAIN.repeat(1001), "1001 bodies"),
        (format!("{}b = 1", "a.".repeat(200_000)), "it is too long"),
        (format!("{} = 1", "0.".repeat(200_000)), "it is too long"),
        ("a ".repeat(1_000_000), "it is too long"),
        (format!("{} = 1", "a".repeat(1_000_000)), "there is no key"),
    ] {
        refused(expected, &mut || {
            let (description, places) = parse_toml(&scene).map_err(|fault| fault.to_string())?;
            let built = description.build(None, &mut mesh).map(|_| Mesh::default());
            built.map_err(|fault| places.locate(fault).to_string())
        });
    }
}

/// The work for large scenes is linear: pins in descending order, and rods one after another.
#[test]
fn what_is_large_is_taken() {
    let numbers: Vec<_> = (0..50_000).rev().map(|i| i.to_string()).collect();
    let long = CHAIN.replace("particles = 2", "particles = 100000");
    let pins = format!("{long}pin = [{{ particles = [{}] }}]", numbers.join(","));
    for text in [pins, format!("{long}rigid = true"), SOLID.into()] {
        let begun = std::time::Instant::now();
        let memory = taken(|| assert!(is_scene(&parse_toml(&text).unwrap(), &text)));
        assert!(memory < MOST, "{memory:?}");
        assert!(begun.elapsed().as_secs() < 10);
    }
}

const CHAIN: &str =
    "\n[[chain]]\nparticles = 2\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nmass = 1\nstiffness = 1\n";

const SOLID: &str = "[[solid]]\ngrid = [40, 32, 28]\nsize = [4, 3.5, 2.9]\ndensity = 1000\nyoung = 1e5\n\
    poisson = 0.3\nat = [0, 0, 0]\n";
