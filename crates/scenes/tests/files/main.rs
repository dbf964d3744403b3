//! Mesh files of other programs: their contents, and the messages about files that are refused.

mod faces;
mod foreign;
mod gltf;
mod solids;
mod texts;

use a3_scenes::Mesh;

/// Reads a file of these tests.
fn data(name: &str) -> Vec<u8> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/files/data");
    std::fs::read(format!("{folder}/{name}")).unwrap()
}

fn obj(text: impl AsRef<[u8]>) -> Mesh {
    Mesh::from_obj(text.as_ref()).unwrap()
}

/// Returns the vector area of the triangles: half the sum of their cross products.
fn vector_area(mesh: &Mesh) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for t in &mesh.triangles {
        let n = half_cross(mesh, t);
        (0..3).for_each(|k| sum[k] += n[k]);
    }
    sum
}

/// Returns the sum of the areas of the triangles.
fn area(mesh: &Mesh) -> f64 {
    let areas = mesh.triangles.iter().map(|t| half_cross(mesh, t));
    areas
        .map(|n| n.iter().map(|x| x * x).sum::<f64>().sqrt())
        .sum()
}

fn half_cross(mesh: &Mesh, t: &[u32; 3]) -> [f64; 3] {
    let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
    let (u, v): ([f64; 3], [f64; 3]) = (
        [0, 1, 2].map(|k| b[k] - a[k]),
        [0, 1, 2].map(|k| c[k] - a[k]),
    );
    [0, 1, 2].map(|k| 0.5 * (u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3]))
}
