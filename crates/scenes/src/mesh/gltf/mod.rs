//! Meshes from glTF 2.0 files, as JSON or binary (Khronos, *glTF 2.0 Specification*): the triangles
//! of the nodes of a scene. Every count is compared with the number of bytes before memory is
//! reserved.

mod accessor;
mod container;
mod document;
mod primitive;
mod skin;

use super::data::Mesh;
use crate::budget;
use accessor::Buffers;
use container::{decoded, parts, unescaped};
use document::{Document, Head, Text, compressed, item};
use primitive::Reader;
use skin::Skins;

/// Beginnings of the names of extensions that leave geometry alone, and of one that is supported.
const HARMLESS: [&str; 20] = [
    "KHR_materials_",
    "KHR_texture_",
    "KHR_lights_",
    "KHR_xmp",
    "KHR_animation_pointer",
    "KHR_mesh_quantization",
    "EXT_texture_",
    "EXT_lights_",
    "EXT_materials_",
    "MSFT_texture_",
    "MSFT_packing_",
    "KHR_technique",
    "KHR_audio",
    "KHR_node_visibility",
    "ADOBE_materials_",
    "FB_ngon_encoding",
    "EXT_mesh_features",
    "EXT_structural_metadata",
    "EXT_instance_features",
    "VRM",
];

/// Reads the mesh of a glTF file. `file` reads another file that it refers to.
pub(super) fn read(
    bytes: &[u8],
    file: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<Mesh, String> {
    let (json, binary) = parts(bytes)?;
    budget::check_text(json)?;
    let document = document(json)?;
    let is_harmless = |name: &&String| HARMLESS.iter().any(|known| name.starts_with(known));
    let mut needed = document.extensions_required.iter();
    if let Some(extension) = needed.find(|name| !is_harmless(name)) {
        if extension.contains("compression") {
            return Err(compressed(extension));
        }
        return Err(format!(
            "it needs the extension {extension}, which is not read"
        ));
    }
    let mut buffers = Buffers {
        buffers: vec![],
        views: &document.buffer_views,
    };
    for buffer in &document.buffers {
        let Some(Text(uri)) = &buffer.uri else {
            let missing = || match document.compression() {
                Some(extension) => compressed(extension),
                None => "its binary part is missing".into(),
            };
            let inside = binary.ok_or_else(missing)?;
            buffers.buffers.push(inside.into());
            continue;
        };
        let bytes = match uri.strip_prefix("data:") {
            Some(data) => decoded(data)?,
            None => named(uri, file)?,
        };
        buffers.buffers.push(bytes.into());
    }
    let scene = match document.scene {
        Some(k) => Some(item(&document.scenes, k, "scene")?),
        None => document.scenes.first(),
    };
    let all = document.roots();
    let roots = scene.map_or(&all[..], |scene| &scene.nodes);
    let mut reader = Reader {
        document: &document,
        skins: Skins::new(&document),
        buffers,
        mesh: Mesh::default(),
        primitives: 0,
        shifts: 0,
    };
    reader.add(roots)?;
    Ok(reader.mesh)
}

/// Reads the file that a URI names. Some programs do not percent-encode names.
fn named(
    uri: &str,
    file: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<Vec<u8>, String> {
    let name = unescaped(uri);
    let bytes = file(&name).or_else(|why| {
        if name == uri {
            Err(why)
        } else {
            file(uri).map_err(|_| why)
        }
    });
    bytes.map_err(|why| format!("{name}: {why}"))
}

/// Reads the document in a text.
fn document(json: &[u8]) -> Result<Document<'_>, String> {
    let only = |version: &str| format!("it is glTF {version}: convert it to glTF 2.0");
    match serde_json::from_slice::<Document>(json) {
        Ok(document) if document.asset.version.0.starts_with("2.") => Ok(document),
        Ok(document) => Err(only(&document.asset.version.0)),
        Err(error) => {
            // Version 1.0 has other lists, and its version number is not always a text.
            let head = serde_json::from_slice::<Head>(json).ok();
            let version = head.map(|head| head.asset.version.to_string());
            if let Some(version) =
                version.filter(|version| version.trim_matches('"').starts_with('1'))
            {
                return Err(only(version.trim_matches('"')));
            }
            Err(format!("it is no glTF 2.0 file: {error}"))
        }
    }
}
