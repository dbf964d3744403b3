//! A Cholesky factorisation of A = J W J^T, for linearly independent rows. Its order and pattern
//! are found once: an element of A is not zero if two rows move the same particle or body. A chain
//! of n rods is factorised in time proportional to n.

use std::fmt;
use std::sync::Arc;

use nalgebra::Vector3;

use super::row::Row;
use crate::cholesky;

/// Largest number of elements of A, or of its factor, per row. Systems with more are solved without
/// a factorisation.
const MAX_ELEMENTS_PER_ROW: usize = 40;

/// Least square of a diagonal element of the factor in independent rows. It is 1 for a row that
/// shares nothing with others, and 0 for one that depends on others.
const MIN_INDEPENDENT_SQUARE: f64 = 1e-9;

/// Pattern of the non-zero elements of A.
pub(super) struct Pattern {
    /// Pairs of rows that share something they move, the lower one first; `None` if A or its factor
    /// would be too large.
    meeting: Option<(Vec<[u32; 2]>, cholesky::Pattern)>,
}

impl Pattern {
    /// Creates a pattern of rows, each with the places of all that it moves, or 0; there are
    /// `places` of them.
    pub fn new(rows: &[[usize; 4]], places: usize) -> Self {
        let mut at_place = vec![vec![]; places];
        let (mut meeting, most) = (vec![], MAX_ELEMENTS_PER_ROW * rows.len());
        for (r, moved) in rows.iter().enumerate() {
            let mut before = vec![];
            let places = || moved.iter().copied().filter(|place| *place != 0);
            for place in places() {
                before.extend_from_slice(&at_place[place]);
            }
            // Both ends of a constraint may be on one body.
            for place in places() {
                at_place[place].push(r as u32);
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
    /// Creates room for a factor of that pattern; `None` if it would be too large.
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

    /// Returns whether it is a factor of that pattern.
    pub fn is_of(&self, pattern: &Arc<Pattern>) -> bool {
        Arc::ptr_eq(&self.pattern, pattern)
    }

    /// Factorises A of these rows, with the inverse masses of all that they move. Returns whether
    /// the rows are independent.
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
        numbers.factorise(pattern) && numbers.least_square() > MIN_INDEPENDENT_SQUARE
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_that_moves_a_body_twice_does_not_meet_itself() {
        let pattern = Pattern::new(&[[1, 2, 1, 2], [1, 2, 3, 4], [3, 4, 0, 0]], 5);
        let (meeting, _) = pattern.meeting.unwrap();
        assert_eq!(meeting, [[0, 1], [1, 2]]);
    }
}
