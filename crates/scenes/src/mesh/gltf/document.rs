//! The parts of a glTF document that describe triangles, and its accessors: numbers in views of its
//! buffers, some of them replaced (sparse).

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Matrix4;
use serde::Deserialize;

/// Document, without the parts that are not read.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Document<'a> {
    pub asset: Asset<'a>,
    #[serde(default)]
    pub extensions_required: Vec<String>,
    #[serde(default)]
    extensions_used: Vec<String>,
    pub scene: Option<usize>,
    #[serde(default)]
    pub scenes: Vec<Scene>,
    #[serde(default)]
    pub nodes: Vec<Node>,
    #[serde(default)]
    pub meshes: Vec<Shapes>,
    #[serde(default)]
    pub skins: Vec<Skin>,
    #[serde(default)]
    pub accessors: Vec<Accessor>,
    #[serde(default)]
    pub buffer_views: Vec<View>,
    #[serde(default, borrow)]
    pub buffers: Vec<Buffer<'a>>,
}

/// Version of a glTF file, in a form that all versions of the format have.
#[derive(Deserialize)]
pub(super) struct Head {
    pub asset: serde_json::Value,
}

#[derive(Deserialize)]
pub(super) struct Asset<'a> {
    #[serde(borrow)]
    pub version: Text<'a>,
}

#[derive(Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub nodes: Vec<usize>,
}

#[derive(Deserialize)]
pub(super) struct Node {
    #[serde(default)]
    pub children: Vec<usize>,
    pub mesh: Option<usize>,
    pub skin: Option<usize>,
    /// Weights of the targets, instead of those of the mesh.
    pub weights: Option<Vec<f32>>,
    matrix: Option<[f32; 16]>,
    translation: Option<[f32; 3]>,
    rotation: Option<[f32; 4]>,
    scale: Option<[f32; 3]>,
}

/// A mesh of the document.
#[derive(Deserialize)]
pub(super) struct Shapes {
    pub primitives: Vec<Primitive>,
    /// Weights of the targets.
    #[serde(default)]
    pub weights: Vec<f32>,
}

#[derive(Deserialize)]
pub(super) struct Primitive {
    /// Accessors, by names such as POSITION.
    pub attributes: BTreeMap<String, usize>,
    pub indices: Option<usize>,
    /// How corners make triangles, if they do; 4 if not given: each three of them.
    pub mode: Option<u32>,
    #[serde(default)]
    pub targets: Vec<Target>,
}

/// Morph target: it is added to the points of a primitive, times a weight.
#[derive(Deserialize)]
pub(super) struct Target {
    #[serde(rename = "POSITION")]
    pub position: Option<usize>,
}

/// Joints: nodes that move the points of a mesh.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Skin {
    pub joints: Vec<usize>,
    pub inverse_bind_matrices: Option<usize>,
}

#[derive(Deserialize)]
pub(super) struct Buffer<'a> {
    #[serde(default, borrow)]
    pub uri: Option<Text<'a>>,
}

/// Text that is borrowed from the file if it has no escapes.
#[derive(Deserialize)]
pub(super) struct Text<'a>(#[serde(borrow)] pub Cow<'a, str>);

impl Document<'_> {
    /// Returns the extension by which the geometry is compressed, if it is.
    pub fn compression(&self) -> Option<&str> {
        let mut used = self.extensions_used.iter().map(String::as_str);
        used.find(|name| name.contains("compression"))
    }

    /// Lists the nodes that have no parent.
    pub fn roots(&self) -> Vec<usize> {
        let below: BTreeSet<_> = self.nodes.iter().flat_map(|node| &node.children).collect();
        let all = 0..self.nodes.len();
        all.filter(|k| !below.contains(k)).collect()
    }

    /// Lists the nodes of the trees with these roots, in the order of the file, each with its
    /// matrix relative to the scene.
    pub fn placed(&self, roots: &[usize]) -> Result<Vec<(usize, Matrix4<f64>)>, String> {
        let mut seen = vec![false; self.nodes.len()];
        let next = |nodes: &[usize], above: Matrix4<f64>| {
            let nodes: Vec<_> = nodes.iter().rev().map(|k| (*k, above)).collect();
            nodes
        };
        let (mut left, mut placed) = (next(roots, Matrix4::identity()), vec![]);
        while let Some((k, above)) = left.pop() {
            let node = item(&self.nodes, k, "node")?;
            refuse!(if std::mem::replace(&mut seen[k], true) =>
                "node {k} has two parents: nodes form trees");
            let matrix = above * node.matrix();
            placed.push((k, matrix));
            left.extend(next(&node.children, matrix));
        }
        Ok(placed)
    }
}

