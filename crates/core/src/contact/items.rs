//! Primitives of surfaces: vertices, edges and triangles, each listed once.

use std::collections::BTreeSet;

/// Vertices, edges and triangles of bodies or of obstacles, or the drops of a fluid.
#[derive(Clone, Debug, Default)]
pub(super) struct Items {
    /// Corners of the triangles, and then of those edges and points that are in none of them. The
    /// last two corners of an edge are equal, and all three of a point.
    pub corners: Vec<[u32; 3]>,
    /// Number of triangles.
    triangles: usize,
    /// Rank of each of these by its corners, after those of other items.
    pub ranks: Vec<u32>,
    /// Vertices.
    pub vertices: Vec<u32>,
    /// Edges, the lower end of each first: those of triangles, and then the others. The ends of a
    /// point are equal.
    pub edges: Vec<[u32; 2]>,
    /// Number of edges of triangles.
    sides: usize,
    /// Rank of each edge by its ends, after those of other items.
    pub edge_ranks: Vec<u32>,
}

impl Items {
    /// Collects the vertices, edges and sides of these triangles, and those edges and points that
    /// are in none of them. They rank after all items of `others`.
    pub fn new(
        triangles: impl IntoIterator<Item = [u32; 3]>,
        edges: impl IntoIterator<Item = [u32; 2]>,
        others: &[&Self],
    ) -> Self {
        let mut items = Self::default();
        let (mut seen_vertices, mut seen_edges) = (BTreeSet::new(), BTreeSet::new());
        items.corners.extend(triangles);
        items.triangles = items.corners.len();
        for [a, b, c] in &items.corners {
            let sides = [[a, b], [b, c], [c, a]].map(|[i, j]| [*i.min(j), *i.max(j)]);
            let new = sides.into_iter().filter(|side| seen_edges.insert(*side));
            items.edges.extend(new);
        }
        items.sides = items.edges.len();
        for [a, b] in edges {
            let [a, b] = [a.min(b), a.max(b)];
            if seen_edges.insert([a, b]) {
                items.corners.push([a, b, b]);
                items.edges.push([a, b]);
            }
        }
        let all = items.corners.iter().flatten();
        let new = all.filter(|i| seen_vertices.insert(**i));
        items.vertices.extend(new);
        let before = |count: fn(&Self) -> usize| others.iter().map(|items| count(items)).sum();
        items.ranks = ranks(&items.corners, before(|items| items.corners.len()));
        items.edge_ranks = ranks(&items.edges, before(|items| items.edges.len()));
        items
    }

    /// Returns the corners of the triangles.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.corners[..self.triangles]
    }

    /// Returns whether edge k is a side of a triangle.
    pub fn is_side(&self, k: usize) -> bool {
        k < self.sides
    }
}

/// Ranks values, counted from `first`.
fn ranks<T: Ord>(values: &[T], first: usize) -> Vec<u32> {
    let mut order: Vec<_> = (0..values.len()).collect();
    order.sort_by_key(|k| &values[*k]);
    let mut ranks = vec![0; values.len()];
    for (rank, k) in order.into_iter().enumerate() {
        ranks[k] = (first + rank) as u32;
    }
    ranks
}
