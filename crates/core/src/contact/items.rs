//! Primitives of surfaces, in the order of a tree of boxes.

use std::collections::BTreeSet;
use std::ops::Range;

/// Primitives of one tree of boxes. Each vertex and each edge belongs to one item, so that no pair
/// is found twice (Curtis et al., *Fast collision detection for deformable models using
/// representative-triangles*, 2008).
#[derive(Clone, Debug, Default)]
pub(super) struct Items {
    /// Corners of the items. The last two corners of an edge are equal, and all three of a point.
    pub corners: Vec<[u32; 3]>,
    /// Rank of each item by its corners, among those of bodies and then of obstacles.
    pub ranks: Vec<u32>,
    /// Vertices, item by item.
    pub vertices: Vec<u32>,
    vertex_ends: Vec<u32>,
    /// Edges, item by item, the lower end of each first.
    pub edges: Vec<[u32; 2]>,
    /// Rank of each edge by its ends, among those of bodies and then of obstacles.
    pub edge_ranks: Vec<u32>,
    edge_ends: Vec<u32>,
}

impl Items {
    /// Items of these triangles, and of those edges and points that are in none of them. They rank
    /// after the items of `others`.
    pub fn new(
        triangles: impl IntoIterator<Item = [u32; 3]>,
        edges: impl IntoIterator<Item = [u32; 2]>,
        others: &Self,
    ) -> Self {
        let mut items = Self::default();
        let (mut seen_vertices, mut seen_edges) = (BTreeSet::new(), BTreeSet::new());
        let lone = edges
            .into_iter()
            .map(|[a, b]| [a.min(b), a.max(b), a.max(b)]);
        for corners in triangles.into_iter().chain(lone) {
            let [a, b, c] = corners;
            if b == c && seen_edges.contains(&[a, b]) {
                continue;
            }
            items.corners.push(corners);
            let new = corners.into_iter().filter(|i| seen_vertices.insert(*i));
            items.vertices.extend(new);
            items.vertex_ends.push(items.vertices.len() as u32);
            let sides: &[[u32; 2]] = if b == c {
                &[[a, b]]
            } else {
                &[[a, b], [b, c], [c, a]]
            };
            let sides = sides.iter().map(|[i, j]| [*i.min(j), *i.max(j)]);
            items
                .edges
                .extend(sides.filter(|side| seen_edges.insert(*side)));
            items.edge_ends.push(items.edges.len() as u32);
        }
        items.ranks = ranks(&items.corners, others.corners.len());
        items.edge_ranks = ranks(&items.edges, others.edges.len());
        items
    }

    /// Whether item k is a triangle.
    pub fn is_triangle(&self, k: usize) -> bool {
        let [_, b, c] = self.corners[k];
        b != c
    }

    /// Indices of the vertices that belong to item k.
    pub fn vertices_of(&self, k: usize) -> Range<usize> {
        range(&self.vertex_ends, k)
    }

    /// Indices of the edges that belong to item k.
    pub fn edges_of(&self, k: usize) -> Range<usize> {
        range(&self.edge_ends, k)
    }
}

/// Ranks of values, counted from `first`.
fn ranks<T: Ord>(values: &[T], first: usize) -> Vec<u32> {
    let mut order: Vec<_> = (0..values.len()).collect();
    order.sort_by_key(|k| &values[*k]);
    let mut ranks = vec![0; values.len()];
    for (rank, k) in order.into_iter().enumerate() {
        ranks[k] = (first + rank) as u32;
    }
    ranks
}

fn range(ends: &[u32], k: usize) -> Range<usize> {
    let start = if k == 0 { 0 } else { ends[k - 1] };
    start as usize..ends[k] as usize
}
