//! Symbolic factorisation: the pattern of the factor of a sparse matrix.
//!
//! An order of elimination that keeps a factor sparse: the row with the fewest neighbours comes
//! next, by an upper bound of their number (approximate minimum degree; Amestoy, Davis, Duff, SIAM
//! J. Matrix Anal. Appl. 17, 1996). Elimination makes all neighbours of a row neighbours of one
//! another: they are stored as one list, an element, instead of pair by pair.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

/// Pattern of a factor.
#[derive(Debug)]
pub(crate) struct Pattern {
    /// Column of each row of the matrix.
    pub(super) ranks: Vec<u32>,
    /// First block below the diagonal of each column, and their number.
    pub(super) starts: Vec<u32>,
    /// Row of each of these blocks, as the number of a column.
    pub(super) rows: Vec<u32>,
}

/// Place of a block of the matrix in the factor.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockPlace {
    pub block: u32,
    /// Whether it is stored transposed.
    pub transposed: bool,
}

impl Pattern {
    /// Creates the pattern for a matrix of n rows of blocks, with blocks at these rows and columns,
    /// in either triangle and possibly repeated; `None` if the factor would have more than `most`
    /// blocks below its diagonal.
    pub fn new(n: usize, pairs: impl Iterator<Item = [u32; 2]>, most: usize) -> Option<Self> {
        let meets = neighbours(n, pairs);
        let order = order(meets.clone(), most)?;
        Some(Self::in_order(&order, &meets))
    }

    /// Creates the pattern for a matrix of n rows of blocks and one more row for each of these
    /// `ties`. The row of a tie has blocks in the columns of both of its ends, and is eliminated
    /// next after them. The other blocks are at `pairs`.
    pub fn tied(
        n: usize,
        pairs: impl Iterator<Item = [u32; 2]>,
        ties: &[[u32; 2]],
    ) -> Option<Self> {
        // A tie joins its ends once one of them is eliminated.
        let mut meets = neighbours(n, pairs.chain(ties.iter().copied()));
        let ends_first = order(meets.clone(), usize::MAX)?;
        let mut ranks = vec![0; n];
        for (row, rank) in ends_first.iter().zip(0u32..) {
            ranks[*row as usize] = rank;
        }
        let mut after = vec![vec![]; n];
        for ([i, j], tie) in ties.iter().zip(n as u32..) {
            let last = if ranks[*i as usize] > ranks[*j as usize] { i } else { j };
            after[*last as usize].push(tie);
            let mut ends = vec![*i, *j];
            ends.dedup();
            for end in &ends {
                meets[*end as usize].push(tie);
            }
            meets.push(ends);
        }
        let with_ties = |row: &u32| [&[*row][..], &after[*row as usize]].concat();
        let order: Vec<_> = ends_first.iter().flat_map(with_ties).collect();
        Some(Self::in_order(&order, &meets))
    }

    /// Creates the pattern of a matrix from the neighbours of each row and the order of
    /// elimination.
    fn in_order(order: &[u32], meets: &[Vec<u32>]) -> Self {
        let n = order.len();
        let (ranks, columns) = columns(order, meets);
        let sorted = children_first(&columns);
        let (mut starts, mut rows) = (vec![0], vec![]);
        let mut places = vec![0; n];
        for (place, column) in sorted.iter().zip(0..) {
            places[*place as usize] = column;
        }
        for column in &sorted {
            let from = rows.len();
            rows.extend(columns[*column as usize].iter().map(|row| places[*row as usize]));
            rows[from..].sort_unstable();
            starts.push(rows.len() as u32);
        }
        Self { ranks: ranks.iter().map(|rank| places[*rank as usize]).collect(), starts, rows }
    }

    /// Returns the number of rows of the matrix.
    pub fn len(&self) -> usize {
        self.ranks.len()
    }

    /// Returns the number of blocks below the diagonal of the factor.
    pub fn size(&self) -> usize {
        self.rows.len()
    }

    /// Returns the number of products of blocks in a factorisation.
    pub fn products(&self) -> f64 {
        let lengths = self.starts.windows(2).map(|ends| f64::from(ends[1] - ends[0]));
        lengths.map(|m| 0.5 * m * (m + 3.0)).sum()
    }

    /// Returns the place of the block in row i and column j of the matrix, which must be one of its
    /// pairs.
    pub fn place(&self, i: u32, j: u32) -> BlockPlace {
        let [row, column] = [i, j].map(|i| self.ranks[i as usize]);
        let (low, high) = (row.min(column), row.max(column));
        let own = self.column(low as usize);
        let first = own.start as u32;
        BlockPlace {
            block: first + self.rows[own].partition_point(|row| *row < high) as u32,
            transposed: row < column,
        }
    }

    /// Returns the blocks of a column below the diagonal.
    fn column(&self, column: usize) -> Range<usize> {
        self.starts[column] as usize..self.starts[column + 1] as usize
    }
}

