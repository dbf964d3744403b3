//! Meshes of triangles or of tetrahedra from the bytes of files, one function a format.

mod data;
mod faces;
mod gltf;
mod polygon;
mod tetrahedra;

use crate::description::Triple;
use crate::fault::{COORDINATES, is_coordinate};
use crate::text::unmarked;

pub use data::Mesh;
pub(crate) use tetrahedra::boundary;

impl Mesh {
    /// Reads the triangles of all objects in a Wavefront OBJ file.
    ///
    /// # Errors
    /// A point or a face is wrong, there is no triangle, or there are too many.
    pub fn from_obj(bytes: &[u8]) -> Result<Self, String> {
        faces::obj(unmarked(bytes)?)?.checked(1)
    }

    /// Reads the triangles of the scene that a glTF file names, or else of its first scene. `file`
    /// reads another file that it refers to.
    ///
    /// # Errors
    /// The file is no glTF 2.0 or needs an extension of it, there is no triangle, or there are too
    /// many.
    pub fn from_gltf(
        bytes: &[u8],
        file: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
    ) -> Result<Self, String> {
        gltf::read(bytes, file)?.checked(0)
    }

    /// Reads the triangles of an STL file, binary or text.
    ///
    /// # Errors
    /// A triangle is wrong, there is none, or there are too many.
    pub fn from_stl(bytes: &[u8]) -> Result<Self, String> {
        faces::stl(bytes)?.checked(0)
    }

    /// Reads the triangles of the faces in a PLY file, text or binary.
    ///
    /// # Errors
    /// The head or an element is wrong, there is no face, or there are too many.
    pub fn from_ply(bytes: &[u8]) -> Result<Self, String> {
        faces::ply(unmarked(bytes)?)?.checked(0)
    }

    /// Reads the tetrahedra in a text file of Gmsh, version 2.2 or 4.1.
    ///
    /// # Errors
    /// A point or an element is wrong, there is no tetrahedron, or there are too many.
    pub fn from_gmsh(bytes: &[u8]) -> Result<Self, String> {
        tetrahedra::gmsh(unmarked(bytes)?)?.checked(0)
    }

    /// Reads the tetrahedra in a pair of `TetGen`'s files, `.node` and `.ele`.
    ///
    /// # Errors
    /// A point or an element is wrong, there is no tetrahedron, or there are too many.
    pub fn from_tetgen(node: &[u8], ele: &[u8]) -> Result<Self, String> {
        tetrahedra::tetgen(unmarked(node)?, unmarked(ele)?)?.checked(0)
    }

    /// Checks that the mesh has triangles and that its points are within the bounds, and leaves out
    /// unused points. A file that does not give the numbers of points counts them from `first`.
    fn checked(self, first: u64) -> Result<Self, String> {
        refuse!(if self.triangles.is_empty() => "the file has no triangles");
        let mesh = self.with_areas()?.in_use(first);
        let far = |p: &Triple| p.iter().any(|x| !is_coordinate(*x));
        if let Some(i) = mesh.positions.iter().position(far) {
            let [x, y, z] = mesh.positions[i];
            let number = mesh.number(i);
            refuse!("point {number} is at ({x:e}, {y:e}, {z:e}): {COORDINATES}");
        }
        Ok(mesh)
    }

    /// Leaves out the triangles at points all of whose triangles have no area, unless the mesh has
    /// tetrahedra.
    fn with_areas(mut self) -> Result<Self, String> {
        if self.tetrahedra.is_empty() {
            let areas = self.areas();
            let has_area = |t: &[u32; 3]| t.iter().all(|i| areas[*i as usize] != 0.0);
            self.triangles.retain(has_area);
            refuse!(if self.triangles.is_empty() => "the triangles of the file have no area");
        }
        Ok(self)
    }

    /// Leaves out the points that are in no triangle or tetrahedron, and keeps the numbers of the
    /// others.
    fn in_use(self, first: u64) -> Self {
        let mut is_used = vec![false; self.positions.len()];
        let corners = self.triangles.iter().flatten();
        for i in corners.chain(self.tetrahedra.iter().flatten()) {
            is_used[*i as usize] = true;
        }
        let kept = || (0..self.positions.len()).filter(|i| is_used[*i]);
        let mut place = vec![0; self.positions.len()];
        for (k, i) in kept().enumerate() {
            place[i] = k as u32;
        }
        let number = |i: usize| self.numbers.get(i).copied().unwrap_or(first + i as u64);
        let at = |i: u32| place[i as usize];
        Self {
            positions: kept().map(|i| self.positions[i]).collect(),
            triangles: self.triangles.iter().map(|t| t.map(at)).collect(),
            tetrahedra: self.tetrahedra.iter().map(|t| t.map(at)).collect(),
            numbers: kept().map(number).collect(),
            tetrahedron_numbers: self.tetrahedron_numbers,
        }
    }
}
