//! Meshes in OBJ.
#![no_main]

use a3_scenes::Mesh;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = Mesh::from_obj(bytes).map(|mesh| mesh.welded());
    let _ = Mesh::from_stl(bytes).map(|mesh| mesh.welded());
    let _ = Mesh::from_ply(bytes).map(|mesh| mesh.welded());
});
