//! Meshes from glTF 2.0 files, as JSON or binary (Khronos, *glTF 2.0 Specification*): the triangles
//! of the nodes of a scene. Every count is compared with the bytes that are there before anything
//! is reserved.

use std::borrow::Cow;

use base64::Engine;
use nalgebra::{Matrix4, Point3};

use super::accessor::{Accessor, Buffers, View};
use super::{MAX_POINTS, MAX_TRIANGLES, Mesh};
use crate::budget;
use crate::fault::Fault;
use crate::text::unmarked;
use serde::Deserialize;

/// The parts of a document that say where triangles are.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Document<'a> {
    #[serde(rename = "asset")]
    _asset: Asset,
    #[serde(default)]
    extensions_required: Vec<String>,
    scene: Option<usize>,
    #[serde(default)]
    scenes: Vec<Scene>,
    #[serde(default)]
    nodes: Vec<Node>,
    #[serde(default)]
    meshes: Vec<Shapes>,
    #[serde(default)]
    accessors: Vec<Accessor>,
    #[serde(default)]
    buffer_views: Vec<View>,
    #[serde(default, borrow)]
    buffers: Vec<Buffer<'a>>,
}

/// What every glTF file has.
#[derive(Deserialize)]
struct Asset {
    #[serde(rename = "version")]
    _version: String,
}

#[derive(Deserialize)]
struct Scene {
    #[serde(default)]
    nodes: Vec<usize>,
}

#[derive(Deserialize)]
struct Node {
    #[serde(default)]
    children: Vec<usize>,
    mesh: Option<usize>,
    matrix: Option<[f32; 16]>,
    translation: Option<[f32; 3]>,
    rotation: Option<[f32; 4]>,
    scale: Option<[f32; 3]>,
}

/// A mesh of the document.
#[derive(Deserialize)]
struct Shapes {
    primitives: Vec<Primitive>,
}

#[derive(Deserialize)]
struct Primitive {
    attributes: Attributes,
    indices: Option<usize>,
    /// How corners make triangles, if they do; 4, each three of them, if not given.
    mode: Option<u32>,
}

#[derive(Deserialize)]
struct Attributes {
    #[serde(rename = "POSITION")]
    position: Option<usize>,
}

#[derive(Deserialize)]
struct Buffer<'a> {
    #[serde(default, borrow)]
    uri: Option<Uri<'a>>,
}

/// Text that is borrowed from the file where it can be.
#[derive(Deserialize)]
struct Uri<'a>(#[serde(borrow)] Cow<'a, str>);

/// What is said of a text that is no glTF.
fn not_gltf(json: &[u8], error: &serde_json::Error) -> String {
    let fault = Fault::of_json(&String::from_utf8_lossy(json), error);
    format!("it is no glTF 2.0 file: {fault}")
}

/// The mesh in a glTF file. `file` reads a file that it names.
pub(super) fn read(
    bytes: &[u8],
    file: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<Mesh, String> {
    let (json, binary) = chunks(bytes)?;
    budget::check_text(json)?;
    let document: Document =
        serde_json::from_slice(json).map_err(|error| not_gltf(json, &error))?;
    if let Some(extension) = document.extensions_required.first() {
        return Err(format!(
            "it needs the extension {extension}, which is not known"
        ));
    }
    let mut buffers = Buffers {
        buffers: vec![],
        views: &document.buffer_views,
    };
    for buffer in &document.buffers {
        buffers.buffers.push(match &buffer.uri {
            None => binary.ok_or("its binary part is missing")?.into(),
            Some(Uri(uri)) => match uri.strip_prefix("data:") {
                Some(data) => decoded(data)?.into(),
                None => file(uri).map_err(|why| format!("{uri}: {why}"))?.into(),
            },
        });
    }
    let scene = match document.scene {
        Some(k) => Some(item(&document.scenes, k, "scene")?),
        None => document.scenes.first(),
    };
    let roots = scene.map_or(&[][..], |scene| &scene.nodes);
    let mut reader = Reader {
        document: &document,
        buffers,
        mesh: Mesh::default(),
        primitives: 0,
    };
    reader.add(roots)?;
    Ok(reader.mesh)
}

/// The JSON text of a file, and its binary part if it has one.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    if !bytes.starts_with(b"glTF") {
        return Ok((unmarked(bytes)?, None));
    }
    let word = |at: usize| {
        let word = bytes.get(at..at + 4)?.try_into().ok()?;
        Some(u32::from_le_bytes(word) as usize)
    };
    let chunk = |at: usize, kind: &[u8]| {
        let length = word(at)?;
        let data = bytes.get(at + 8..)?.get(..length)?;
        (bytes[at + 4..at + 8] == *kind).then_some(data)
    };
    if word(4) != Some(2) {
        return Err("it is no glTF 2.0 file: its version is not 2".into());
    }
    let json = chunk(12, b"JSON").ok_or("it is no glTF 2.0 file: its JSON part is cut short")?;
    let next = 20 + json.len().next_multiple_of(4);
    if next >= bytes.len() {
        return Ok((json, None));
    }
    let binary = chunk(next, b"BIN\0").ok_or("its binary part is cut short")?;
    Ok((json, Some(binary)))
}

/// The bytes of a data URI.
fn decoded(data: &str) -> Result<Vec<u8>, String> {
    let (_, text) = data.split_once("base64,").ok_or("its data is not base64")?;
    let decoded = base64::engine::general_purpose::STANDARD.decode(text);
    decoded.map_err(|_| "its data is not base64".into())
}

