//! The pattern of a large Jacobian J of f, from changes of f alone, and its colours.
//!
//! Most numbers of a large system act on few others. The pattern is found by halves: if a block of
//! columns acts on some rows, then either half of it acts on no others. Halves of blocks that act
//! on different rows are therefore told apart by one change of f, and a band is found by some
//! changes for each doubling of its length. Where that tells few halves apart, because neighbours
//! in number do not act on the same rows, each column is changed alone.
//!
//! Columns without a common row have one colour: one difference quotient gives all of them (Curtis,
//! Powell, Reid, *On the estimation of sparse Jacobian matrices*, J. Inst. Maths Applics 13, 1974).

use std::ops::Range;

use crate::cholesky;

/// Number of halves from which on each column is changed alone if few halves are told apart.
const MANY_HALVES: usize = 32;

/// Pattern of a square matrix, column by column.
pub(super) struct Pattern {
    /// Place at which each column begins among the entries, and at last their number.
    pub starts: Vec<usize>,
    /// Row of each entry, in rising order within a column.
    pub rows: Vec<u32>,
    /// Columns by colour.
    pub colours: Vec<Vec<usize>>,
    /// Columns in an order of elimination with little fill.
    pub order: Vec<u32>,
}

/// Block of columns, with the rows that it may act on.
struct ColumnBlock {
    columns: Range<usize>,
    rows: Vec<u32>,
}

impl Pattern {
    /// Searches the pattern of a matrix of a size. `changed` lists the rows that change if the
    /// numbers in these ranges do. Returns `None` for a matrix with more than a quarter of all
    /// entries, or more than `most` of them in its factors.
    pub fn find(
        size: usize,
        most: usize,
        mut changed: impl FnMut(&[Range<usize>]) -> Vec<u32>,
    ) -> Option<Self> {
        let rows = (0..size as u32).collect();
        let columns = 0..size;
        let mut blocks = vec![ColumnBlock { columns, rows }];
        while blocks.iter().any(|block| block.columns.len() > 1) {
            let halves: Vec<_> = blocks.iter().flat_map(halves).collect();
            let groups = group(size, halves.iter().map(|(_, rows)| *rows));
            if halves.len() >= MANY_HALVES && 2 * groups.len() > halves.len() {
                let room = (size * size / 4).min(2 * most + size);
                let (mut each, mut entries) = (vec![], 0);
                for j in 0..size {
                    each.push(changed(std::slice::from_ref(&(j..j + 1))));
                    entries += each[j].len();
                    if entries > room {
                        return None;
                    }
                }
                return Self::of(&each, most);
            }
            let mut found = vec![vec![]; halves.len()];
            for members in groups {
                let mut owner = vec![None; size];
                for k in &members {
                    for row in halves[*k].1 {
                        owner[*row as usize] = Some(*k);
                    }
                }
                let ranges: Vec<_> = members.iter().map(|k| halves[*k].0.clone()).collect();
                for row in changed(&ranges) {
                    if let Some(k) = owner[row as usize] {
                        found[k].push(row);
                    }
                }
            }
            let both = halves.into_iter().zip(found);
            blocks = both.map(|((columns, _), rows)| ColumnBlock { columns, rows }).collect();
        }
        let columns: Vec<_> = blocks.into_iter().map(|block| block.rows).collect();
        Self::of(&columns, most)
    }

    /// Creates the pattern with entries in these rows of each column; see [`find`](Self::find).
    pub fn of(columns: &[Vec<u32>], most: usize) -> Option<Self> {
        let size = columns.len();
        let entries: usize = columns.iter().map(Vec::len).sum();
        if 4 * entries > size * size {
            return None;
        }
        let pairs = columns.iter().zip(0..);
        let pairs = pairs.flat_map(|(rows, j)| rows.iter().map(move |i| [*i, j]));
        let order = cholesky::order(cholesky::neighbours(size, pairs), most)?;
        let mut starts = vec![0];
        starts.extend(columns.iter().scan(0, |sum, rows| {
            *sum += rows.len();
            Some(*sum)
        }));
        Some(Self {
            starts,
            rows: columns.concat(),
            colours: group(size, columns.iter().map(Vec::as_slice)),
            order,
        })
    }

    /// Returns the numbers of the entries of a column.
    pub fn column(&self, j: usize) -> Range<usize> {
        self.starts[j]..self.starts[j + 1]
    }

    /// Returns the row and the column of each entry.
    pub fn places(&self) -> Vec<(u32, u32)> {
        let columns = 0..self.starts.len() - 1;
        let of = |j: usize| self.column(j).map(move |k| (self.rows[k], j as u32));
        columns.flat_map(of).collect()
    }

    /// Returns the pattern in an order for a sum with a matrix that has these entries besides.
    pub fn summed_with(mut self, others: &[(u32, u32, f64)], most: usize) -> Self {
        if others.iter().any(|(i, j, _)| i != j) {
            let others = others.iter().map(|(i, j, _)| [*i, *j]);
            let own = self.places().into_iter().map(|(i, j)| [i, j]);
            let neighbours = cholesky::neighbours(self.starts.len() - 1, own.chain(others));
            // With much fill, any order is as good.
            self.order = cholesky::order(neighbours, most).unwrap_or(self.order);
        }
        self
    }

