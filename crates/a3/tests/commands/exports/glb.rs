//! Animations as glTF.

use std::process::Command;

use super::{COUNT, RATE, distance, normals, run, triangles, write};
use crate::common::{Folder, asked, is_missing, skip, succeed, text};

#[test]
fn glb_goes_from_frame_to_frame() {
    let folder = &Folder::new();
    write(folder, "cloth", "x.glb --fps 25");
    let read = gltf::Gltf::from_slice(&folder.bytes("x.glb")).unwrap();
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
    assert_eq!(channel.target().property(), gltf::animation::Property::MorphTargetWeights);
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
        // As a viewer does it: the base plus each target times its weight.
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

    // The ranges of positions are true.
    for accessor in
        read.accessors().filter(|accessor| accessor.min().is_some() && accessor.size() == 12)
    {
        let vectors: Vec<[f32; 3]> =
            gltf::accessor::Iter::new(accessor.clone(), data).unwrap().collect();
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
    let folder = &Folder::new();
    for (scene, modes) in
        [("chain", &[(Mode::Lines, 6), (Mode::Points, 4)][..]), ("simple", &[(Mode::Points, 1)])]
    {
        write(folder, scene, "x.glb");
        let read = gltf::Gltf::from_slice(&folder.bytes("x.glb")).unwrap();
        let mesh = read.meshes().next().unwrap();
        let found: Vec<_> = mesh
            .primitives()
            .map(|primitive| (primitive.mode(), primitive.indices().unwrap().count()))
            .collect();
        assert_eq!(found, modes);
        assert!(mesh.primitives().all(|primitive| primitive.morph_targets().len() == 6));
    }
}

#[test]
fn assimp_reads_surfaces_and_animations() {
    let folder = &Folder::new();
    if is_missing("assimp") {
        return;
    }
    write(folder, "cloth", "x.glb");
    write(folder, "cloth", "x.obj");
    for (file, animations) in [("x.glb", "1"), ("x.obj", "0")] {
        let says = asked(folder, "assimp", ["info", file]);
        for (what, right) in [("Vertices:", "400"), ("Faces:", "722"), ("Animations:", animations)]
        {
            let line = says.lines().find(|line| line.starts_with(what));
            let line = line.unwrap_or_else(|| panic!("no {what} in\n{says}"));
            assert_eq!(line.split_whitespace().last(), Some(right), "{file}: {line}");
        }
    }
}

#[test]
fn khronos_finds_nothing_to_complain_of() {
    let Some(modules) = std::env::var_os("A3_GLTF_VALIDATOR") else {
        return skip("A3_GLTF_VALIDATOR is not set", "A3_REQUIRE_GLTF_VALIDATOR");
    };
    let folder = &Folder::new();
    let script = "require('gltf-validator').validateBytes(new Uint8Array(require('fs').readFileSync('x.glb')))
        .then(r => console.log(r.issues.numErrors, r.issues.numWarnings, r.issues.numInfos, r.issues.numHints))";
    for scene in ["cloth", "chain", "simple"] {
        for until in ["0", "0.2"] {
            let run = format!("simulate r 0.01 --scene {scene} --until {until} --output x.glb");
            succeed(folder, run);
            let output = Command::new("node")
                .args(["-e", script])
                .env("NODE_PATH", &modules)
                .current_dir(folder)
                .output()
                .unwrap();
            assert_eq!(text(&output.stdout), "0 0 0 0\n", "{}", text(&output.stderr));
        }
    }
}
