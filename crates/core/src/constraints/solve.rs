//! Solves A lambda = b with A = J W J^T. Many rows are solved by a sparse factorisation of A,
//! unless it shows that they are linearly dependent. Dependent rows and few rows are solved without
//! A by conjugate residuals: a relative of conjugate gradients with the same products with A, which
//! minimises |b - A lambda| in each step. If A is singular it finds one of the solutions; if rows
//! contradict one another, there is none, and it finds the closest approximation, while conjugate
//! gradients would diverge. Rows are scaled so that the diagonal of A is 1.
//!
//! A Cholesky factorisation of A = J W J^T, for linearly independent rows. Its order and pattern
//! are found once: an element of A is not zero if two rows move the same particle or body. A chain
//! of n rods is factorised in time proportional to n.

use std::fmt;
use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

use crate::cholesky;
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
/// Softness of dependent rows, and the number of steps in which it is taken back: along an
/// eigenvector of the eigenvalue 0.001, to 1e-12. Four bars that a stage of 10 ms moves miss their
/// constraints by about the root of this.
const PROXIMAL_SOFTNESS: f64 = 1e-6;
const PROXIMAL_STEPS: usize = 4;
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
    factor: Option<RowFactor>,
}

impl System {
    /// Clears all except the rows, and keeps the capacity.
    pub fn clear(&mut self) {
        self.weights.clear();
        self.vectors.clear();
        self.turnings.clear();
    }

    /// Finds the multipliers. Returns whether A is nearly singular, and was made softer.
    pub fn solve<'a>(&mut self, pattern: impl Fn() -> &'a Arc<RowPattern>) -> bool {
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
    pub fn solve_exactly<'a>(&mut self, pattern: impl Fn() -> &'a Arc<RowPattern>) {
        if self.rows.len() < MIN_DIRECT_ROWS {
            self.iterate(0.0);
        } else if !self.solve_directly(pattern()) {
            self.solve_dependent();
        }
    }

    /// Writes W J^T lambda, the changes by the multipliers, to the vectors.
    pub fn spread(&mut self) {
        spread(&self.rows, &self.weights, &mut self.vectors);
    }

    /// Solves by a factorisation of A. Returns whether that succeeded.
    fn solve_directly(&mut self, pattern: &Arc<RowPattern>) -> bool {
        if !self.factor.as_ref().is_some_and(|f| f.is_of(pattern)) {
            self.factor = RowFactor::new(pattern);
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
            spread(&self.rows, &self.weights, &mut self.vectors);
            find_residuals(&mut self.rows, &self.vectors);
        }
        true
    }

    /// Solves dependent rows. Where a state misses the constraints a little, as the stages of
    /// implicit methods do, such rows contradict one another a little, and A has an eigenvalue as
    /// small as the square of that: the exact solution has forces that depend on rounding. Softness
    /// damps these, and is taken back along all other eigenvectors (the proximal point method:
    /// Rockafellar, *Monotone operators and the proximal point algorithm*, SIAM J. Control Optim.
    /// 14, 1976).
    fn solve_dependent(&mut self) {
        for row in &mut self.rows {
            (row.multiplier, row.residual) = (0.0, row.target);
        }
        for _ in 0..PROXIMAL_STEPS {
            self.correct(PROXIMAL_SOFTNESS);
            self.spread();
            find_residuals(&mut self.rows, &self.vectors);
        }
    }

    /// Finds the multipliers by conjugate residuals, starting from zero, with `softness` added to
    /// the diagonal of A.
    fn iterate(&mut self, softness: f64) {
        for row in &mut self.rows {
            (row.multiplier, row.residual) = (0.0, row.target);
        }
        self.correct(softness);
    }

    /// Adds the solution with the residuals of the rows to their multipliers, with `softness` added
    /// to the diagonal of A.
    fn correct(&mut self, softness: f64) {
        let Self { weights, vectors: u, rows, .. } = self;
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

/// Writes W J^T lambda to u.
fn spread(rows: &[Row], weights: &[Vector3<f64>], u: &mut [Vector3<f64>]) {
    transpose(rows, |row| row.multiplier, u);
    weigh(weights, u);
}

/// Finds the residuals b - A lambda of rows from u = W J^T lambda.
fn find_residuals(rows: &mut [Row], u: &[Vector3<f64>]) {
    each(rows, &|_, row| row.residual = row.target - row.product(u));
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

/// Largest number of elements of A, or of its factor, per row. Systems with more are solved without
/// a factorisation.
const MAX_ELEMENTS_PER_ROW: usize = 40;

/// Least square of a diagonal element of the factor in independent rows. It is 1 for a row that
/// shares nothing with others, and 0 for one that depends on others.
const MIN_INDEPENDENT_SQUARE: f64 = 1e-9;

/// Pattern of the non-zero elements of A.
pub(super) struct RowPattern {
    /// Pairs of rows that share something they move, the lower one first; `None` if A or its factor
    /// would be too large.
    meeting: Option<(Vec<[u32; 2]>, cholesky::Pattern)>,
}

impl RowPattern {
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
        Self { meeting: pattern.map(|pattern| (meeting, pattern)) }
    }
}

impl fmt::Debug for RowPattern {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let elements = self.meeting.as_ref().map(|(meeting, _)| meeting.len());
        write!(f, "Pattern of {elements:?} elements")
    }
}

