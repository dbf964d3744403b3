//! A sparse Cholesky factorisation (faer) of A = J W J^T, for rows that do not depend on one
//! another. Its order and pattern are found once: two rows meet where they move the same. A chain
//! of n rods is factorised in time that grows as n.

use std::fmt;
use std::sync::Arc;

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltRegularization;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};
use nalgebra::Vector3;

use super::row::Row;

/// Largest number of elements of A, and of its factor, for each row: what needs more is solved
/// without either.
const MOST: usize = 40;

/// The least square of a diagonal element of the factor, which is 1 for a row that meets no other
/// and 0 for one that depends on others.
const INDEPENDENT: f64 = 1e-9;

/// Which elements of A are not zero.
pub(super) struct Pattern {
    column_starts: Vec<u32>,
    rows: Vec<u32>,
    /// `None` if A or its factor would be too large.
    symbolic: Option<SymbolicCholesky<u32>>,
}

impl Pattern {
    /// Pattern of rows with the places of what each moves, 0 where it moves less, of so many.
    pub fn new(rows: &[[usize; 4]], places: usize) -> Self {
        let mut meeting = vec![vec![]; places];
        let (mut column_starts, mut below) = (vec![0], vec![]);
        // Backwards, so that the rows that a place has met are those below.
        let (mut columns, mut elements) = (vec![], 0);
        for (r, moved) in rows.iter().enumerate().rev() {
            let mut column = vec![r as u32];
            for place in moved.iter().filter(|place| **place != 0) {
                column.extend_from_slice(&meeting[*place]);
                meeting[*place].push(r as u32);
            }
            column.sort_unstable();
            column.dedup();
            elements += column.len();
            columns.push(column);
            if elements > MOST * rows.len() {
                break;
            }
        }
        let fits = columns.len() == rows.len();
        for column in columns.into_iter().rev() {
            below.extend(column);
            column_starts.push(below.len() as u32);
        }
        let mut pattern = Self {
            column_starts,
            rows: below,
            symbolic: None,
        };
        if fits {
            pattern.symbolic = pattern
                .analyse()
                .filter(|s| s.len_val() <= MOST * rows.len());
        }
        pattern
    }

    fn elements(&self) -> SymbolicSparseColMatRef<'_, u32> {
        let n = self.column_starts.len() - 1;
        SymbolicSparseColMatRef::new_checked(n, n, &self.column_starts, None, &self.rows)
    }

    fn analyse(&self) -> Option<SymbolicCholesky<u32>> {
        // Number by number, so that the bits do not depend on the processor.
        let parameters = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SIMPLICIAL,
            ..CholeskySymbolicParams::default()
        };
        factorize_symbolic_cholesky(
            self.elements(),
            Side::Lower,
            SymmetricOrdering::Amd,
            parameters,
        )
        .ok()
    }
}

impl fmt::Debug for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "Pattern of {} elements", self.rows.len())
    }
}

/// The elements of A, its factor, and scratch.
pub(super) struct Factor {
    pattern: Arc<Pattern>,
    values: Vec<f64>,
    numbers: Vec<f64>,
    unknowns: Vec<f64>,
    memory: MemBuffer,
}

impl Factor {
    /// Room for a factor of that pattern; `None` if it would be too large.
    pub fn new(pattern: &Arc<Pattern>) -> Option<Self> {
        let symbolic = pattern.symbolic.as_ref()?;
        let room = symbolic
            .factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default())
            .or(symbolic.solve_in_place_scratch::<f64>(1, Par::Seq));
        Some(Self {
            values: vec![0.0; pattern.rows.len()],
            numbers: vec![0.0; symbolic.len_val()],
            unknowns: vec![0.0; pattern.column_starts.len() - 1],
            memory: MemBuffer::try_new(room).ok()?,
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
        let pattern = &self.pattern;
        let Some(symbolic) = &pattern.symbolic else {
            return false;
        };
        for (row, ends) in rows.iter().zip(pattern.column_starts.windows(2)) {
            let column = ends[0] as usize..ends[1] as usize;
            for (value, other) in self.values[column.clone()]
                .iter_mut()
                .zip(&pattern.rows[column])
            {
                *value = row.element(&rows[*other as usize], weights);
            }
            if row.is_left_out() {
                self.values[ends[0] as usize] = 1.0;
            }
        }
        let factorised = symbolic.factorize_numeric_llt(
            &mut self.numbers,
            SparseColMatRef::new(pattern.elements(), &self.values),
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            MemStack::new(&mut self.memory),
            Spec::default(),
        );
        factorised.is_ok() && self.least_diagonal() > INDEPENDENT
    }

    /// The least square of a diagonal element of the factor.
    fn least_diagonal(&self) -> f64 {
        use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw::Simplicial;
        let Some(Simplicial(factor)) = self.pattern.symbolic.as_ref().map(SymbolicCholesky::raw)
        else {
            return 0.0;
        };
        let starts = factor.col_ptr()[..factor.ncols()].iter();
        let squares = starts.map(|start| self.numbers[*start as usize].powi(2));
        squares.fold(f64::INFINITY, f64::min)
    }

    /// Adds the solution of A x = r, with the residuals r of the rows, to their multipliers.
    pub fn solve(&mut self, rows: &mut [Row]) {
        let Some(symbolic) = &self.pattern.symbolic else {
            return;
        };
        for (unknown, row) in self.unknowns.iter_mut().zip(&*rows) {
            *unknown = row.residual;
        }
        let dim = self.unknowns.len();
        LltRef::new(symbolic, &self.numbers).solve_in_place_with_conj(
            Conj::No,
            MatMut::from_column_major_slice_mut(&mut self.unknowns, dim, 1),
            Par::Seq,
            MemStack::new(&mut self.memory),
        );
        for (unknown, row) in self.unknowns.iter().zip(rows) {
            row.multiplier += unknown;
        }
    }
}