/// Returns the error of a file that is compressed by an extension.
pub(super) fn compressed(extension: &str) -> String {
    format!("it needs the extension {extension}, which is not read: save it without compression")
}

/// Returns item k of a list of the document.
pub(super) fn item<'a, T>(list: &'a [T], k: usize, kind: &str) -> Result<&'a T, String> {
    list.get(k).ok_or_else(|| format!("there is no {kind} {k}: the file has {}", list.len()))
}

impl Node {
    /// Returns the matrix of the node: its own, or that of its scale, its rotation and its
    /// translation.
    pub fn matrix(&self) -> Matrix4<f64> {
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

// Component types: the codes of glTF.
const I8: u32 = 5120;
const U8: u32 = 5121;
const I16: u32 = 5122;
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;

/// Accessor of `count` elements.
#[derive(Clone, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    buffer_view: Option<usize>,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    pub count: usize,
    #[serde(rename = "type")]
    kind: String,
    sparse: Option<Sparse>,
    /// Whether whole numbers are fractions of the largest one of their type.
    #[serde(default)]
    normalized: bool,
}

impl Accessor {
    /// Returns whether its numbers are in a buffer. If not, they are 0, or an extension stores
    /// them.
    pub fn is_stored(&self) -> bool {
        self.buffer_view.is_some() || self.sparse.is_some()
    }

    /// Returns the accessor of its first `count` elements.
    pub fn first(&self, count: usize) -> Self {
        Self { count, ..self.clone() }
    }
}

/// Elements that are replaced (sparse storage).
#[derive(Clone, Deserialize)]
struct Sparse {
    count: usize,
    indices: ViewPart,
    values: ViewPart,
}

/// Part of a view. Only indices have a component type here.
#[derive(Clone, Deserialize)]
#[serde(rename_all = "camelCase")]
struct ViewPart {
    buffer_view: usize,
    #[serde(default)]
    byte_offset: usize,
    component_type: Option<u32>,
}

/// View of a buffer.
#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct View {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
}

/// Bytes of a file's buffers, and the views of them.
pub(super) struct Buffers<'a> {
    pub buffers: Vec<Cow<'a, [u8]>>,
    pub views: &'a [View],
}