/// The factor of A.
pub(super) struct RowFactor {
    pattern: Arc<RowPattern>,
    numbers: cholesky::Factor<1, 1>,
    /// Place of each element of A below the diagonal.
    places: Vec<cholesky::BlockPlace>,
}

impl RowFactor {
    /// Creates room for a factor of that pattern; `None` if it would be too large.
    pub fn new(pattern: &Arc<RowPattern>) -> Option<Self> {
        let (meeting, symbolic) = pattern.meeting.as_ref()?;
        Some(Self {
            numbers: cholesky::Factor::new(symbolic)?,
            places: meeting.iter().map(|[i, j]| symbolic.place(*i, *j)).collect(),
            pattern: Arc::clone(pattern),
        })
    }

    /// Returns whether it is a factor of that pattern.
    pub fn is_of(&self, pattern: &Arc<RowPattern>) -> bool {
        Arc::ptr_eq(&self.pattern, pattern)
    }

    /// Factorises A of these rows, with the inverse masses of all that they move. Returns whether
    /// the rows are independent.
    pub fn factorise(&mut self, rows: &[Row], weights: &[Vector3<f64>]) -> bool {
        let Self { pattern, numbers, places } = self;
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

/// A row of J, scaled so that the diagonal of J W J^T is 1.
#[derive(Debug, Default)]
pub(super) struct Row {
    /// Places of the particles and rotations that it moves, and its parts there.
    parts: [(usize, Vector3<f64>); 4],
    used: usize,
    scale: f64,
    /// Rate of change of its equation (m/s), which it should keep at zero.
    pub rate: f64,
    /// Its element of J W J^T lambda in the solution.
    pub target: f64,
    /// Multiplier lambda.
    pub multiplier: f64,
    /// Residual r = b - A lambda.
    pub residual: f64,
    /// Direction p, and its image A p.
    pub direction: f64,
    pub image: f64,
}

impl Row {
    /// Adds a part at a place; place 0 moves nothing.
    pub fn add(&mut self, place: usize, part: Vector3<f64>) {
        if place == 0 {
            return;
        }
        let (parts, rest) = self.parts.split_at_mut(self.used);
        // Both ends of a rod may be on one body.
        if let Some((_, own)) = parts.iter_mut().find(|(own, _)| *own == place) {
            *own += part;
        } else {
            rest[0] = (place, part);
            self.used += 1;
        }
    }

    /// Returns its parts, with their places.
    fn parts(&self) -> &[(usize, Vector3<f64>)] {
        &self.parts[..self.used]
    }

    /// Returns its product with a vector.
    pub fn product(&self, vectors: &[Vector3<f64>]) -> f64 {
        let terms = self.parts().iter().map(|(i, part)| part.dot(&vectors[*i]));
        terms.sum()
    }

    /// Adds its transpose times a number to a vector.
    pub fn spread(&self, number: f64, out: &mut [Vector3<f64>]) {
        for (i, part) in self.parts() {
            out[*i] += part * number;
        }
    }

    /// Returns the element J W J^T of this row and another.
    pub fn element(&self, other: &Self, weights: &[Vector3<f64>]) -> f64 {
        let mut sum = 0.0;
        for (i, part) in self.parts() {
            for (j, others) in other.parts() {
                if i == j {
                    sum += part.dot(&weights[*i].component_mul(others));
                }
            }
        }
        sum
    }

    /// Sets the right-hand side of the row, and scales the row. If all that it moves has infinite
    /// mass, no force can have the effect, and the row is left out.
    pub fn set_target(&mut self, target: f64, weights: &[Vector3<f64>]) {
        let diagonal = self.element(self, weights);
        self.scale = if diagonal > 0.0 { 1.0 / diagonal.sqrt() } else { 0.0 };
        for (_, part) in &mut self.parts[..self.used] {
            *part *= self.scale;
        }
        self.target = target * self.scale;
    }

    /// Returns whether the row is left out, because no force has an effect.
    pub fn is_left_out(&self) -> bool {
        self.scale == 0.0
    }

    /// Returns the multiplier of the row as it was before it was scaled.
    pub fn unscaled(&self) -> f64 {
        self.scale * self.multiplier
    }

    /// Returns the product J^T lambda at a place.
    pub fn at(&self, place: usize) -> Vector3<f64> {
        let own = self.parts().iter().filter(|(own, _)| *own == place);
        own.map(|(_, part)| part * self.multiplier).sum()
    }

    /// Returns the force J^T lambda on its first particle (N).
    pub fn force(&self) -> Vector3<f64> {
        self.parts[0].1 * self.multiplier
    }
}

/// Rotational state of a rigid body.
pub(crate) struct Turning {
    /// Position of its centre (m).
    pub center: Vector3<f64>,
    /// Rotation matrix from its principal axes to the world.
    pub rotation: Matrix3<f64>,
    /// Angular velocity (rad/s).
    pub spin: Vector3<f64>,
    /// Angular acceleration without constraints (rad/s2).
    pub acceleration: Vector3<f64>,
    /// Inverses of the principal moments of inertia (1/kg m2).
    pub inverse_inertia: Vector3<f64>,
}

impl Turning {
    /// Returns the rotation matrix, and angular velocity (rad/s).
    pub(super) fn turned(&self) -> (Matrix3<f64>, Vector3<f64>) {
        (self.rotation, self.spin)
    }
}

/// Lever of a point of a rigid body.
pub(super) struct Lever {
    /// From the centre to the point (m).
    arm: Vector3<f64>,
    rotation: Matrix3<f64>,
    /// Acceleration of the point by the spin alone (m/s2).
    pub(super) inwards: Vector3<f64>,
}

impl Lever {
    pub(super) fn new(turning: &Turning, point: Vector3<f64>) -> Self {
        let arm = point - turning.center;
        Self {
            arm,
            rotation: turning.rotation,
            inwards: turning.spin.cross(&turning.spin.cross(&arm)),
        }
    }

    /// Returns the torque of a force at the point, along the principal axes.
    pub(super) fn of(&self, force: Vector3<f64>) -> Vector3<f64> {
        self.rotation.tr_mul(&self.arm.cross(&force))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_that_moves_a_body_twice_does_not_meet_itself() {
        let pattern = RowPattern::new(&[[1, 2, 1, 2], [1, 2, 3, 4], [3, 4, 0, 0]], 5);
        let (meeting, _) = pattern.meeting.unwrap();
        assert_eq!(meeting, [[0, 1], [1, 2]]);
    }
}
