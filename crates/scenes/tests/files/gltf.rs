//! glTF files of engines and other programs.

use a3_scenes::Mesh;
use base64::Engine;
use serde_json::{Value, json};

use crate::{area, begins, counts, data, vector_area};

fn read(bytes: &[u8]) -> Result<Mesh, String> {
    Mesh::from_gltf(bytes, &mut |name| match name {
        "my cloth.bin" => Ok(data(name)),
        "100%.bin" => Ok(data("my cloth.bin")),
        other => Err(format!("{other}: there is no such file")),
    })
}

fn file(name: &str) -> Mesh {
    read(&data(name)).unwrap()
}

/// Returns the least and the greatest coordinates.
fn extent(mesh: &Mesh) -> [[f64; 3]; 2] {
    let along = |k: usize, pick| mesh.positions.iter().map(|p| p[k]).reduce(pick).unwrap();
    [f64::min, f64::max].map(|pick: fn(f64, f64) -> f64| [0, 1, 2].map(|k| along(k, pick)))
}

/// Creates a document with a triangle with the corners (0, 0, 0), (1, 0, 0) and (0, 1, 0), with
/// joints and weights, all in one buffer, and two targets, the second of them sparse.
fn triangle() -> Value {
    let mut bytes = vec![];
    let mut views = vec![];
    let mut add = |part: &[u8]| {
        views.push(json!({"buffer": 0, "byteOffset": bytes.len(), "byteLength": part.len()}));
        bytes.extend(part);
        bytes.resize(bytes.len().next_multiple_of(4), 0);
    };
    let floats =
        |numbers: &[f32]| -> Vec<u8> { numbers.iter().flat_map(|x| x.to_le_bytes()).collect() };
    add(&floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0.]));
    add(&[0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0]);
    add(&[255, 0, 0, 0, 0, 255, 0, 0, 51, 204, 0, 0]);
    add(&floats(&[0., 0., 4., 0., 0., 4., 0., 0., 4.]));
    add(&[2, 0]);
    add(&floats(&[0., 2., 0.]));
    // Inverse bind matrices of two joints: identity, and 5 m back along x.
    let mut inverse = [0.0; 32];
    for k in [0, 5, 10, 15] {
        (inverse[k], inverse[16 + k]) = (1.0, 1.0);
    }
    inverse[28] = -5.0;
    add(&floats(&inverse));
    // The same corners in bytes and in fractions of 32767.
    add(&[0, 0, 0, 0, 100, 0, 0, 0, 0, 100, 0, 0]);
    add(&[0u16, 0, 0, 0, 32767, 0, 0, 0, 0, 32767, 0, 0].map(u16::to_le_bytes).concat());
    views[7]["byteStride"] = 4.into();
    views[8]["byteStride"] = 8.into();
    let uri = base64::engine::general_purpose::STANDARD.encode(&bytes);
    json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{
            "attributes": {"POSITION": 0, "JOINTS_0": 1, "WEIGHTS_0": 2},
            "targets": [{"POSITION": 3}, {"POSITION": 4}],
        }]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5121, "count": 3, "type": "VEC4"},
            {"bufferView": 2, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC4"},
            {"bufferView": 3, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"componentType": 5126, "count": 3, "type": "VEC3", "sparse": {"count": 1,
                "indices": {"bufferView": 4, "componentType": 5121}, "values": {"bufferView": 5}}},
            {"bufferView": 6, "componentType": 5126, "count": 2, "type": "MAT4"},
            {"bufferView": 7, "componentType": 5120, "count": 3, "type": "VEC3"},
            {"bufferView": 8, "componentType": 5122, "normalized": true, "count": 3, "type": "VEC3"},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": bytes.len(), "uri": format!("data:application/octet-stream;base64,{uri}")}],
    })
}

/// Reads that document after a change.
fn changed(change: impl Fn(&mut Value)) -> Result<Mesh, String> {
    let mut document = triangle();
    change(&mut document);
    read(document.to_string().as_bytes())
}

/// Returns the corners of the triangle after a change of its document.
fn corners(change: impl Fn(&mut Value)) -> Vec<[f64; 3]> {
    changed(change).unwrap().positions
}

#[test]
fn names_are_unescaped() {
    let mesh = file("encoded.gltf");
    assert_eq!(counts(&mesh), [16, 18]);
    let text = String::from_utf8(data("encoded.gltf")).unwrap();
    for name in ["my cloth.bin", "my%20cloth%2ebin", "100%.bin", "100%25.bin"] {
        let named = text.replace("my%20cloth.bin", name);
        assert_eq!(read(named.as_bytes()).unwrap(), mesh);
    }
    let why = read(text.replace("my%20cloth.bin", "no%20such.bin").as_bytes()).unwrap_err();
    assert!(why.starts_with("no such.bin: "), "{why}");
}