/// Lists the neighbours of each of n rows, in order, from pairs of them that may be repeated.
pub(crate) fn neighbours(n: usize, pairs: impl Iterator<Item = [u32; 2]>) -> Vec<Vec<u32>> {
    let mut meets = vec![vec![]; n];
    for [i, j] in pairs.filter(|[i, j]| i != j) {
        meets[i as usize].push(j);
        meets[j as usize].push(i);
    }
    for others in &mut meets {
        others.sort_unstable();
        others.dedup();
    }
    meets
}

/// Returns the rank of each row in an order, and the rows below the diagonal in each column of the
/// factor, by their ranks.
fn columns(order: &[u32], meets: &[Vec<u32>]) -> (Vec<u32>, Vec<Vec<u32>>) {
    let n = order.len();
    let mut ranks = vec![0; n];
    for (row, rank) in order.iter().zip(0..) {
        ranks[*row as usize] = rank;
    }
    let mut columns: Vec<Vec<u32>> = Vec::with_capacity(n);
    // Children of each column in the elimination tree: a column passes its rows to its parent, that
    // of its first row.
    let mut children: Vec<Vec<u32>> = vec![vec![]; n];
    let mut seen = vec![u32::MAX; n];
    for (row, rank) in order.iter().zip(0u32..) {
        let mut column = vec![];
        let own = meets[*row as usize].iter().map(|other| ranks[*other as usize]);
        let from_children = children[rank as usize].iter();
        let inherited = from_children.flat_map(|child| columns[*child as usize].iter().copied());
        for other in own.chain(inherited) {
            if other > rank && seen[other as usize] != rank {
                seen[other as usize] = rank;
                column.push(other);
            }
        }
        if let Some(parent) = column.iter().min() {
            children[*parent as usize].push(rank);
        }
        columns.push(column);
    }
    (ranks, columns)
}

/// Returns the columns in an order of the elimination tree with the children of each just before
/// it. The order changes nothing but the places of columns in memory.
fn children_first(columns: &[Vec<u32>]) -> Vec<u32> {
    let mut children = vec![vec![]; columns.len()];
    let mut stack = vec![];
    for (column, rows) in columns.iter().enumerate().rev() {
        match rows.iter().min() {
            Some(parent) => children[*parent as usize].push(column as u32),
            None => stack.push(column as u32),
        }
    }
    // Parents before children, then reversed.
    let mut order = vec![];
    while let Some(column) = stack.pop() {
        order.push(column);
        stack.append(&mut children[column as usize]);
    }
    order.reverse();
    order
}

/// Degree above which a row counts as dense and is ordered last, because its list would be
/// traversed too often: at least the first number, and at least the second times the root of the
/// number of rows.
const DENSE_DEGREES: [f64; 2] = [40.0, 2.0];

/// Returns the elimination order (approximate minimum degree) of a matrix given by its adjacency
/// lists; `None` if the factor would have more than `most` blocks below its diagonal.
pub(crate) fn order(mut meets: Vec<Vec<u32>>, most: usize) -> Option<Vec<u32>> {
    let n = meets.len();
    let many = DENSE_DEGREES[0].max(DENSE_DEGREES[1] * (n as f64).sqrt()) as usize;
    let is_last: Vec<bool> = meets.iter().map(|others| others.len() > many).collect();
    for (others, last) in meets.iter_mut().zip(&is_last) {
        others.retain(|j| !last && !is_last[*j as usize]);
    }
    let last = (0..n as u32).filter(|i| is_last[*i as usize]);
    let count = last.clone().count();
    let mut graph = EliminationGraph {
        left: (n - count) as u32,
        blocks: count * (n - count) + count * count.saturating_sub(1) / 2,
        degree: meets.iter().map(|others| others.len() as u32).collect(),
        meets,
        elements: vec![vec![]; n],
        weight: is_last.iter().map(|last| u32::from(!last)).collect(),
        followers: vec![vec![]; n],
        members: vec![vec![]; n],
        size: vec![0; n],
        outside: vec![0; n],
        seen: vec![u32::MAX; n],
        order: Vec::with_capacity(n),
    };
    let degrees = graph.degree.iter().zip(0..);
    let mut queue: BinaryHeap<_> = degrees.map(|(degree, i)| Reverse((*degree, i))).collect();
    while graph.blocks <= most {
        let Some(Reverse((degree, i))) = queue.pop() else {
            graph.order.extend(last);
            return Some(graph.order);
        };
        if graph.weight[i as usize] == 0 || graph.degree[i as usize] != degree {
            continue;
        }
        graph.eliminate(i);
        let members = &graph.members[i as usize];
        queue.extend(members.iter().map(|j| Reverse((graph.degree[*j as usize], *j))));
    }
    None
}

