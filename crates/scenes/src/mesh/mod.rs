//! Meshes of triangles or of tetrahedra from files.

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

pub use data::Mesh;
pub(crate) use tetrahedra::boundary;
