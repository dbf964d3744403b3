//! A Cholesky factorisation of A = J W J^T, for rows that do not depend on one another. Its order
//! and pattern are found once: two rows meet where they move the same. A chain of n rods is
//! factorised in time that grows as n.

use std::fmt;
use std::sync::Arc;

use nalgebra::Vector3;

use super::row::Row;
use crate::cholesky;

/// Largest number of elements of A, and of its factor, for each row: what needs more is solved
/// without either.
const MOST: usize = 40;

/// The least square of a diagonal element of the factor, which is 1 for a row that meets no other
/// and 0 for one that depends on others.
const INDEPENDENT: f64 = 1e-9;

/// Which elements of A are not zero.
pub(super) struct Pattern {
    /// The rows that each one meets, of those after it; `None` if A or its factor would be too
    /// large.
    meeting: Option<(Vec<[u32; 2]>, cholesky::Pattern)>,
}

impl Pattern {
    /// Pattern of rows with the places of what each moves, 0 where it moves less, of so many.
    pub fn new(rows: &[[usize; 4]], places: usize) -> Self {
        let mut at_place = vec![vec![]; places];
        let (mut meeting, most) = (vec![], MOST * rows.len());
        for (r, moved) in rows.iter().enumerate() {
            let mut before = vec![];
            for place in moved.iter().filter(|place| **place != 0) {
                before.extend_from_slice(&at_place[*place]);
                at_place[*place].push(r as u32);
            }
            before.sort_unstable();
            before.dedup();
            meeting.extend(before.iter().map(|other| [*other, r as u32]));
            if meeting.len() > most {
                return Self { meeting: None };
            }
        }
        let pattern = cholesky::Pattern::new(rows.len(), meeting.iter().copied(), most);
        Self {
            meeting: pattern.map(|pattern| (meeting, pattern)),
        }
    }
}

impl fmt::Debug for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let elements = self.meeting.as_ref().map(|(meeting, _)| meeting.len());
        write!(f, "Pattern of {elements:?} elements")
    }
}

/// The factor of A.
pub(super) struct Factor {
    pattern: Arc<Pattern>,
    numbers: cholesky::Factor<1, 1>,
    /// Place of each element of A below the diagonal.
    places: Vec<cholesky::Place>,
}

impl Factor {
    /// Room for a factor of that pattern; `None` if it would be too large.
    pub fn new(pattern: &Arc<Pattern>) -> Option<Self> {
        let (meeting, symbolic) = pattern.meeting.as_ref()?;
        Some(Self {
            numbers: cholesky::Factor::new(symbolic)?,
            places: meeting
                .iter()
                .map(|[i, j]| symbolic.place(*i, *j))
                .collect(),
            pattern: Arc::clone(pattern),
        })
    }

    /// Whether it is a factor of that pattern.
    pub fn is_of(&self, pattern: &Arc<Pattern>) -> bool {
        Arc::ptr_eq(&self.pattern, pattern)
    }

    /// Factorises A of these rows, with the inverse masses of what they move. Returns whether the
    /// rows are independent.
    pub fn factorise(&mut self, rows: &[Row], weights: &[Vector3<f64>]) -> bool {
        let Self {
            pattern,
            numbers,
            places,
        } = self;
        let Some((meeting, pattern)) = &pattern.meeting else {
            return false;
        };
        numbers.clear();
        for (i, row) in rows.iter().enumerate() {
            let own = row.element(row, weights);
            *numbers.diagonal_mut(pattern, i) = [[if row.is_left_out() { 1.0 } else { own }]];
        }
        for ([i, j], place) in meeting.iter().zip(places) {
            let element = rows[*i as usize].element(&rows[*j as usize], weights);
            *numbers.block_mut(*place) = [[element]];
        }
        numbers.factorise(pattern) && numbers.least_square() > INDEPENDENT
    }

    /// Adds the solution of A x = r, with the residuals r of the rows, to their multipliers.
    pub fn solve(&mut self, rows: &mut [Row]) {
        let Some((_, pattern)) = &self.pattern.meeting else {
            return;
        };
        for (i, row) in rows.iter().enumerate() {
            *self.numbers.unknowns_mut(pattern, i) = [row.residual];
        }
        self.numbers.solve(pattern);
        for (i, row) in rows.iter_mut().enumerate() {
            row.multiplier += self.numbers.unknowns_mut(pattern, i)[0];
        }
    }
}
