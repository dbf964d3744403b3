//! LU factorisation of sparse matrices with partial pivoting, of real or complex numbers, column by
//! column, each from the columns of L to its left (Gilbert, Peierls, *Sparse partial pivoting in
//! time proportional to arithmetic operations*, SIAM J. Sci. Stat. Comput. 9, 1988).

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use nalgebra::ComplexField;

use super::pattern::Pattern;

/// Least size of an entry of the diagonal, over the largest one below it, with which it is the
/// pivot: exchanges of rows undo the order of little fill.
const DIAGONAL_SHARE: f64 = 0.1;

/// No rank: the row is not eliminated yet.
const NONE: u32 = u32::MAX;

/// Columns of a triangular factor, without its diagonal.
struct FactorColumns<T> {
    starts: Vec<usize>,
    entries: Vec<(u32, T)>,
}

/// Factors L and U of a matrix, in the order of its pattern.
pub(super) struct Sparse<T> {
    /// Column of each rank, as in the pattern.
    order: Vec<u32>,
    /// Rank at which each row is eliminated, and row that is eliminated at each rank.
    ranks: Vec<u32>,
    pivots: Vec<u32>,
    /// L, whose entries have the numbers of their rows, and a diagonal of ones.
    lower: FactorColumns<T>,
    /// U, whose entries have the ranks of their rows.
    upper: FactorColumns<T>,
    /// Reciprocals of the diagonal of U.
    reciprocals: Vec<T>,
    /// Column that is eliminated, and whether each row of it is listed.
    column: Vec<T>,
    listed: Vec<bool>,
    /// Its rows that are eliminated, by rank, and its other rows.
    before: BinaryHeap<Reverse<(u32, u32)>>,
    after: Vec<u32>,
}

impl<T: ComplexField<RealField = f64> + Copy> Sparse<T> {
    /// Creates room for the factors of a matrix of this order.
    pub fn new(order: usize) -> Self {
        let columns = || FactorColumns { starts: vec![], entries: vec![] };
        Self {
            order: vec![],
            ranks: vec![NONE; order],
            pivots: vec![],
            lower: columns(),
            upper: columns(),
            reciprocals: vec![],
            column: vec![T::zero(); order],
            listed: vec![false; order],
            before: BinaryHeap::new(),
            after: vec![],
        }
    }

    /// Returns the number of entries of the factors.
    pub fn entries(&self) -> usize {
        self.lower.entries.len() + self.upper.entries.len() + self.reciprocals.len()
    }

    /// Factorises `shift` M - `scale` J, for the entries of M, column by column, or 1, and the
    /// values of J at the entries of a pattern. Returns the number of products; `None` if the
    /// matrix is singular or not finite.
    pub fn factorise(
        &mut self,
        (shift, mass): (T, &[(u32, u32, f64)]),
        scale: f64,
        (pattern, values): (&Pattern, &[f64]),
    ) -> Option<usize> {
        self.order.clone_from(&pattern.order);
        self.ranks.fill(NONE);
        self.pivots.clear();
        self.reciprocals.clear();
        for columns in [&mut self.lower, &mut self.upper] {
            columns.starts.clear();
            columns.starts.push(0);
            columns.entries.clear();
        }
        let mut products = 0;
        for rank in 0..self.order.len() {
            let j = self.order[rank];
            let first = mass.partition_point(|(_, column, _)| *column < j);
            let own = mass[first..].iter();
            for (row, _, value) in own.take_while(|(_, column, _)| *column == j) {
                self.put(*row, shift * T::from_real(*value));
            }
            if mass.is_empty() {
                self.put(j, shift);
            }
            for k in pattern.column(j as usize) {
                self.put(pattern.rows[k], T::from_real(-scale * values[k]));
            }
            products += self.reduce();
            let pivoted = self.pivot(j, rank as u32);
            for i in self.after.drain(..) {
                self.listed[i as usize] = false;
                self.column[i as usize] = T::zero();
            }
            if !pivoted {
                return None;
            }
        }
        Some(products)
    }

    /// Adds a value to a row of the column.
    fn put(&mut self, row: u32, value: T) {
        let i = row as usize;
        self.column[i] += value;
        if !std::mem::replace(&mut self.listed[i], true) {
            match self.ranks[i] {
                NONE => self.after.push(row),
                rank => self.before.push(Reverse((rank, row))),
            }
        }
    }

    /// Eliminates the rows of the column that have ranks, in their order: they become a column of
    /// U. Returns the number of products.
    fn reduce(&mut self) -> usize {
        let mut products = 0;
        while let Some(Reverse((rank, row))) = self.before.pop() {
            let factor = std::mem::replace(&mut self.column[row as usize], T::zero());
            self.listed[row as usize] = false;
            self.upper.entries.push((rank, factor));
            let below = self.lower.starts[rank as usize]..self.lower.starts[rank as usize + 1];
            products += below.len() + 1;
            for k in below {
                let (row, share) = self.lower.entries[k];
                self.put(row, -(share * factor));
            }
        }
        self.upper.starts.push(self.upper.entries.len());
        products
    }

    /// Chooses the pivot among the other rows of column j, and makes these a column of L. Returns
    /// false if there is none.
    fn pivot(&mut self, j: u32, rank: u32) -> bool {
        let size = |i: &u32| self.column[*i as usize].norm1();
        let largest = self.after.iter().max_by(|a, b| size(a).total_cmp(&size(b)));
        let Some(&largest) = largest else {
            return false;
        };
        let most = size(&largest);
        if !(most > 0.0 && most.is_finite()) {
            return false;
        }
        let is_own = self.ranks[j as usize] == NONE && size(&j) >= DIAGONAL_SHARE * most;
        let row = if is_own { j } else { largest };
        let reciprocal = T::one() / self.column[row as usize];
        self.ranks[row as usize] = rank;
        self.pivots.push(row);
        self.reciprocals.push(reciprocal);
        let others = self.after.iter().filter(|i| **i != row);
        let shares = others.map(|i| (*i, self.column[*i as usize] * reciprocal));
        self.lower.entries.extend(shares);
        self.lower.starts.push(self.lower.entries.len());
        true
    }

    /// Replaces a right-hand side by its solution.
    pub fn solve(&mut self, b: &mut [T]) {
        let Self { order, pivots, lower, upper, reciprocals, column: x, .. } = self;
        for (rank, row) in pivots.iter().enumerate() {
            x[rank] = b[*row as usize];
            for (other, share) in &lower.entries[lower.starts[rank]..lower.starts[rank + 1]] {
                b[*other as usize] -= *share * x[rank];
            }
        }
        for rank in (0..order.len()).rev() {
            x[rank] *= reciprocals[rank];
            for (above, factor) in &upper.entries[upper.starts[rank]..upper.starts[rank + 1]] {
                let change = *factor * x[rank];
                x[*above as usize] -= change;
            }
        }
        for (x, column) in x.iter_mut().zip(&*order) {
            b[*column as usize] = std::mem::replace(x, T::zero());
        }
    }
}