/// The remaining rows, and the elements. An element has the number of the row whose elimination
/// created it.
struct EliminationGraph {
    /// Rows that have not been eliminated.
    left: u32,
    /// Blocks below the diagonal in the columns of eliminated rows, and an upper bound of those in
    /// the rows that come last.
    blocks: usize,
    /// Upper bound of the number of neighbours of each row, without the rows that it represents.
    degree: Vec<u32>,
    /// Neighbours of each row that share no element with it.
    meets: Vec<Vec<u32>>,
    /// Elements that each row is in.
    elements: Vec<Vec<u32>>,
    /// Number of rows that each row represents; 0 once it is eliminated, or another represents it.
    weight: Vec<u32>,
    /// Other rows that each row represents.
    followers: Vec<Vec<u32>>,
    /// Rows of each element; empty once it lies within others.
    members: Vec<Vec<u32>>,
    /// Number of rows in each element, represented ones included.
    size: Vec<u32>,
    /// Number of these that are not in the latest element.
    outside: Vec<u32>,
    /// Latest element for which a row, or an element, was visited.
    seen: Vec<u32>,
    order: Vec<u32>,
}

impl EliminationGraph {
    /// Eliminates a row: its neighbours become an element.
    fn eliminate(&mut self, pivot: u32) {
        let (p, before) = (pivot as usize, self.left);
        self.finish(pivot);
        self.seen[p] = pivot;
        let mut members = std::mem::take(&mut self.meets[p]);
        let absorbed = std::mem::take(&mut self.elements[p]);
        for e in &absorbed {
            members.append(&mut self.members[*e as usize]);
        }
        members.retain(|i| {
            let i = *i as usize;
            let is_new = self.weight[i] > 0 && self.seen[i] != pivot;
            self.seen[i] = pivot;
            is_new
        });
        self.measure(pivot, &members);
        // Rows without other neighbours could be eliminated next without enlarging the factor.
        members.retain(|i| {
            self.shorten(pivot, *i);
            let i = *i as usize;
            let follows = self.meets[i].is_empty() && self.elements[i].is_empty();
            if follows {
                self.finish(i as u32);
            }
            self.elements[i].push(pivot);
            !follows
        });
        let size: u32 = members.iter().map(|i| self.weight[*i as usize]).sum();
        self.size[p] = size;
        let eliminated = (before - self.left) as usize;
        self.blocks += eliminated * (eliminated - 1) / 2 + eliminated * size as usize;
        for i in &members {
            let i = *i as usize;
            let met = self.meets[i].iter().map(|j| self.weight[*j as usize]);
            let (_, elements) = self.elements[i].split_last().unwrap_or((&0, &[]));
            let outside = elements.iter().map(|e| self.outside[*e as usize]);
            let others = size - self.weight[i];
            let degree = met.sum::<u32>() + outside.sum::<u32>() + others;
            let grown = self.degree[i] + others;
            self.degree[i] = degree.min(grown).min(self.left - self.weight[i]);
        }
        self.merge(&mut members);
        self.members[p] = members;
    }

    /// Appends a row, and those that it represents, to the order.
    fn finish(&mut self, row: u32) {
        self.left -= self.weight[row as usize];
        self.weight[row as usize] = 0;
        let mut rows = vec![row];
        while let Some(row) = rows.pop() {
            self.order.push(row);
            rows.append(&mut self.followers[row as usize]);
        }
    }

    /// Counts for each element the rows that are not in `members`.
    fn measure(&mut self, pivot: u32, members: &[u32]) {
        for i in members {
            let weight = self.weight[*i as usize];
            for e in &self.elements[*i as usize] {
                let e = *e as usize;
                if self.seen[e] != pivot {
                    (self.seen[e], self.outside[e]) = (pivot, self.size[e]);
                }
                self.outside[e] -= weight;
            }
        }
    }

    /// Removes neighbours and elements of a row that the pivot's element covers.
    fn shorten(&mut self, pivot: u32, i: u32) {
        let i = i as usize;
        let (members, outside) = (&mut self.members, &self.outside);
        self.elements[i].retain(|e| {
            let e = *e as usize;
            if outside[e] == 0 {
                members[e] = vec![];
            }
            !members[e].is_empty()
        });
        let (weight, seen) = (&self.weight, &self.seen);
        self.meets[i].retain(|j| weight[*j as usize] > 0 && seen[*j as usize] != pivot);
        self.meets[i].sort_unstable();
        self.elements[i].sort_unstable();
    }

    /// Lets one row represent all rows with the same neighbours.
    fn merge(&mut self, members: &mut Vec<u32>) {
        let key = |i: u32| {
            let lists = [&self.meets[i as usize], &self.elements[i as usize]];
            lists.into_iter().flatten().fold(0u32, |sum, j| sum.wrapping_add(*j))
        };
        let mut keyed: Vec<_> = members.iter().map(|i| (key(*i), *i)).collect();
        keyed.sort_unstable();
        members.clear();
        for group in keyed.chunk_by(|a, b| a.0 == b.0) {
            let first = members.len();
            for (_, i) in group {
                let i = *i as usize;
                let alike = |j: &&u32| {
                    let j = **j as usize;
                    self.meets[i] == self.meets[j] && self.elements[i] == self.elements[j]
                };
                let Some(&j) = members[first..].iter().find(alike) else {
                    members.push(i as u32);
                    continue;
                };
                let (j, weight) = (j as usize, std::mem::take(&mut self.weight[i]));
                self.weight[j] += weight;
                self.degree[j] -= weight;
                self.followers[j].push(i as u32);
                (self.meets[i], self.elements[i]) = (vec![], vec![]);
            }
        }
    }
}
