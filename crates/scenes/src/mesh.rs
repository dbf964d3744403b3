//! Cloth of any shape: structural springs on the edges of its triangles, bend springs across them.

use std::collections::BTreeMap;

use a3_core::{Error, Spring, SpringKind, SpringLaw, Vector3};

use crate::Triple;

/// Triangles over points.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// In m.
    pub positions: Vec<Triple>,
    /// Corners, wound alike.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Points at the same place made one, as files have them twice where normals or textures change; points and
    /// triangles that then are no longer any, left out. Other orders stay as they are.
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

    /// A third of the area of the triangles around each point (m2).
    pub(super) fn areas(&self) -> Vec<f64> {
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

    /// A structural spring on each edge, a bend spring between the corners opposite to an edge of two triangles. `law`
    /// makes one of what it is for and its length (m).
    pub(super) fn springs(
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
        // Where three triangles stand on one another, the corners across an edge may be neighbours themselves.
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
