//! The files of a scene: its text, meshes of triangles from OBJ, glTF, STL and PLY files, and
//! meshes of tetrahedra from those of Gmsh and `TetGen`. They are ordinary files of limited size,
//! in the scene's folder or below it, and have a hash.

use std::io::{self, Read};
use std::path::{Component, Path, PathBuf};
use std::sync::OnceLock;

use a3_scenes::{Mesh, unmarked};

use crate::platform::{read, terminal};

/// Largest size of a scene file (bytes).
const MAX_SCENE: u64 = 16 << 20;
/// Largest length of a line in a scene file (bytes).
const MAX_LINE: usize = 8 << 20;
/// Largest total size of the files of a scene's meshes and of their buffers (bytes).
const MAX_MESHES: u64 = 64 << 20;

/// Reads the text of a scene file.
pub fn read_text(path: &Path) -> Result<String, String> {
    text_of(&read(path, MAX_SCENE)?)
}

/// Returns the text of standard input, which is read at the first call.
pub fn read_input() -> Result<String, String> {
    static TEXT: OnceLock<Result<String, String>> = OnceLock::new();
    let read = || {
        let mut bytes = vec![];
        let mut input = io::stdin().lock().take(MAX_SCENE + 1);
        let read = input.read_to_end(&mut bytes);
        read.map_err(|why| format!("it could not be read: {}", terminal::reason(&why)))?;
        if bytes.len() as u64 > MAX_SCENE {
            return Err(format!("it is larger than {} MiB", MAX_SCENE >> 20));
        }
        text_of(&bytes)
    };
    TEXT.get_or_init(read).clone()
}

/// Decodes UTF-8 text without its byte order mark. If no line ends in LF, each CR becomes an LF.
///
/// # Errors
/// The bytes are not UTF-8, or a line is too long.
fn text_of(bytes: &[u8]) -> Result<String, String> {
    let text = str::from_utf8(unmarked(bytes)?)
        .map_err(|e| format!("it is not UTF-8 text: see byte {}", e.valid_up_to()))?;
    let text = if text.contains('\n') { text.to_owned() } else { text.replace('\r', "\n") };
    match text.lines().position(|line| line.len() > MAX_LINE) {
        Some(k) => Err(format!("line {} is longer than {} MiB", k + 1, MAX_LINE >> 20)),
        None => Ok(text),
    }
}

/// Returns the path of a file that a scene names, relative to the scene's folder.
///
/// # Errors
/// The file is outside that folder.
pub fn beside(scene: Option<&Path>, name: &str) -> Result<PathBuf, String> {
    let below = Path::new(name)
        .components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if !below || name.is_empty() {
        return Err(format!("`{name}` must be in the scene's folder or below it, without `..`"));
    }
    let folder = scene.and_then(Path::parent).unwrap_or(Path::new(""));
    let path = folder.join(name);
    if let (Ok(end), Ok(folder)) = (path.canonicalize(), Path::new(".").join(folder).canonicalize())
        && !end.starts_with(folder)
    {
        return Err(format!(
            "`{name}` leads out of the scene's folder by a link: put the file itself there"
        ));
    }
    Ok(path)
}

/// Hash of the bytes that were added to it: FNV-1a, the same on every platform.
#[derive(Clone, Copy)]
pub struct Hash(u64);

impl Default for Hash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Hash {
    /// Adds bytes.
    pub fn add(&mut self, bytes: impl IntoIterator<Item = u8>) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    }

    /// Returns the hash of the bytes so far.
    pub fn value(self) -> u64 {
        self.0
    }
}

/// Reader of the mesh files of a scene, which limits their total size.
pub struct MeshReader {
    /// Number of bytes that may still be read.
    left: u64,
    /// Hash of the bytes that were read.
    pub hash: Hash,
}

impl MeshReader {
    /// Creates a reader for a scene that is built a number of times.
    pub fn new(times: u64) -> Self {
        Self { left: MAX_MESHES * times, hash: Hash::default() }
    }

    /// Reads the bytes of a file.
    fn bytes(&mut self, path: &Path) -> Result<Vec<u8>, String> {
        let bytes = read(path, MAX_MESHES)?;
        let left = self.left.checked_sub(bytes.len() as u64);
        self.left = left.ok_or_else(|| {
            format!("the meshes of the scene are larger than {} MiB together", MAX_MESHES >> 20)
        })?;
        self.hash.add(bytes.iter().copied());
        Ok(bytes)
    }
}

/// Endings of mesh files.
pub const MESH_ENDINGS: [&str; 7] = ["obj", "gltf", "glb", "stl", "ply", "msh", "ele"];

/// Returns the error of a file whose ending is not that of a mesh.
pub fn not_a_mesh(extension: Option<&str>) -> String {
    let all = "a3 reads meshes from files that end in .obj, .gltf, .glb, .stl, .ply, .msh or .ele";
    match extension {
        Some(ending) => format!(".{ending} files are not read: {all}"),
        None => format!("it has no ending: {all}"),
    }
}

/// Reads the triangles or tetrahedra of all objects in a file.
pub fn load_mesh(path: &Path, reader: &mut MeshReader) -> Result<Mesh, String> {
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
        other => Err(not_a_mesh(other)),
    }
}
