//! Tetrahedra in the formats of Gmsh and TetGen.
#![no_main]

use a3_scenes::Mesh;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let _ = Mesh::from_gmsh(bytes);
    let _ = Mesh::from_tetgen(include_bytes!("../seeds/ele/two.node"), bytes);
    let _ = Mesh::from_tetgen(bytes, include_bytes!("../seeds/ele/two.ele"));
});
