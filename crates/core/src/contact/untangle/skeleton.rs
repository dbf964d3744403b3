//! Edges and triangles of surfaces, and how they are joined.

use std::collections::BTreeMap;

use crate::contact::surface::Surface;
use crate::sets::Sets;

/// Number of vertices along a line of a coarse surface.
const COARSE: f64 = 16.0;

/// Edges and triangles of bodies and obstacles, and how they are joined.
pub(super) struct Skeleton {
    pub edges: Vec<[u32; 2]>,
    pub triangles: Vec<[u32; 3]>,
    /// The triangles at each edge.
    sides: BTreeMap<[u32; 2], Vec<u32>>,
    /// The neighbours of each vertex, with the edges to them.
    pub neighbours: Vec<Vec<(u32, u32)>>,
    /// Vertices at borders.
    pub border: Vec<u32>,
    /// The connected part of each vertex, by its smallest vertex.
    pub parts: Vec<u32>,
    /// Number of vertices of each part.
    counts: Vec<usize>,
}

impl Skeleton {
    pub fn of(surface: &Surface) -> Self {
        let edges: Vec<_> = surface.edges().collect();
        let triangles: Vec<_> = surface.triangles().collect();
        let mut sides = BTreeMap::<_, Vec<u32>>::new();
        for (k, &[a, b, c]) in triangles.iter().enumerate() {
            for side in [[a, b], [b, c], [c, a]] {
                sides.entry(sorted(side)).or_default().push(k as u32);
            }
        }
        let mut neighbours = vec![vec![]; surface.vertices()];
        let mut sets = Sets::new(surface.vertices());
        for (k, [a, b]) in edges.iter().enumerate() {
            neighbours[*a as usize].push((*b, k as u32));
            neighbours[*b as usize].push((*a, k as u32));
            sets.join(*a, *b);
        }
        let parts: Vec<_> = (0..surface.vertices() as u32).map(|i| sets.find(i)).collect();
        let mut counts = vec![0; parts.len()];
        for part in &parts {
            counts[*part as usize] += 1;
        }
        let border = sides.iter().filter(|(_, at)| at.len() == 1);
        Self {
            border: border.flat_map(|(side, _)| *side).collect(),
            parts,
            counts,
            edges,
            triangles,
            sides,
            neighbours,
        }
    }

    /// Returns how many times more vertices along a line than a coarse one the finest part of
    /// these vertices has; 1 for all coarse ones.
    pub fn fineness(&self, vertices: [u32; 2]) -> f64 {
        let counts = vertices.map(|i| self.counts[self.parts[i as usize] as usize]);
        let most = counts[0].max(counts[1]) as f64;
        (most.sqrt() / COARSE).max(1.0)
    }

    /// Returns the triangles at an edge.
    pub fn triangles_at(&self, edge: usize) -> &[u32] {
        let at = self.sides.get(&sorted(self.edges[edge]));
        at.map_or(&[], Vec::as_slice)
    }
}

fn sorted([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
