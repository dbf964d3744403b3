//! Shapes: their points, edges and triangles, the points of them that are nearest, and what is
//! inside.

pub(crate) mod bvh;
pub(crate) mod closed_mesh;
pub(crate) mod closest;
pub(crate) mod nearest;
pub(crate) mod separation;
pub(crate) mod shape;

pub use closed_mesh::ClosedMesh;
pub use closest::{Closest, PairKind, closest, weighted};
pub use shape::{Shape, Simplices};
