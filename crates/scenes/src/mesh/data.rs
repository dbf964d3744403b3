//! Meshes: points, triangles and tetrahedra, and the springs of a cloth with the shape of a mesh.

use std::collections::BTreeMap;

use a3_core::{Error, Spring, SpringKind, SpringLaw, Vector3};

use super::weld;
use crate::description::Triple;

/// Largest number of points in a file.
pub(super) const MAX_POINTS: usize = 1 << 20;
/// Largest number of triangles in a file.
pub(super) const MAX_TRIANGLES: usize = 2 * MAX_POINTS;
/// Largest number of tetrahedra in a file.
pub(super) const MAX_TETRAHEDRA: usize = MAX_POINTS;

/// Height of a triangle relative to its longest side, below which it is a sliver.
const SLIVER: f64 = 1e-3;

/// Mesh of triangles, or of tetrahedra with the triangles around them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Positions of the points (m).
    pub positions: Vec<Triple>,
    /// Corners of the triangles, all in the same winding order.
    pub triangles: Vec<[u32; 3]>,
    /// Corners of the tetrahedra, if the file has any. Their volumes are positive, unless the file
    /// mixes orientations.
    pub tetrahedra: Vec<[u32; 4]>,
    /// Numbers of the points in the file; empty if it counts them from 0.
    pub numbers: Vec<u64>,
    /// Numbers of the tetrahedra in the file.
    pub tetrahedron_numbers: Vec<u64>,
}

impl Mesh {
    /// Returns the number of a point in its file.
    pub(crate) fn number(&self, i: usize) -> u64 {
        self.numbers.get(i).copied().unwrap_or(i as u64)
    }

    /// Returns the mesh with points at the same place merged, without triangles that have two equal
    /// corners, and without points that are in no triangle.
    #[must_use]
    pub fn welded(&self) -> Self {
        let same = weld::places(&self.positions);
        let mut new = vec![u32::MAX; self.positions.len()];
        let mut mesh = Self::default();
        let mut corner = |i: u32| {
            let place = &mut new[same[i as usize] as usize];
            if *place == u32::MAX {
                *place = mesh.positions.len() as u32;
                mesh.positions.push(self.positions[i as usize]);
                mesh.numbers.push(self.number(i as usize));
            }
            *place
        };
        let corners = self.triangles.iter().map(|t| t.map(&mut corner));
        mesh.triangles = corners
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect();
        mesh
    }

    /// Returns the mesh magnified by a factor.
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

    /// Finds the smallest height of the triangles around each point (m). A sliver counts as higher
    /// than it is, because the stiffness of contact grows as the height shrinks.
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

    /// Returns a third of the area of the triangles around each point (m2).
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

    /// Lists the springs: a structural one on each edge, and a bend one between the two corners
    /// opposite to an edge of two triangles. `law` gives the law of a spring by its kind and length
    /// (m).
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
