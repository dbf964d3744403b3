//! Shapes: their points, edges and triangles, their nearest points, and whether points are inside.

pub(crate) mod bvh;
pub(crate) mod closed_mesh;
pub(crate) mod closest;
mod parts;
pub(crate) mod separation;
pub(crate) mod shape;
#[cfg(test)]
mod tests;
mod triangles;

pub use closed_mesh::ClosedMesh;
pub(crate) use closest::normals;
pub use closest::{Closest, PairKind, closest, weighted};
pub(crate) use shape::FlatFaces;
pub use shape::{Shape, Simplices};
pub(crate) use triangles::Triangles;
