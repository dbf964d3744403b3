//! Mesh files of other programs: their contents, and the messages about files that are refused.

#[path = "../common/mod.rs"]
mod common;

mod faces;
mod foreign;
mod gltf;
mod solids;
mod texts;

use a3_scenes::Mesh;
use common::{begins, random, refused};

/// Reads a file of these tests.
fn data(name: &str) -> Vec<u8> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/files/data");
    std::fs::read(format!("{folder}/{name}")).unwrap()
}

fn obj(text: impl AsRef<[u8]>) -> Mesh {
    Mesh::from_obj(text.as_ref()).unwrap()
}

/// Counts the points and the triangles.
fn counts(mesh: &Mesh) -> [usize; 2] {
    [mesh.positions.len(), mesh.triangles.len()]
}

/// Returns the vector area of the triangles: half the sum of their cross products.
fn vector_area(mesh: &Mesh) -> [f64; 3] {
    let all = mesh.triangles.iter().map(|t| half_cross(mesh, t));
    all.fold([0.0; 3], |sum, n| [0, 1, 2].map(|k| sum[k] + n[k]))
}

/// Returns the sum of the areas of the triangles.
fn area(mesh: &Mesh) -> f64 {
    let all = mesh.triangles.iter().map(|t| half_cross(mesh, t));
    all.map(|n| n.iter().map(|x| x * x).sum::<f64>().sqrt()).sum()
}

fn half_cross(mesh: &Mesh, t: &[u32; 3]) -> [f64; 3] {
    let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
    let [u, v] = [b, c].map(|to| [0, 1, 2].map(|k| to[k] - a[k]));
    [0, 1, 2].map(|k| 0.5 * (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]))
}
