//! Meshes of triangles, with tetrahedra within them or without, and the springs of a cloth that has
//! their shape.

mod gltf;
mod gmsh;
mod obj;
mod ply;
mod polygon;
mod stl;
mod tetgen;
mod tetrahedra;
mod weld;

use std::collections::BTreeMap;

use a3_core::{Error, Spring, SpringKind, SpringLaw, Vector3};

use crate::check::{BOUNDS, within};
use crate::description::Triple;
use crate::text::unmarked;
pub(crate) use tetrahedra::boundary;

/// Largest number of points in a file.
const MAX_POINTS: usize = 1 << 20;
/// Largest number of triangles in a file.
const MAX_TRIANGLES: usize = 2 * MAX_POINTS;
/// Largest number of tetrahedra in a file.
const MAX_TETRAHEDRA: usize = MAX_POINTS;

/// Height of a triangle over its longest side, as a share of that, from which it is no sliver.
const SLIVER: f64 = 1e-3;

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
    /// Numbers of the points in the file, if it does not count them from 0.
    pub numbers: Vec<u64>,
    /// Numbers of the tetrahedra in the file.
    pub tetrahedron_numbers: Vec<u64>,
}

impl Mesh {
    /// The triangles of all objects in a Wavefront OBJ file.
    ///
    /// # Errors
    /// A point or a face is wrong, there is no triangle, or there are too many.
    pub fn from_obj(bytes: &[u8]) -> Result<Self, String> {
        obj::read(unmarked(bytes)?)?.checked(1)
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
        gltf::read(bytes, file)?.checked(0)
    }

    /// The triangles of an STL file, binary or text.
    ///
    /// # Errors
    /// A triangle is wrong, there is none, or there are too many.
    pub fn from_stl(bytes: &[u8]) -> Result<Self, String> {
        stl::read(bytes)?.checked(0)
    }

    /// The triangles of the faces in a PLY file, text or binary.
    ///
    /// # Errors
    /// The head or an element is wrong, there is no face, or there are too many.
    pub fn from_ply(bytes: &[u8]) -> Result<Self, String> {
        ply::read(unmarked(bytes)?)?.checked(0)
    }

    /// The tetrahedra in a text file of Gmsh, version 2.2 or 4.1.
    ///
    /// # Errors
    /// A point or an element is wrong, there is no tetrahedron, or there are too many.
    pub fn from_gmsh(bytes: &[u8]) -> Result<Self, String> {
        gmsh::read(unmarked(bytes)?)?.checked(0)
    }

    /// The tetrahedra in a pair of `TetGen`'s files, `.node` and `.ele`.
    ///
    /// # Errors
    /// A point or an element is wrong, there is no tetrahedron, or there are too many.
    pub fn from_tetgen(node: &[u8], ele: &[u8]) -> Result<Self, String> {
        tetgen::read(unmarked(node)?, unmarked(ele)?)?.checked(0)
    }

    /// The mesh without points that are in nothing, if it has triangles, and its points are where
    /// they can be. The file numbers points from `first` on, if it does not say their numbers.
    fn checked(self, first: u64) -> Result<Self, String> {
        if self.triangles.is_empty() {
            return Err("the file has no triangles".into());
        }
        let mesh = self.in_use(first);
        let far = |p: &Triple| p.iter().any(|x| !within(*x));
        if let Some(i) = mesh.positions.iter().position(far) {
            let [x, y, z] = mesh.positions[i];
            let number = mesh.number(i);
            return Err(format!(
                "point {number} is at ({x:e}, {y:e}, {z:e}): {BOUNDS}"
            ));
        }
        Ok(mesh)
    }

    /// The mesh without points that are in nothing, with the numbers of the others.
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

    /// Number of a point in its file.
    pub(crate) fn number(&self, i: usize) -> u64 {
        self.numbers.get(i).copied().unwrap_or(i as u64)
    }

    /// The mesh magnified by that factor.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let positions = self.positions.iter().map(|p| p.map(|x| x * factor));
        Self {
            positions: positions.collect(),
            triangles: self.triangles.clone(),
            tetrahedra: self.tetrahedra.clone(),
            numbers: self.numbers.clone(),
            tetrahedron_numbers: self.tetrahedron_numbers.clone(),
        }
    }

    /// Least height of a triangle over a point or beside it, for each point (m). Slivers count as
    /// higher than they are, lest a surface without thickness is infinitely stiff.
    pub(crate) fn heights(&self) -> Vec<f64> {
        let mut heights = vec![f64::INFINITY; self.positions.len()];
        for t in &self.triangles {
            let [a, b, c] = t.map(|i| Vector3::from(self.positions[i as usize]));
            let longest = (b - a).norm().max((c - b).norm()).max((a - c).norm());
            let height = (b - a).cross(&(c - a)).norm() / longest;
            let height = height.max(SLIVER * longest);
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
