//! Triangles from OBJ and glTF files.

use std::io::BufReader;
use std::path::Path;

use a3_core::MAX_PARTICLES;
use a3_scenes::Mesh;
use base64::Engine;

use super::files;
use crate::caught::caught;

/// The longest file of a mesh or of its buffers (bytes).
const LONGEST: u64 = 128 << 20;

/// The triangles of all objects in a file.
pub fn read(path: &Path) -> Result<Mesh, String> {
    let extension = path
        .extension()
        .and_then(|e| e.to_str())
        .map(str::to_lowercase);
    let named = |why: String| format!("{}: {why}", path.display());
    let parse = match extension.as_deref() {
        Some("obj") => obj,
        Some("gltf" | "glb") => gltf,
        _ => {
            return Err(named(
                "a mesh is a file that ends in .obj, .gltf or .glb".into(),
            ));
        }
    };
    let bytes = files::read(path, LONGEST).map_err(named)?;
    // Both readers compute with the numbers of a file before they check them, and may panic.
    let parsed = caught(|| parse(&bytes, path)).unwrap_or(Err("the file is damaged".into()));
    let mesh = parsed.map_err(named)?;
    check(&mesh).map_err(named)?;
    Ok(mesh)
}

/// `Ok` if the mesh is complete and not too large.
fn check(mesh: &Mesh) -> Result<(), String> {
    let n = mesh.positions.len();
    if n > MAX_PARTICLES || mesh.triangles.len() > 2 * MAX_PARTICLES {
        return Err(format!(
            "it has {n} points and {} triangles, but a scene has at most {MAX_PARTICLES} particles",
            mesh.triangles.len()
        ));
    }
    if let Some(i) = mesh.positions.iter().flatten().position(|x| !x.is_finite()) {
        return Err(format!("the position of point {} is not finite", i / 3));
    }
    if mesh.triangles.iter().flatten().any(|i| *i as usize >= n) {
        return Err(format!(
            "a triangle has a corner beyond the last of {n} points"
        ));
    }
    if mesh.triangles.is_empty() {
        return Err("the file has no triangles".into());
    }
    Ok(())
}

/// The mesh in an OBJ file.
fn obj(bytes: &[u8], _: &Path) -> Result<Mesh, String> {
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..tobj::LoadOptions::default()
    };
    // Materials are not needed.
    let no_materials = |_: &Path| Err(tobj::LoadError::GenericFailure);
    let (models, _) = tobj::load_obj_buf(&mut BufReader::new(bytes), &options, no_materials)
        .map_err(|e| format!("no OBJ: {e}"))?;
    let mut mesh = Mesh::default();
    for model in models {
        let first = mesh.positions.len() as u32;
        let rows = model.mesh.positions.chunks_exact(3);
        mesh.positions
            .extend(rows.map(|p| [p[0], p[1], p[2]].map(f64::from)));
        let triangles = model.mesh.indices.chunks_exact(3);
        mesh.triangles
            .extend(triangles.map(|t| [t[0], t[1], t[2]].map(|i| i.saturating_add(first))));
    }
    Ok(mesh)
}

/// The mesh in a glTF file.
fn gltf(bytes: &[u8], path: &Path) -> Result<Mesh, String> {
    let wrong = |e: &dyn std::fmt::Display| format!("this is not a valid glTF file: {e}");
    let mut file = gltf::Gltf::from_slice(bytes).map_err(|e| wrong(&e))?;
    let blob = file.blob.take();
    let mut buffers = vec![];
    for buffer in file.buffers() {
        buffers.push(match buffer.source() {
            gltf::buffer::Source::Bin => blob.clone().ok_or("its binary part is missing")?,
            gltf::buffer::Source::Uri(uri) => match uri.strip_prefix("data:") {
                Some(data) => {
                    let text = data
                        .split_once("base64,")
                        .ok_or("its data is not base64")?
                        .1;
                    base64::engine::general_purpose::STANDARD
                        .decode(text)
                        .map_err(|e| wrong(&e))?
                }
                None => files::read(&files::beside(Some(path), uri)?, LONGEST)
                    .map_err(|why| format!("{uri}: {why}"))?,
            },
        });
    }
    let mut mesh = Mesh::default();
    for scene in file
        .default_scene()
        .into_iter()
        .chain(file.scenes())
        .take(1)
    {
        for node in scene.nodes() {
            add(&node, nalgebra::Matrix4::identity(), &buffers, &mut mesh, 0)?;
        }
    }
    Ok(mesh)
}

/// Adds the triangles of a node and of those below it.
fn add(
    node: &gltf::Node,
    above: nalgebra::Matrix4<f64>,
    buffers: &[Vec<u8>],
    mesh: &mut Mesh,
    depth: usize,
) -> Result<(), String> {
    if depth > 100 {
        return Err("its nodes are nested more than 100 deep".into());
    }
    let own = node.transform().matrix();
    let matrix = above * nalgebra::Matrix4::from_fn(|row, col| f64::from(own[col][row]));
    for primitive in node
        .mesh()
        .into_iter()
        .flat_map(|mesh| mesh.primitives().collect::<Vec<_>>())
    {
        if primitive.mode() != gltf::mesh::Mode::Triangles {
            continue;
        }
        let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
        let first = mesh.positions.len() as u32;
        let positions = reader.read_positions().ok_or("a mesh has no positions")?;
        let place = |p: [f32; 3]| {
            let p = matrix.transform_point(&nalgebra::Point3::from(p.map(f64::from)));
            [p.x, p.y, p.z]
        };
        mesh.positions.extend(positions.map(place));
        let count = mesh.positions.len() as u32 - first;
        let corners: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..count).collect(),
        };
        let triangles = corners.chunks_exact(3);
        mesh.triangles
            .extend(triangles.map(|t| [t[0], t[1], t[2]].map(|i| i.saturating_add(first))));
    }
    for child in node.children() {
        add(&child, matrix, buffers, mesh, depth + 1)?;
    }
    Ok(())
}
