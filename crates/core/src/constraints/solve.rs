//! Solves A lambda = b with A = J W J^T. Many rows are solved by a sparse factorisation of A,
//! unless it shows that they are linearly dependent. Dependent rows and few rows are solved without
//! A by conjugate residuals: a relative of conjugate gradients with the same products with A, which
//! minimises |b - A lambda| in each step. If A is singular it finds one of the solutions; if rows
//! contradict one another, there is none, and it finds the closest approximation, while conjugate
//! gradients would diverge. Rows are scaled so that the diagonal of A is 1.

use std::sync::Arc;

use nalgebra::Vector3;

use super::direct::{Factor, Pattern};
use super::row::Row;
use super::turning::Turning;
use crate::threads::each;

/// Number of rows from which on a factorisation is faster than conjugate residuals.
const MIN_DIRECT_ROWS: usize = 12;
/// Residual relative to b at which the iteration ends: that of rounding.
const TOLERANCE: f64 = 1e-15;
/// Largest number of iterations per row; without rounding, one would be enough.
const MAX_ITERATIONS_PER_ROW: usize = 4;
/// Largest allowed b . lambda over b . b, about the inverse of the least eigenvalue of A: along its
/// eigenvector, even large forces have hardly any effect.
const MAX_AMPLIFICATION: f64 = 1e5;
/// Largest addition to the diagonal of A, when that ratio is ten times as large. A chain of two
/// rods of 1 m, straight and level between two pins, then sags by about a millimetre.
const MAX_SOFTNESS: f64 = 1e-8;

/// System of equations for the multipliers of one evaluation: the inverse mass (1/kg) of each
/// particle that constraints move, or the inverse inertias of a rotation (1/kg m2), a vector, and
/// the rotation, if it is a body's; and the rows.
#[derive(Default)]
pub(super) struct System {
    pub weights: Vec<Vector3<f64>>,
    pub vectors: Vec<Vector3<f64>>,
    pub turnings: Vec<Option<Turning>>,
    pub rows: Vec<Row>,
    factor: Option<Factor>,
}

impl System {
    /// Clears all except the rows, and keeps the capacity.
    pub fn clear(&mut self) {
        self.weights.clear();
        self.vectors.clear();
        self.turnings.clear();
    }

    /// Finds the multipliers. Returns whether A is nearly singular, and was made softer.
    pub fn solve<'a>(&mut self, pattern: impl Fn() -> &'a Arc<Pattern>) -> bool {
        self.solve_exactly(pattern);
        let (mut all, mut amplified) = (0.0, 0.0);
        for row in &self.rows {
            all += row.target * row.target;
            amplified += row.target * row.multiplier;
        }
        // The addition starts at zero, so that forces are continuous.
        let excess = (amplified / (MAX_AMPLIFICATION * all) - 1.0) / 9.0;
        let soft = excess > 0.0;
        if soft {
            self.iterate(MAX_SOFTNESS * excess.min(1.0));
        }
        soft
    }

    /// Finds the multipliers, however large they are.
    pub fn solve_exactly<'a>(&mut self, pattern: impl Fn() -> &'a Arc<Pattern>) {
        if self.rows.len() < MIN_DIRECT_ROWS || !self.solve_directly(pattern()) {
            self.iterate(0.0);
        }
    }

    /// Writes W J^T lambda, the changes by the multipliers, to the vectors.
    pub fn spread(&mut self) {
        transpose(&self.rows, |row| row.multiplier, &mut self.vectors);
        weigh(&self.weights, &mut self.vectors);
    }

    /// Solves by a factorisation of A. Returns whether that succeeded.
    fn solve_directly(&mut self, pattern: &Arc<Pattern>) -> bool {
        if !self.factor.as_ref().is_some_and(|f| f.is_of(pattern)) {
            self.factor = Factor::new(pattern);
        }
        let Some(factor) = &mut self.factor else {
            return false;
        };
        if !factor.factorise(&self.rows, &self.weights) {
            return false;
        }
        // One solve, and another one for the residual that rounding leaves.
        for row in &mut self.rows {
            (row.multiplier, row.residual) = (0.0, row.target);
        }
        for _ in 0..2 {
            factor.solve(&mut self.rows);
            transpose(&self.rows, |row| row.multiplier, &mut self.vectors);
            weigh(&self.weights, &mut self.vectors);
            let vectors = &self.vectors;
            each(&mut self.rows, &|_, row| {
                row.residual = row.target - row.product(vectors);
            });
        }
        true
    }

    /// Finds the multipliers by conjugate residuals, starting from zero, with `softness` added to
    /// the diagonal of A.
    fn iterate(&mut self, softness: f64) {
        let Self {
            weights,
            vectors: u,
            rows,
            ..
        } = self;
        for row in &mut *rows {
            (row.multiplier, row.residual) = (0.0, row.target);
        }
        let all: f64 = rows.iter().map(|row| row.residual * row.residual).sum();
        let mut last = f64::INFINITY;
        for _ in 0..MAX_ITERATIONS_PER_ROW * rows.len() {
            // u = W J^T r, and r . A r from it, which is never negative.
            transpose(rows, |row| row.residual, u);
            let mut rest = weigh(weights, u);
            if softness > 0.0 {
                let squares = rows.iter().map(|row| row.residual * row.residual);
                rest += softness * squares.sum::<f64>();
            }
            let turn = rest / last;
            last = rest;
            let mut square = 0.0;
            for row in &mut *rows {
                row.direction = row.residual + turn * row.direction;
                row.image = row.product(u) + turn * row.image;
                if softness > 0.0 {
                    row.image += softness * row.residual;
                }
                square += row.image * row.image;
            }
            // Written so that NaN ends the iteration.
            if !(rest > TOLERANCE * TOLERANCE * all && square > 0.0) {
                return;
            }
            let step = rest / square;
            for row in &mut *rows {
                row.multiplier += step * row.direction;
                row.residual -= step * row.image;
            }
        }
    }
}

/// Writes J^T times a vector to `out`; `of` returns the vector's element of each row.
fn transpose(rows: &[Row], of: impl Fn(&Row) -> f64, out: &mut [Vector3<f64>]) {
    out.fill(Vector3::zeros());
    for row in rows {
        row.spread(of(row), out);
    }
}

/// Writes W u to u, and returns u . W u.
fn weigh(weights: &[Vector3<f64>], u: &mut [Vector3<f64>]) -> f64 {
    let mut product = 0.0;
    for (u, w) in u.iter_mut().zip(weights) {
        let weighted = w.component_mul(u);
        product += u.dot(&weighted);
        *u = weighted;
    }
    product
}
