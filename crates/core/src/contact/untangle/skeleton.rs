//! Edges and triangles of surfaces, and how they are joined.

use std::collections::BTreeMap;

use crate::contact::surface::Surface;
use crate::sets::Sets;

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
        let border = sides.iter().filter(|(_, at)| at.len() == 1);
        Self {
            border: border.flat_map(|(side, _)| *side).collect(),
            parts: (0..surface.vertices() as u32)
                .map(|i| sets.find(i))
                .collect(),
            edges,
            triangles,
            sides,
            neighbours,
        }
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
