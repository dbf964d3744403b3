//! Fluids in files: their particles, and a surface that is another mesh in each frame.

use std::path::Path;

use crate::common::{Folder, succeed};

/// Writes two frames of the dam break. Of its 962 particles, 512 are not in the walls.
fn write(folder: &Path, output: &str) {
    let words =
        format!("simulate r 0.002 --scene dam-break --until 0.04 --fps 25 --output {output}");
    succeed(folder, words);
}

#[test]
fn an_obj_has_the_surface_of_a_fluid_after_its_particles() {
    let folder = &Folder::new();
    write(folder, "f-#.obj");
    for k in 1..=2 {
        let obj = folder.read(&format!("f-{k}.obj"));
        let (particles, liquid) = obj.split_once("o liquid\n").unwrap();
        let count = |text: &str, keyword: &str| {
            let has = |line: &&str| line.starts_with(&format!("{keyword} "));
            text.lines().filter(has).count()
        };
        assert_eq!(["v", "p", "f"].map(|keyword| count(particles, keyword)), [962, 512, 0]);
        let [vertices, normals, faces] = ["v", "vn", "f"].map(|keyword| count(liquid, keyword));
        // Each vertex of the file has a normal.
        assert_eq!(count(particles, "vn"), 962);
        assert!(vertices == normals && vertices > 1000 && faces > vertices, "{vertices}, {faces}");
        for line in liquid.lines().filter(|line| line.starts_with("f ")) {
            for corner in line.split(' ').skip(1) {
                let (v, vn) = corner.split_once("//").unwrap();
                let [v, vn]: [usize; 2] = [v, vn].map(|i| i.parse().unwrap());
                assert!(v == vn && (963..=962 + vertices).contains(&v), "{line}");
            }
        }
    }
}

#[test]
fn a_glb_shows_the_surface_of_each_frame_in_its_turn() {
    let folder = &Folder::new();
    write(folder, "f.glb");
    let read = gltf::Gltf::from_slice(&folder.bytes("f.glb")).unwrap();
    let blob = read.blob.as_deref().unwrap();
    let data = |_: gltf::Buffer<'_>| Some(blob);
    let nodes: Vec<_> = read.default_scene().unwrap().nodes().collect();
    assert_eq!(nodes.len(), 3);
    for (node, size) in nodes[1..].iter().zip([1.0, 0.0]) {
        assert_eq!(node.transform().decomposed().2, [size; 3]);
        let primitive = node.mesh().unwrap().primitives().next().unwrap();
        let reader = primitive.reader(data);
        let vertices = reader.read_positions().unwrap().count();
        assert_eq!(reader.read_normals().unwrap().count(), vertices);
        let indices: Vec<_> = reader.read_indices().unwrap().into_u32().collect();
        assert!(indices.len() > 3000 && indices.iter().all(|i| (*i as usize) < vertices));
    }
    let animation = read.animations().next().unwrap();
    let sizes: Vec<Vec<f32>> = animation
        .channels()
        .filter(|channel| channel.target().property() == gltf::animation::Property::Scale)
        .map(|channel| match channel.reader(data).read_outputs() {
            Some(gltf::animation::util::ReadOutputs::Scales(sizes)) => {
                sizes.map(|s| s[1]).collect()
            }
            _ => panic!("sizes"),
        })
        .collect();
    assert_eq!(sizes, [[1.0, 0.0], [0.0, 1.0]]);
}
