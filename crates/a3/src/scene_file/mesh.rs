//! Meshes of triangles from OBJ and glTF files, and of tetrahedra from those of Gmsh and
//! `TetGen`.

use std::path::Path;

use a3_scenes::Mesh;

use super::files::{beside, read};

/// Length of the files of a scene's meshes and of their buffers, all together (bytes).
pub const LONGEST: u64 = 64 << 20;

/// The triangles or tetrahedra of all objects in a file. `left` is the length of the files that may
/// still be read.
pub fn load(path: &Path, left: &mut u64) -> Result<Mesh, String> {
    let extension = path.extension().and_then(|e| e.to_str());
    let extension = extension.map(str::to_lowercase);
    let mesh = match extension.as_deref() {
        Some("obj") => spend(path, left).and_then(|bytes| Mesh::from_obj(&bytes)),
        Some("gltf" | "glb") => spend(path, left).and_then(|bytes| {
            Mesh::from_gltf(&bytes, &mut |uri| spend(&beside(Some(path), uri)?, left))
        }),
        Some("msh") => spend(path, left).and_then(|bytes| Mesh::from_gmsh(&bytes)),
        Some("ele") => spend(path, left)
            .and_then(|ele| Mesh::from_tetgen(&spend(&path.with_extension("node"), left)?, &ele)),
        _ => Err("a mesh is a file that ends in .obj, .gltf, .glb, .msh or .ele".into()),
    };
    mesh.map_err(|why| format!("{}: {why}", path.display()))
}

/// The bytes of a file, which are taken from what may be read.
fn spend(path: &Path, left: &mut u64) -> Result<Vec<u8>, String> {
    let bytes = read(path, LONGEST)?;
    *left = left.checked_sub(bytes.len() as u64).ok_or_else(|| {
        format!(
            "the meshes of the scene are larger than {} MiB together",
            LONGEST >> 20
        )
    })?;
    Ok(bytes)
}