    /// Returns the pattern with the entries of both, of the same size; see [`find`](Self::find).
    pub fn joined(&self, other: &Self, most: usize) -> Option<Self> {
        let both = (0..self.starts.len() - 1).map(|j| {
            let rows = [self, other].map(|pattern| &pattern.rows[pattern.column(j)]);
            let mut rows = rows.concat();
            rows.sort_unstable();
            rows.dedup();
            rows
        });
        Self::of(&both.collect::<Vec<_>>(), most)
    }
}

/// Returns the halves of a block, each with the rows of the block; a single column is one half.
fn halves(block: &ColumnBlock) -> impl Iterator<Item = (Range<usize>, &[u32])> {
    let Range { start, end } = block.columns;
    let middle = start.midpoint(end);
    let halves = [start..middle, middle..end].into_iter();
    let halves = halves.filter(|columns| !columns.is_empty());
    halves.map(|columns| (columns, &*block.rows))
}

/// Groups the numbers of lists of rows: each comes into the first group in which no other list has
/// one of its rows.
fn group<'a>(size: usize, lists: impl Iterator<Item = &'a [u32]>) -> Vec<Vec<usize>> {
    // For each group, the number after that of the last list that it cannot take.
    let (mut groups, mut met): (Vec<Vec<usize>>, Vec<usize>) = (vec![], vec![]);
    let mut of_row: Vec<Vec<u32>> = vec![vec![]; size];
    for (number, rows) in lists.enumerate() {
        for k in rows.iter().flat_map(|row| &of_row[*row as usize]) {
            met[*k as usize] = number + 1;
        }
        let free = met.iter().position(|met| *met <= number);
        let k = free.unwrap_or(groups.len());
        if k == groups.len() {
            groups.push(vec![]);
            met.push(0);
        }
        groups[k].push(number);
        for row in rows {
            of_row[*row as usize].push(k as u32);
        }
    }
    groups
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the pattern of a matrix that is not zero where `acts` says so, and the number of
    /// changes that the search took.
    fn search(size: usize, acts: impl Fn(usize, usize) -> bool) -> (Option<Pattern>, usize) {
        let mut count = 0;
        let found = Pattern::find(size, 1 << 22, |ranges| {
            count += 1;
            let acted =
                |i: &u32| ranges.iter().flat_map(Clone::clone).any(|j| acts(*i as usize, j));
            (0..size as u32).filter(acted).collect()
        });
        (found, count)
    }

    #[test]
    fn a_band_is_found_by_few_changes() {
        let acts = |i: usize, j: usize| i.abs_diff(j) <= 1;
        let (found, count) = search(500, acts);
        let found = found.unwrap();
        for j in 0..500 {
            let rows = found.rows[found.column(j)].iter();
            assert!(
                rows.eq((0..500_u32).filter(|i| acts(*i as usize, j)).collect::<Vec<_>>().iter())
            );
        }
        assert_eq!(found.colours.len(), 3);
        // Nine doublings.
        assert!(count <= 9 * 6, "{count}");
    }

    /// Five points of a plane grid, in two fields one after the other, each acting on both.
    #[test]
    fn grids_of_several_fields_are_found() {
        let place = |k: usize| [k % 288 % 18, k % 288 / 18];
        let acts = |i: usize, j: usize| {
            let [[a, b], [c, d]] = [place(i), place(j)];
            a.abs_diff(c) + b.abs_diff(d) <= usize::from(i / 288 == j / 288)
        };
        let (found, count) = search(576, acts);
        let found = found.unwrap();
        let entries = (0..576).map(|j| (0..576).filter(|i| acts(*i, j)).count());
        assert_eq!(found.rows.len(), entries.sum::<usize>());
        assert!(found.colours.len() <= 16, "{}", found.colours.len());
        assert!(count < 150, "{count}");
    }

    /// A row that all numbers act on, and neighbours in a chain whose numbers are mixed up.
    #[test]
    fn what_halves_do_not_tell_apart_is_found_by_columns() {
        let mixed = |k: usize| k * 163 % 500;
        let shapes: [&dyn Fn(usize, usize) -> bool; 2] =
            [&|i, j| i == j || i == 7, &|i, j| mixed(i).abs_diff(mixed(j)) <= 1];
        for (acts, colours) in shapes.into_iter().zip([500, 5]) {
            let (found, count) = search(500, acts);
            let found = found.unwrap();
            let entries = (0..500).map(|j| (0..500).filter(|i| acts(*i, j)).count());
            assert_eq!(found.rows.len(), entries.sum::<usize>());
            assert!(found.colours.len() <= colours, "{}", found.colours.len());
            assert!(count <= 562, "{count}");
        }
        assert!(search(100, |_, _| true).0.is_none());
    }
}
