//! Meshes of triangles from OBJ and glTF files, and of tetrahedra from those of Gmsh and
//! `TetGen`.

use std::path::Path;

use a3_scenes::Mesh;

use super::files::beside;
use super::hash::Hash;
use super::read::read;

/// Length of the files of a scene's meshes and of their buffers, all together (bytes).
const LONGEST: u64 = 64 << 20;

/// The files of a scene's meshes and of their buffers, as they are read.
pub struct Reader {
    /// Length of the files that may still be read (bytes).
    left: u64,
    /// Hash of what was read.
    pub hash: Hash,
}

impl Reader {
    /// Reads the files of a scene so many times.
    pub fn new(times: u64) -> Self {
        Self {
            left: LONGEST * times,
            hash: Hash::default(),
        }
    }

    /// The bytes of a file.
    fn bytes(&mut self, path: &Path) -> Result<Vec<u8>, String> {
        let bytes = read(path, LONGEST)?;
        let left = self.left.checked_sub(bytes.len() as u64);
        self.left = left.ok_or_else(|| {
            format!(
                "the meshes of the scene are larger than {} MiB together",
                LONGEST >> 20
            )
        })?;
        self.hash.add(bytes.iter().copied());
        Ok(bytes)
    }
}

/// The triangles or tetrahedra of all objects in a file.
pub fn load(path: &Path, reader: &mut Reader) -> Result<Mesh, String> {
    let extension = path.extension().and_then(|e| e.to_str());
    let extension = extension.map(str::to_lowercase);
    let mesh = match extension.as_deref() {
        Some("obj") => reader.bytes(path).and_then(|bytes| Mesh::from_obj(&bytes)),
        Some("gltf" | "glb") => reader.bytes(path).and_then(|bytes| {
            Mesh::from_gltf(&bytes, &mut |uri| reader.bytes(&beside(Some(path), uri)?))
        }),
        Some("msh") => reader.bytes(path).and_then(|bytes| Mesh::from_gmsh(&bytes)),
        Some("ele") => reader
            .bytes(path)
            .and_then(|ele| Mesh::from_tetgen(&reader.bytes(&path.with_extension("node"))?, &ele)),
        _ => Err("a mesh is a file that ends in .obj, .gltf, .glb, .msh or .ele".into()),
    };
    mesh.map_err(|why| format!("{}: {why}", path.display()))
}
