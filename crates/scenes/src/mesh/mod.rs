//! Meshes of triangles, with tetrahedra within them or without, and the springs of a cloth that has
//! their shape.

mod data;
mod gltf;
mod gmsh;
mod obj;
mod ply;
mod polygon;
mod reading;
mod stl;
mod tetgen;
mod tetrahedra;
mod weld;

pub use data::Mesh;
pub(crate) use tetrahedra::boundary;
