//! The parts of a glTF document that describe triangles.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use nalgebra::Matrix4;
use serde::Deserialize;

use super::accessor::{Accessor, View};

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
    list.get(k)
        .ok_or_else(|| format!("there is no {kind} {k}: the file has {}", list.len()))
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
