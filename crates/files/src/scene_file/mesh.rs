//! Meshes of triangles from OBJ, glTF, STL and PLY files, and of tetrahedra from those of Gmsh and
//! `TetGen`.

use std::path::Path;

use a3_scenes::Mesh;

use super::files::beside;
use super::hash::Hash;
use super::read::read;

/// Largest total size of the files of a scene's meshes and of their buffers (bytes).
const MAX_SIZE: u64 = 64 << 20;

/// Reader of the mesh files of a scene, which limits their total size.
pub struct Reader {
    /// Number of bytes that may still be read.
    left: u64,
    /// Hash of the bytes that were read.
    pub hash: Hash,
}

impl Reader {
    /// Creates a reader for a scene that is built a number of times.
    pub fn new(times: u64) -> Self {
        Self {
            left: MAX_SIZE * times,
            hash: Hash::default(),
        }
    }

    /// Reads the bytes of a file.
    fn bytes(&mut self, path: &Path) -> Result<Vec<u8>, String> {
        let bytes = read(path, MAX_SIZE)?;
        let left = self.left.checked_sub(bytes.len() as u64);
        self.left = left.ok_or_else(|| {
            format!(
                "the meshes of the scene are larger than {} MiB together",
                MAX_SIZE >> 20
            )
        })?;
        self.hash.add(bytes.iter().copied());
        Ok(bytes)
    }
}

/// Endings of mesh files.
pub const ENDINGS: [&str; 7] = ["obj", "gltf", "glb", "stl", "ply", "msh", "ele"];

/// Returns the error of a file whose ending is not that of a mesh.
pub fn not_read(extension: Option<&str>) -> String {
    let all = "a3 reads meshes from files that end in .obj, .gltf, .glb, .stl, .ply, .msh or .ele";
    match extension {
        Some(ending) => format!(".{ending} files are not read: {all}"),
        None => format!("it has no ending: {all}"),
    }
}

/// Reads the triangles or tetrahedra of all objects in a file.
pub fn load(path: &Path, reader: &mut Reader) -> Result<Mesh, String> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("obj") => reader.bytes(path).and_then(|bytes| Mesh::from_obj(&bytes)),
        Some("gltf" | "glb") => reader.bytes(path).and_then(|bytes| {
            Mesh::from_gltf(&bytes, &mut |uri| reader.bytes(&beside(Some(path), uri)?))
        }),
        Some("stl") => reader.bytes(path).and_then(|bytes| Mesh::from_stl(&bytes)),
        Some("ply") => reader.bytes(path).and_then(|bytes| Mesh::from_ply(&bytes)),
        Some("msh") => reader.bytes(path).and_then(|bytes| Mesh::from_gmsh(&bytes)),
        Some("ele") => reader.bytes(path).and_then(|ele| {
            let node = path.with_extension("node");
            let name = node.file_name().and_then(|name| name.to_str());
            let name = name.ok_or("its name is not UTF-8, so the .node file is not found")?;
            let points = reader.bytes(&beside(Some(path), name)?);
            let points = points.map_err(|why| format!("its points, {name}: {why}"))?;
            Mesh::from_tetgen(&points, &ele)
        }),
        other => Err(not_read(other)),
    }
}
