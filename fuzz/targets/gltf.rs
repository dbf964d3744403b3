//! Meshes in glTF, with external files of 60 bytes each.
#![no_main]

use a3_scenes::Mesh;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = Mesh::from_gltf(bytes, &mut |_| Ok(vec![0; 60])).map(|mesh| mesh.welded());
});