/// A reflection of a node reverses its triangles, two reflections do not.
#[test]
fn mirrors_turn_triangles() {
    let mesh = file("mirror.gltf").welded();
    // Two boxes without the faces between them: closed, with a volume of 2 m3.
    assert_eq!(counts(&mesh), [12, 20]);
    let volume = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| a3_core::Vector3::from(mesh.positions[i as usize]));
        a.dot(&b.cross(&c))
    };
    let volume: f64 = mesh.triangles.iter().map(volume).sum();
    assert!((volume / 6.0 - 2.0).abs() < 1e-12, "{volume}");
    let normal =
        |nodes: Value| vector_area(&changed(|document| document["nodes"] = nodes.clone()).unwrap());
    let through = [-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1];
    let nested = json!([{"children": [1], "scale": [1, -1, 1]}, {"mesh": 0, "scale": [-1, 1, 1]}]);
    for (nodes, z) in [
        (json!([{"mesh": 0}]), 0.5),
        (json!([{"mesh": 0, "scale": [-1, 1, 1]}]), 0.5),
        (nested, 0.5),
        (json!([{"mesh": 0, "matrix": through}]), -0.5),
    ] {
        assert_eq!(normal(nodes.clone()), [0.0, 0.0, z], "{nodes}");
    }
}

#[test]
fn seams_between_nodes_are_welded() {
    let mesh = file("seam.gltf");
    assert_eq!(mesh.positions.len(), 32);
    let mesh = mesh.welded();
    assert_eq!(counts(&mesh), [28, 36]);
}

/// Targets are added with the weights of the node, or else of the mesh.
#[test]
fn targets_have_their_weights() {
    let mesh = file("morph.gltf");
    assert_eq!(extent(&mesh), [[0.0; 3], [3.0, 1.0, 0.0]]);
    assert_eq!(corners(|_| {})[2], [0.0, 1.0, 0.0]);
    let moved = corners(|document| document["meshes"][0]["weights"] = json!([0.5, 0.25]));
    assert_eq!(moved, [[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 1.5, 2.0]]);
    let moved = corners(|document| {
        document["meshes"][0]["weights"] = json!([0.5, 0.25]);
        document["nodes"][0]["weights"] = json!([0, 1]);
    });
    assert_eq!(moved, [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 3.0, 0.0]]);
}

/// Joints move a skinned mesh, wherever its node is.
#[test]
fn joints_carry_skins() {
    assert_eq!(extent(&file("skin.gltf")), [[0.0; 3], [1.0, 1.0, 0.0]]);
    let carried = corners(|document| {
        document["skins"] = json!([{"joints": [2, 3], "inverseBindMatrices": 5}]);
        document["nodes"] = json!([
            {"mesh": 0, "skin": 0, "translation": [100, 0, 0], "scale": [1, 3, 1]},
            {"children": [2], "translation": [0, 7, 0]},
            {"children": [3], "translation": [0, 0, 1]},
            {"scale": [10, 1, 1]},
        ]);
        document["scenes"] = json!([{"nodes": [0, 1]}]);
    });
    // The second joint is at (0, 7, 1) and stretches the part beyond 5 m.
    let expected = [[0.0, 7.0, 1.0], [-40.0, 7.0, 1.0], [0.8 * -50.0, 8.0, 1.0]];
    for (at, expected) in carried.iter().zip(expected) {
        let is_there = (0..3).all(|k| (at[k] - expected[k]).abs() < 1e-6);
        assert!(is_there, "{at:?} {expected:?}");
    }
}