/// Item k of a list of the document.
fn item<'a, T>(list: &'a [T], k: usize, kind: &str) -> Result<&'a T, String> {
    list.get(k)
        .ok_or_else(|| format!("there is no {kind} {k}: the file has {}", list.len()))
}

/// The mesh so far.
struct Reader<'a> {
    document: &'a Document<'a>,
    buffers: Buffers<'a>,
    mesh: Mesh,
    /// Number of primitives that were looked at.
    primitives: usize,
}

impl Reader<'_> {
    /// Adds the triangles of nodes and of those below them, in the order of the file.
    fn add(&mut self, roots: &[usize]) -> Result<(), String> {
        let document = self.document;
        let mut seen = vec![false; document.nodes.len()];
        let next = |nodes: &[usize], above: Matrix4<f64>| {
            let nodes: Vec<_> = nodes.iter().rev().map(|k| (*k, above)).collect();
            nodes
        };
        let mut left = next(roots, Matrix4::identity());
        while let Some((k, above)) = left.pop() {
            let node = item(&document.nodes, k, "node")?;
            if std::mem::replace(&mut seen[k], true) {
                return Err(format!("node {k} has two parents: nodes form trees"));
            }
            let matrix = above * node.matrix();
            if let Some(mesh) = node.mesh {
                for primitive in &item(&document.meshes, mesh, "mesh")?.primitives {
                    self.add_primitive(primitive, &matrix)?;
                }
            }
            left.extend(next(&node.children, matrix));
        }
        Ok(())
    }

    /// Adds the triangles of a primitive; points and lines have none.
    fn add_primitive(
        &mut self,
        primitive: &Primitive,
        matrix: &Matrix4<f64>,
    ) -> Result<(), String> {
        let too_many =
            || format!("there are more than {MAX_POINTS} points or {MAX_TRIANGLES} triangles");
        self.primitives += 1;
        if self.primitives > MAX_POINTS {
            return Err(too_many());
        }
        let mode = primitive.mode.unwrap_or(4);
        if mode < 4 {
            return Ok(());
        }
        let accessor = |k: usize| item(&self.document.accessors, k, "accessor");
        let position = primitive
            .attributes
            .position
            .ok_or("a mesh has no positions")?;
        let points = accessor(position)?;
        let first = self.mesh.positions.len();
        if points.count > MAX_POINTS - first {
            return Err(too_many());
        }
        let named = |k: usize| move |why: String| format!("accessor {k}: {why}");
        let points = self.buffers.vectors(points).map_err(named(position))?;
        let count = points.len() as u32;
        let corners = match primitive.indices {
            None => (0..count).collect(),
            Some(k) => {
                let indices = accessor(k)?;
                if indices.count > 3 * MAX_TRIANGLES {
                    return Err(too_many());
                }
                self.buffers.indices(indices).map_err(named(k))?
            }
        };
        if let Some(corner) = corners.iter().find(|corner| **corner >= count) {
            return Err(format!("a triangle has corner {corner} of {count} points"));
        }
        let triangles: Vec<[u32; 3]> = match mode {
            4 => corners
                .chunks_exact(3)
                .map(|t| [t[0], t[1], t[2]])
                .collect(),
            5 => {
                let strip = corners.windows(3).enumerate();
                strip
                    .map(|(k, t)| [t[0], t[1 + k % 2], t[2 - k % 2]])
                    .collect()
            }
            6 => {
                let fan = corners.windows(2).skip(1);
                fan.map(|side| [corners[0], side[0], side[1]]).collect()
            }
            _ => return Err(format!("there is no mode {mode} of primitives")),
        };
        if triangles.len() > MAX_TRIANGLES - self.mesh.triangles.len() {
            return Err(too_many());
        }
        let place = |p: [f32; 3]| {
            let p = matrix.transform_point(&Point3::from(p.map(f64::from)));
            [p.x, p.y, p.z]
        };
        self.mesh.positions.extend(points.into_iter().map(place));
        let triangles = triangles.into_iter();
        self.mesh
            .triangles
            .extend(triangles.map(|t| t.map(|i| i + first as u32)));
        Ok(())
    }
}

impl Node {
    /// Matrix of the node: its own, or that of its scale, its rotation and its translation.
    fn matrix(&self) -> Matrix4<f64> {
        if let Some(matrix) = self.matrix {
            return Matrix4::from_column_slice(&matrix.map(f64::from));
        }
        let [x, y, z, w] = self.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
        let (x2, y2, z2) = (x + x, y + y, z + z);
        let axes = [
            [1.0 - y2 * y - z2 * z, x2 * y + z2 * w, x2 * z - y2 * w],
            [x2 * y - z2 * w, 1.0 - x2 * x - z2 * z, y2 * z + x2 * w],
            [x2 * z + y2 * w, y2 * z - x2 * w, 1.0 - x2 * x - y2 * y],
        ];
        let scale = self.scale.unwrap_or([1.0; 3]);
        let origin = self.translation.unwrap_or_default();
        Matrix4::from_fn(|row, col| match (row, col) {
            (3, 3) => 1.0,
            (3, _) => 0.0,
            (_, 3) => f64::from(origin[row]),
            _ => f64::from(axes[col][row] * scale[col]),
        })
    }
}
