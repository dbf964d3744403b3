//! Meshes: points, triangles and tetrahedra, and the springs of a cloth with the shape of a mesh.
//!
//! Points at the same place become one: files have several where normals, textures or nodes
//! change.

use std::collections::BTreeMap;

use a3_core::{Error, Spring, SpringKind, SpringLaw, Vector3};

use crate::description::Triple;

/// Largest number of points in a file.
pub(super) const MAX_POINTS: usize = 1 << 20;
/// Largest number of triangles in a file.
pub(super) const MAX_TRIANGLES: usize = 2 * MAX_POINTS;
/// Largest number of tetrahedra in a file.
pub(super) const MAX_TETRAHEDRA: usize = MAX_POINTS;

/// Checks that there are not too many triangles.
pub(super) fn check_triangles(count: usize) -> Result<(), String> {
    refuse!(if count > MAX_TRIANGLES => "there are more than {MAX_TRIANGLES} triangles");
    Ok(())
}

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

    /// Adds a point, unless there are too many.
    pub(super) fn add_point(&mut self, at: Triple) -> Result<(), String> {
        refuse!(if self.positions.len() == MAX_POINTS => "there are more than {MAX_POINTS} points");
        self.positions.push(at);
        Ok(())
    }

    /// Returns the mesh with points at the same place merged, without triangles that have two equal
    /// corners, and without points that are in no triangle.
    #[must_use]
    pub fn welded(&self) -> Self {
        let same = places(&self.positions);
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
        let has_three = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
        mesh.triangles = corners.filter(has_three).collect();
        mesh
    }

    /// Returns the mesh magnified by a factor.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let mut mesh = self.clone();
        mesh.positions.iter_mut().flatten().for_each(|x| *x *= factor);
        mesh
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
                let edge = [from.min(to), from.max(to)];
                edges.entry(edge).or_default().push(opposite);
            }
        }
        let across = edges.values().filter_map(|opposite| match opposite[..] {
            [a, b] if a != b => Some([a.min(b), a.max(b)]),
            _ => None,
        });
        // The corners across an edge may be neighbours themselves, as in a tetrahedron.
        let across = across.filter(|pair| !edges.contains_key(pair));
        let along = edges.keys().map(|pair| (SpringKind::Structural, *pair));
        let all = along.chain(across.map(|pair| (SpringKind::Bend, pair)));
        all.map(|(kind, ends)| {
            let [i, j] = ends.map(|i| i as usize);
            let [a, b] = [i, j].map(|i| Vector3::from(self.positions[i]));
            let law = law(kind, (a - b).norm())?;
            Ok(Spring { kind, i, j, law })
        })
        .collect()
    }
}

/// Largest distance of points that count as one, relative to the mesh's longest side: the sum of a
/// few rounding errors in single precision.
const WELD_DISTANCE: f64 = 1e-6;

/// Side of the cells into which points are sorted, relative to that distance: few points are near
/// the border of a cell.
const CELL: f64 = 4.0;

/// Finds for each point the first one at the same place.
pub(super) fn places(positions: &[Triple]) -> Vec<u32> {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for p in positions {
        for axis in 0..3 {
            low[axis] = low[axis].min(p[axis]);
            high[axis] = high[axis].max(p[axis]);
        }
    }
    let size = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    let least = f64::MIN_POSITIVE / WELD_DISTANCE;
    let near = WELD_DISTANCE * size.into_iter().fold(least, f64::max);
    // Coordinates in which the cells have sides of 1 and begin at 0.
    let scaled = |i: usize| [0, 1, 2].map(|axis| (positions[i][axis] - low[axis]) / (CELL * near));
    let cell = |i: usize| scaled(i).map(|x| x.floor() as u32);
    let mut cells: Vec<_> = (0..positions.len()).map(cell).collect();
    cells.sort_unstable();
    cells.dedup();
    let is_near = |i: usize, k: usize| {
        let apart = [0, 1, 2].map(|axis| positions[i][axis] - positions[k][axis]);
        apart.iter().map(|x| x * x).sum::<f64>() <= near * near
    };
    // The points in a cell that are the first at their place. They are few, because they are apart.
    let mut firsts = vec![vec![]; cells.len()];
    let mut same = Vec::with_capacity(positions.len());
    for i in 0..positions.len() {
        // The cells within reach: one or two along each axis.
        let at = scaled(i);
        let span = at.map(|x| {
            let [from, to] = [x - 1.0 / CELL, x + 1.0 / CELL].map(|x| x.max(0.0) as u32);
            from..=to
        });
        let [xs, ys, zs] = span;
        let around = xs.flat_map(|x| {
            let (ys, zs) = (ys.clone(), zs.clone());
            ys.flat_map(move |y| zs.clone().map(move |z| [x, y, z]))
        });
        let there = around.filter_map(|cell| cells.binary_search(&cell).ok());
        let known = there.flat_map(|cell| &firsts[cell]).copied();
        let first = known.filter(|k| is_near(i, *k as usize)).min();
        if let (None, Ok(own)) = (first, cells.binary_search(&cell(i))) {
            firsts[own].push(i as u32);
        }
        same.push(first.unwrap_or(i as u32));
    }
    same
}
