//! Symbolic factorisation: the pattern of the factor of a sparse matrix.

use std::ops::Range;

use super::order;

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
pub(crate) struct Place {
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
        let order = order::order(meets.clone(), most)?;
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
        let ends_first = order::order(meets.clone(), usize::MAX)?;
        let mut ranks = vec![0; n];
        for (row, rank) in ends_first.iter().zip(0u32..) {
            ranks[*row as usize] = rank;
        }
        let mut after = vec![vec![]; n];
        for ([i, j], tie) in ties.iter().zip(n as u32..) {
            let last = if ranks[*i as usize] > ranks[*j as usize] {
                i
            } else {
                j
            };
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
            rows.extend(
                columns[*column as usize]
                    .iter()
                    .map(|row| places[*row as usize]),
            );
            rows[from..].sort_unstable();
            starts.push(rows.len() as u32);
        }
        Self {
            ranks: ranks.iter().map(|rank| places[*rank as usize]).collect(),
            starts,
            rows,
        }
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
        let lengths = self
            .starts
            .windows(2)
            .map(|ends| f64::from(ends[1] - ends[0]));
        lengths.map(|m| 0.5 * m * (m + 3.0)).sum()
    }

    /// Returns the place of the block in row i and column j of the matrix, which must be one of its
    /// pairs.
    pub fn place(&self, i: u32, j: u32) -> Place {
        let [row, column] = [i, j].map(|i| self.ranks[i as usize]);
        let (low, high) = (row.min(column), row.max(column));
        let own = self.column(low as usize);
        let first = own.start as u32;
        Place {
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
fn neighbours(n: usize, pairs: impl Iterator<Item = [u32; 2]>) -> Vec<Vec<u32>> {
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
        let own = meets[*row as usize]
            .iter()
            .map(|other| ranks[*other as usize]);
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
