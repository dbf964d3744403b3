//! Meshes of triangles, with tetrahedra within them or without, and the springs of a cloth that has
//! their shape.

mod accessor;
mod gltf;
mod gmsh;
mod obj;
mod tetgen;
mod tetrahedra;

use std::collections::BTreeMap;

use a3_core::{Error, Spring, SpringKind, SpringLaw, Vector3};

use crate::check::{BOUNDS, within};
use crate::description::Triple;
pub(crate) use tetrahedra::boundary;

/// Largest number of points in a file.
const MAX_POINTS: usize = 1 << 20;
/// Largest number of triangles in a file.
const MAX_TRIANGLES: usize = 2 * MAX_POINTS;
/// Largest number of tetrahedra in a file.
const MAX_TETRAHEDRA: usize = MAX_POINTS;

/// Mesh of triangles, or of tetrahedra with the triangles around them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Positions of the points (m).
    pub positions: Vec<Triple>,
    /// Corners of the triangles, all in the same winding order.
    pub triangles: Vec<[u32; 3]>,
    /// Corners of the tetrahedra within, if the file has any: each with a positive volume, unless
    /// it differs from others.
    pub tetrahedra: Vec<[u32; 4]>,
}

impl Mesh {
    /// The triangles of all objects in a Wavefront OBJ file.
    ///
    /// # Errors
    /// A point or a face is wrong, there is no triangle, or there are too many.
    pub fn from_obj(bytes: &[u8]) -> Result<Self, String> {
        obj::read(bytes)?.checked()
    }

    /// The triangles of the first scene of a glTF file, or of the scene that it names; `file` reads
    /// another file that it names.
    ///
    /// # Errors
    /// The file is no glTF 2.0 or needs an extension of it, there is no triangle, or there are too
    /// many.
    pub fn from_gltf(
        bytes: &[u8],
        file: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
    ) -> Result<Self, String> {
        gltf::read(bytes, file)?.checked()
    }

    /// The tetrahedra in a text file of Gmsh, version 2.2 or 4.1.
    ///
    /// # Errors
    /// A point or an element is wrong, there is no tetrahedron, or there are too many.
    pub fn from_gmsh(bytes: &[u8]) -> Result<Self, String> {
        gmsh::read(bytes)?.checked()
    }

    /// The tetrahedra in a pair of `TetGen`'s files, `.node` and `.ele`.
    ///
    /// # Errors
    /// A point or an element is wrong, there is no tetrahedron, or there are too many.
    pub fn from_tetgen(node: &[u8], ele: &[u8]) -> Result<Self, String> {
        tetgen::read(node, ele)?.checked()
    }

    /// The mesh, if it has triangles, and its points are where they can be.
    fn checked(self) -> Result<Self, String> {
        let far = |p: &Triple| p.iter().any(|x| !within(*x));
        if let Some(i) = self.positions.iter().position(far) {
            let [x, y, z] = self.positions[i];
            return Err(format!("point {i} is at ({x:e}, {y:e}, {z:e}): {BOUNDS}"));
        }
        if self.triangles.is_empty() {
            return Err("the file has no triangles".into());
        }
        Ok(self)
    }

    /// The mesh with points at equal positions made one, since files have such points where normals
    /// or textures change. Triangles with two equal corners and points without triangles are left
    /// out.
    #[must_use]
    pub fn welded(&self) -> Self {
        let key = |p: &Triple| p.map(|x| (x + 0.0).to_bits());
        let mut first = BTreeMap::new();
        let mut mesh = Self::default();
        let mut corner = |i: u32| {
            let p = self.positions[i as usize];
            *first.entry(key(&p)).or_insert_with(|| {
                mesh.positions.push(p);
                mesh.positions.len() as u32 - 1
            })
        };
        let corners = self.triangles.iter().map(|t| t.map(&mut corner));
        mesh.triangles = corners
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect();
        mesh
    }

    /// The mesh magnified by that factor.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let positions = self.positions.iter().map(|p| p.map(|x| x * factor));
        Self {
            positions: positions.collect(),
            triangles: self.triangles.clone(),
            tetrahedra: self.tetrahedra.clone(),
        }
    }

    /// Least height of a triangle over a point or beside it, for each point (m).
    pub(crate) fn heights(&self) -> Vec<f64> {
        let mut heights = vec![f64::INFINITY; self.positions.len()];
        for t in &self.triangles {
            let [a, b, c] = t.map(|i| Vector3::from(self.positions[i as usize]));
            let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
            let height = (b - a).cross(&(c - a)).norm() / longest;
            for i in t {
                heights[*i as usize] = heights[*i as usize].min(height);
            }
        }
        heights
    }

    /// A third of the area of the triangles around each point (m2).
    pub(crate) fn areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.positions.len()];
        for t in &self.triangles {
            let [a, b, c] = t.map(|i| Vector3::from(self.positions[i as usize]));
            let third = (b - a).cross(&(c - a)).norm() / 6.0;
            for i in t {
                areas[*i as usize] += third;
            }
        }
        areas
    }

    /// Springs: a structural one on each edge, and a bend one between the two corners opposite to
    /// an edge of two triangles. `law` gives the law of a kind of spring of that length (m).
    pub(crate) fn springs(
        &self,
        law: impl Fn(SpringKind, f64) -> Result<SpringLaw, Error>,
    ) -> Result<Vec<Spring>, Error> {
        // The corners opposite to each edge.
        let mut edges: BTreeMap<[u32; 2], Vec<u32>> = BTreeMap::new();
        for &[a, b, c] in &self.triangles {
            for (from, to, opposite) in [(a, b, c), (b, c, a), (c, a, b)] {
                edges
                    .entry([from.min(to), from.max(to)])
                    .or_default()
                    .push(opposite);
            }
        }
        let across = edges.values().filter_map(|opposite| match opposite[..] {
            [a, b] if a != b => Some([a.min(b), a.max(b)]),
            _ => None,
        });
        // The corners across an edge may be neighbours themselves, as in a tetrahedron.
        let across = across.filter(|pair| !edges.contains_key(pair));
        let all = edges
            .keys()
            .map(|pair| (SpringKind::Structural, *pair))
            .chain(across.map(|pair| (SpringKind::Bend, pair)));
        all.map(|(kind, ends)| {
            let [i, j] = ends.map(|i| i as usize);
            let [a, b] = [i, j].map(|i| Vector3::from(self.positions[i]));
            let law = law(kind, (a - b).norm())?;
            Ok(Spring { kind, i, j, law })
        })
        .collect()
    }
}