impl Buffers<'_> {
    /// Reads vectors of three or four numbers, or matrices of sixteen.
    pub fn vectors<const N: usize>(&self, accessor: &Accessor) -> Result<Vec<[f32; N]>, String> {
        let kind = match N {
            3 => "VEC3",
            4 => "VEC4",
            _ => "MAT4",
        };
        refuse!(if accessor.kind != kind => "its type is {}, not {kind}", accessor.kind);
        let (size, largest, read) = number(accessor.component_type)?;
        let bytes = self.bytes(accessor, N * size)?;
        let is_share = accessor.normalized && largest > 0.0;
        let share = |x: f32| if is_share { (x / largest).max(-1.0) } else { x };
        let rows = bytes.chunks_exact(N * size);
        let row = |row: &[u8]| std::array::from_fn(|k| share(read(&row[k * size..][..size])));
        Ok(rows.map(row).collect())
    }

    /// Reads numbers of points.
    pub fn indices(&self, accessor: &Accessor) -> Result<Vec<u32>, String> {
        refuse!(if accessor.kind != "SCALAR" => "indices are single numbers");
        let size = size(accessor.component_type)?;
        Ok(whole(&self.bytes(accessor, size)?, size))
    }

    /// Returns the bytes of all elements of this size (bytes), one after another.
    fn bytes(&self, accessor: &Accessor, size: usize) -> Result<Vec<u8>, String> {
        let count = accessor.count;
        let mut bytes = match accessor.buffer_view {
            None => vec![0; count.checked_mul(size).ok_or("its count is too large")?],
            Some(view) => self.packed(view, accessor.byte_offset, count, size)?,
        };
        if let Some(sparse) = &accessor.sparse {
            let (some, indices, values) = (sparse.count, &sparse.indices, &sparse.values);
            refuse!(if some > count => "it replaces {some} elements of {count}");
            let wide = self::size(indices.component_type.unwrap_or(0))?;
            let places = self.packed(indices.buffer_view, indices.byte_offset, some, wide)?;
            let values = self.packed(values.buffer_view, values.byte_offset, some, size)?;
            for (k, value) in whole(&places, wide).into_iter().zip(values.chunks_exact(size)) {
                let place = bytes.chunks_exact_mut(size).nth(k as usize);
                let place = place.ok_or_else(|| format!("it replaces element {k} of {count}"))?;
                place.copy_from_slice(value);
            }
        }
        Ok(bytes)
    }

    /// Returns the bytes of `count` elements of this size (bytes) in a view, without gaps.
    fn packed(
        &self,
        view: usize,
        from: usize,
        count: usize,
        size: usize,
    ) -> Result<Vec<u8>, String> {
        let it = self.views.get(view);
        let it = it.ok_or_else(|| format!("there is no view {view}"))?;
        let bytes = self.buffers.get(it.buffer);
        let bytes = bytes.and_then(|bytes| bytes.get(it.byte_offset..)?.get(..it.byte_length));
        let bytes = bytes.and_then(|bytes| bytes.get(from..));
        let bytes = bytes.ok_or_else(|| format!("view {view} is not within its buffer"))?;
        let stride = it.byte_stride.unwrap_or(size);
        refuse!(if !(size..=252).contains(&stride) =>
            "the stride of view {view} is {stride}: it is from {size} to 252");
        let there = (bytes.len() + stride - size) / stride;
        refuse!(if count > there => "view {view} has {there} elements, not {count}");
        let rows = bytes.chunks(stride).take(count);
        Ok(rows.flat_map(|row| &row[..size]).copied().collect())
    }
}

/// Encoding of the numbers of a type: their size (bytes), the largest one, which stands for 1 in
/// normalized numbers, or 0 if the type is never normalized, and how they are read.
type Number = (usize, f32, fn(&[u8]) -> f32);

fn number(component_type: u32) -> Result<Number, String> {
    Ok(match component_type {
        I8 => (1, 127.0, |it| f32::from(it[0].cast_signed())),
        U8 => (1, 255.0, |it| f32::from(it[0])),
        I16 => (2, 32767.0, |it| f32::from(i16::from_le_bytes([it[0], it[1]]))),
        U16 => (2, 65535.0, |it| f32::from(u16::from_le_bytes([it[0], it[1]]))),
        F32 => (4, 0.0, |it| f32::from_le_bytes([it[0], it[1], it[2], it[3]])),
        other => {
            let why = "which those of points have not";
            refuse!("its numbers have the type {other}, {why}");
        }
    })
}

/// Returns the size of a whole number of a type (bytes).
fn size(component_type: u32) -> Result<usize, String> {
    match component_type {
        U8 => Ok(1),
        U16 => Ok(2),
        U32 => Ok(4),
        other => Err(format!("its numbers have the type {other}, which indices have not")),
    }
}

/// Reads whole numbers of this size (bytes).
fn whole(bytes: &[u8], size: usize) -> Vec<u32> {
    let number = |bytes: &[u8]| bytes.iter().rev().fold(0, |n, b| n << 8 | u32::from(*b));
    bytes.chunks_exact(size).map(number).collect()
}
