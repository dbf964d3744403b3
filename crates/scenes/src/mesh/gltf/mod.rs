//! Meshes from glTF 2.0 files, as JSON or binary (Khronos, *glTF 2.0 Specification*): the triangles
//! of the nodes of a scene. Every count is compared with the number of bytes before memory is
//! reserved.

mod document;
mod primitive;

use std::borrow::Cow;

use base64::Engine;
use document::{Buffers, Document, Head, Text, compressed, item};
use primitive::{Reader, Skins};

use super::data::Mesh;
use crate::budget;
use crate::text::unmarked;

/// Beginnings of the names of extensions that leave geometry alone, and of one that is supported.
#[rustfmt::skip]
const HARMLESS: [&str; 20] = [
    "KHR_materials_", "KHR_texture_", "KHR_lights_", "KHR_xmp", "KHR_animation_pointer",
    "KHR_mesh_quantization", "EXT_texture_", "EXT_lights_", "EXT_materials_", "MSFT_texture_",
    "MSFT_packing_", "KHR_technique", "KHR_audio", "KHR_node_visibility", "ADOBE_materials_",
    "FB_ngon_encoding", "EXT_mesh_features", "EXT_structural_metadata", "EXT_instance_features", "VRM",
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
        refuse!("it needs the extension {extension}, which is not read");
    }
    let mut buffers = Buffers { buffers: vec![], views: &document.buffer_views };
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
    let bytes =
        file(&name).or_else(|why| if name == uri { Err(why) } else { file(uri).map_err(|_| why) });
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
            let version = head.map_or(String::new(), |head| head.asset["version"].to_string());
            let version = version.trim_matches('"');
            let is_old = version.starts_with('1');
            let why = format!("it is no glTF 2.0 file: {error}");
            Err(if is_old { only(version) } else { why })
        }
    }
}

/// Finds the JSON text of a file, and its binary part if it has one.
fn parts(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    if !bytes.starts_with(b"glTF") {
        return Ok((unmarked(bytes)?, None));
    }
    let word = |at: usize| {
        let word = bytes.get(at..at + 4)?.try_into().ok()?;
        Some(u32::from_le_bytes(word) as usize)
    };
    let kind = |at: usize| bytes.get(at + 4..at + 8);
    let data = |at: usize| bytes.get(at + 8..)?.get(..word(at)?);
    match word(4) {
        Some(2) => {}
        Some(1) => return Err("it is glTF 1.0: convert it to glTF 2.0".into()),
        _ => return Err("it is no glTF 2.0 file: its version is not 2".into()),
    }
    let json = data(12).filter(|_| kind(12) == Some(b"JSON"));
    let json = json.ok_or("it is no glTF 2.0 file: its JSON part is cut short")?;
    // Parts should begin at multiples of four, but some programs do not pad them.
    let end = 20 + json.len();
    let next = [end, end.next_multiple_of(4)];
    let next = next.into_iter().find(|at| kind(*at) == Some(b"BIN\0"));
    let cut = || "its binary part is cut short".to_owned();
    let binary = match next {
        Some(at) => Some(data(at).ok_or_else(cut)?),
        None if end.next_multiple_of(4) >= bytes.len() => None,
        None => return Err(cut()),
    };
    let json = json.trim_ascii_end();
    let padding = json.iter().rev().take_while(|b| **b == 0).count();
    Ok((&json[..json.len() - padding], binary))
}

/// Decodes the bytes of a data URI.
fn decoded(data: &str) -> Result<Vec<u8>, String> {
    let (_, text) = data.split_once("base64,").ok_or("its data is not base64")?;
    let decoded = base64::engine::general_purpose::STANDARD.decode(text);
    decoded.map_err(|_| "its data is not base64".into())
}

/// Decodes a percent-encoded name, in which `%20` stands for a space.
fn unescaped(uri: &str) -> Cow<'_, str> {
    if !uri.contains('%') {
        return uri.into();
    }
    let mut bytes = vec![];
    let mut rest = uri.as_bytes();
    while let Some((first, after)) = rest.split_first() {
        let code = after.get(..2).filter(|_| *first == b'%');
        let code = code.and_then(|code| u8::from_str_radix(str::from_utf8(code).ok()?, 16).ok());
        bytes.push(code.unwrap_or(*first));
        rest = if code.is_some() { &after[2..] } else { after };
    }
    String::from_utf8(bytes).map_or(uri.into(), Cow::from)
}
