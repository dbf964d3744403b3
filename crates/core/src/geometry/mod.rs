//! Shapes: their points, edges and triangles, their nearest points, and whether points are inside.

pub(crate) mod bvh;
pub(crate) mod closed_mesh;
pub(crate) mod closest;
pub(crate) mod nearest;
mod normals;
mod parts;
pub(crate) mod separation;
pub(crate) mod shape;
#[cfg(test)]
mod tests;
mod triangles;

pub use closed_mesh::ClosedMesh;
pub use closest::{Closest, PairKind, closest, weighted};
pub(crate) use normals::normals;
pub use shape::{Shape, Simplices};
pub(crate) use triangles::Triangles;