/// Positions are whole numbers, as they are, or as fractions of the largest one.
#[test]
fn positions_may_be_whole_numbers() {
    let quantized = |accessor: usize| {
        corners(|document| {
            document["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
            document["meshes"][0]["primitives"][0]["attributes"] = json!({"POSITION": accessor});
        })
    };
    for (accessor, side) in [(6, 100.0), (7, 1.0)] {
        let corners = [[0.0; 3], [side, 0.0, 0.0], [0.0, side, 0.0]];
        assert_eq!(quantized(accessor), corners);
    }
}

#[test]
fn extensions_that_touch_no_geometry_are_passed_over() {
    let mesh = file("lights.gltf");
    assert_eq!(counts(&mesh), [16, 18]);
    assert!((area(&mesh) - 1.0).abs() < 1e-6);
    let text = String::from_utf8(data("lights.gltf")).unwrap();
    let with = |name: &str| read(text.replace("KHR_lights_punctual", name).as_bytes());
    let harmless = "KHR_materials_unlit KHR_texture_transform EXT_texture_webp KHR_xmp_json_ld";
    for name in harmless.split(' ') {
        assert_eq!(with(name).unwrap(), mesh, "{name}");
    }
    let needed = "EXT_mesh_gpu_instancing KHR_draco_mesh_compression EXT_meshopt_compression";
    for name in needed.split(' ') {
        let why = with(name).unwrap_err();
        let advice = why.ends_with(": save it without compression");
        let is_advised = advice == name.contains("compression");
        assert!(is_advised && why.contains(name), "{why}");
    }
}

#[test]
fn files_of_other_programs_are_read_or_named() {
    let mesh = file("unaligned.glb");
    assert_eq!(counts(&mesh), [16, 18]);
    let marked = [b"\xef\xbb\xbf", &data("lights.gltf")[..]].concat();
    assert_eq!(read(&marked).unwrap(), file("lights.gltf"));
    let old = r#"{"asset": {"version": "1.0"}, "scene": "a", "scenes": {"a": {"nodes": ["b"]}}, "nodes": {"b": {}}}"#;
    let named = "it is glTF 1.0: convert it to glTF 2.0";
    let binary = b"glTF\x01\0\0\0\x14\0\0\0\0\0\0\0\0\0\0\0";
    let said = [old.as_bytes(), binary].map(|file| read(file).unwrap_err());
    assert_eq!(said, [named; 2]);
    let why = read(triangle().to_string().replace("2.0", "3.0").as_bytes()).unwrap_err();
    assert_eq!(why, "it is glTF 3.0: convert it to glTF 2.0");
    // Padding of zeros.
    let mut json = triangle().to_string().into_bytes();
    json.resize(json.len().next_multiple_of(4) + 4, 0);
    let mut glb = b"glTF\x02\0\0\0\0\0\0\0".to_vec();
    glb.extend((json.len() as u32).to_le_bytes());
    glb.extend(b"JSON");
    glb.extend(json);
    assert_eq!(read(&glb).unwrap().positions.len(), 3);
}

/// Primitives that share the points of an accessor all have their points, though each uses a few.
#[test]
fn primitives_share_points() {
    let mut document = triangle();
    document["accessors"][0] = json!({"componentType": 5126, "count": 200_000, "type": "VEC3",
        "sparse": {"count": 1, "indices": {"bufferView": 4, "componentType": 5121}, "values": {"bufferView": 5}}});
    let corners = json!({"bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR"});
    document["accessors"][1] = corners;
    let primitive = json!({"attributes": {"POSITION": 0}, "indices": 1});
    document["meshes"][0]["primitives"] = vec![primitive.clone(); 20].into();
    // Two of the corners are at one place.
    let flat = read(document.to_string().as_bytes()).unwrap_err();
    assert_eq!(flat, "the triangles of the file have no area");
    document["meshes"][0]["primitives"] = vec![primitive; 20_000].into();
    let begun = std::time::Instant::now();
    let why = read(document.to_string().as_bytes()).unwrap_err();
    begins(why, "its primitives read points more than");
    assert!(begun.elapsed().as_secs() < 10);
}

/// Files that ask for more work than any mesh needs are refused.
#[test]
fn targets_and_joints_are_counted() {
    let begun = std::time::Instant::now();
    let why = changed(|document| {
        let many = json!({"componentType": 5126, "count": 1_000_000, "type": "VEC3"});
        document["accessors"][0] = many;
        let primitive = &mut document["meshes"][0]["primitives"][0];
        primitive["targets"] = vec![json!({"POSITION": 0}); 10_000].into();
        document["meshes"][0]["weights"] = vec![1; 10_000].into();
    });
    let why = why.unwrap_err();
    assert!(why.contains("points more than"), "{why}");
    let node = json!({"mesh": 0, "skin": 0});
    let circle = json!([node, {"children": [2]}, {"children": [1]}]);
    #[rustfmt::skip]
    let cases = [
        (json!([0]), json!([node]), "a point has a joint that is not among the 1"),
        (json!([0, 9]), json!([node]), "there is no joint 9"),
        (json!([1, 2]), circle, "there is no joint 1 in a tree"),
        (json!([1, 2]), json!([node, {"children": [2, 2]}, {}]), "node 2 has two parents"),
        (json!([1, 2]), json!([node, {"children": [7]}, {}]), "there is no node 7"),
    ];
    for (joints, nodes, expected) in cases {
        let read = changed(|document| {
            document["skins"] = json!([{"joints": joints}]);
            document["nodes"] = nodes.clone();
        });
        let why = read.unwrap_err();
        assert!(why.contains(expected), "{why}");
    }
    assert!(begun.elapsed().as_secs() < 10);
}
