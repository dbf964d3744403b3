//! LU factorisation of matrices with partial pivoting, of real or complex numbers.

use nalgebra::ComplexField;

use super::pattern::Pattern;
use super::sparse::Sparse;
use crate::integrators::method::MAX_DENSE;

/// Matrix J of real numbers.
pub(super) enum SystemMatrix {
    /// All numbers, row by row.
    Full(Vec<f64>),
    /// The numbers at the entries of a pattern, column by column.
    Sparse(Pattern, Vec<f64>),
}

impl SystemMatrix {
    /// Visits the row, the column and the value of each entry.
    pub fn visit(&self, mut visit: impl FnMut(usize, usize, f64)) {
        match self {
            Self::Full(values) => {
                let n = values.len().isqrt();
                for (k, value) in values.iter().enumerate() {
                    visit(k / n, k % n, *value);
                }
            }
            Self::Sparse(pattern, values) => {
                for ((i, j), value) in pattern.places().into_iter().zip(values) {
                    visit(i as usize, j as usize, *value);
                }
            }
        }
    }
}

/// Cost of the search for pivots, for each entry of the matrix, in products within rows, which are
/// computed in vectors. Measured, as [`SOLUTION`] was, on matrices of 30 and 150 rows.
const SEARCH: f64 = 16.0;
/// Cost of a solution, for each entry of the matrix, in the same unit.
const SOLUTION: f64 = 8.0;

/// Costs of a sparse factorisation and of a solution in the same unit, for each column and for each
/// product. Measured, of real and complex numbers alike, on bands and grids of 64 to 2,500 rows.
const SPARSE: [[f64; 2]; 2] = [[130.0, 14.0], [75.0, 4.0]];

/// Factors of a matrix, with room for them.
pub(super) struct Lu<T> {
    order: usize,
    factors: LuFactors<T>,
    /// Costs of the last factorisation, and of a solution with it, in real multiplications within
    /// rows.
    costs: [f64; 2],
}

/// Factors L and U of a matrix.
enum LuFactors<T> {
    /// In place of the matrix, row by row, and the row that each row was exchanged with, in turn.
    Full(Vec<T>, Vec<usize>),
    Sparse(Box<Sparse<T>>),
}

impl<T: ComplexField<RealField = f64> + Copy> Lu<T> {
    /// Creates room for the factors of a matrix of this order, if it may be full.
    pub fn new(order: usize) -> Self {
        let room = if order > MAX_DENSE { 0 } else { order * order };
        Self {
            order,
            factors: LuFactors::Full(vec![T::zero(); room], vec![0; order]),
            costs: [0.0; 2],
        }
    }

    /// Returns the cost of the last factorisation, in real multiplications within rows.
    pub fn cost(&self) -> f64 {
        self.costs[0]
    }

    /// Returns the cost of a solution in the same unit.
    pub fn cost_of_solution(&self) -> f64 {
        self.costs[1]
    }

    /// Factorises `shift` M - `scale` J, for the entries of M, which is 1 if there are none.
    /// Returns false if it is singular or not finite.
    pub fn factorise(
        &mut self,
        (shift, mass): (T, &[(u32, u32, f64)]),
        scale: f64,
        jacobian: &SystemMatrix,
    ) -> bool {
        let (n, parts) = (self.order, parts::<T>());
        let products = match (jacobian, &mut self.factors) {
            (SystemMatrix::Full(jacobian), _) if jacobian.len() < n * n => None,
            (SystemMatrix::Full(jacobian), LuFactors::Full(matrix, pivots)) => {
                matrix.resize(n * n, T::zero());
                for (entry, slope) in matrix.iter_mut().zip(jacobian) {
                    *entry = T::zero() - T::from_real(scale * slope);
                }
                for (i, j, value) in mass {
                    matrix[*i as usize * n + *j as usize] += shift * T::from_real(*value);
                }
                if mass.is_empty() {
                    let diagonal = matrix.iter_mut().step_by(n + 1);
                    diagonal.for_each(|entry| *entry += shift);
                }
                eliminate(matrix, pivots)
            }
            (SystemMatrix::Sparse(pattern, values), LuFactors::Sparse(factors)) => {
                factors.factorise((shift, mass), scale, (pattern, values))
            }
            (SystemMatrix::Full(_), factors) => {
                *factors = LuFactors::Full(vec![], vec![0; n]);
                return self.factorise((shift, mass), scale, jacobian);
            }
            (SystemMatrix::Sparse(..), factors) => {
                *factors = LuFactors::Sparse(Box::new(Sparse::new(n)));
                return self.factorise((shift, mass), scale, jacobian);
            }
        };
        let Some(products) = products else {
            return false;
        };
        let all = (n * n) as f64;
        self.costs = match &self.factors {
            LuFactors::Full(..) => {
                let costs = [SEARCH * all + parts * products as f64, SOLUTION * all];
                costs.map(|cost| parts * cost)
            }
            LuFactors::Sparse(factors) => {
                let of = |prices: [f64; 2], products: usize| {
                    prices[0] * n as f64 + prices[1] * products as f64
                };
                [of(SPARSE[0], products), of(SPARSE[1], factors.entries())]
            }
        };
        true
    }

    /// Replaces a right-hand side by its solution.
    pub fn solve(&mut self, b: &mut [T]) {
        match &mut self.factors {
            LuFactors::Full(matrix, pivots) => substitute(matrix, pivots, b),
            LuFactors::Sparse(factors) => factors.solve(b),
        }
    }
}

/// Replaces a matrix by its factors, by Gaussian elimination. Returns the number of products;
/// `None` if the matrix is singular or not finite.
fn eliminate<T: ComplexField<RealField = f64> + Copy>(
    matrix: &mut [T],
    pivots: &mut [usize],
) -> Option<usize> {
    let (n, mut products) = (pivots.len(), 0);
    for k in 0..n {
        let size = |i: usize, matrix: &[T]| matrix[i * n + k].norm1();
        let pivot =
            (k..n).max_by(|&i, &j| size(i, matrix).total_cmp(&size(j, matrix))).unwrap_or(k);
        if !(size(pivot, matrix) > 0.0 && size(pivot, matrix).is_finite()) {
            return None;
        }
        pivots[k] = pivot;
        for j in 0..n {
            matrix.swap(k * n + j, pivot * n + j);
        }
        let (above, below) = matrix.split_at_mut((k + 1) * n);
        let pivots = &above[k * n + k..];
        for row in below.chunks_exact_mut(n) {
            let row = &mut row[k..];
            // Most numbers do not act on one another in a large system.
            if row[0] == T::zero() {
                continue;
            }
            let factor = row[0] / pivots[0];
            row[0] = factor;
            products += row.len();
            for (x, pivot) in row[1..].iter_mut().zip(&pivots[1..]) {
                *x -= factor * *pivot;
            }
        }
    }
    Some(products)
}

/// Replaces a right-hand side by its solution, by the factors of a full matrix.
fn substitute<T: ComplexField<RealField = f64> + Copy>(
    matrix: &[T],
    pivots: &[usize],
    b: &mut [T],
) {
    let n = pivots.len();
    for (k, pivot) in pivots.iter().enumerate() {
        b.swap(k, *pivot);
    }
    for i in 0..n {
        for k in 0..i {
            let share = matrix[i * n + k] * b[k];
            b[i] -= share;
        }
    }
    for k in (0..n).rev() {
        let mut rest = -T::zero();
        for j in k + 1..n {
            rest += matrix[k * n + j] * b[j];
        }
        b[k] = (b[k] - rest) / matrix[k * n + k];
    }
}

/// Returns the number of real numbers in a number.
fn parts<T>() -> f64 {
    (size_of::<T>() / size_of::<f64>()) as f64
}

#[cfg(test)]
mod tests {
    use nalgebra::Complex;

    use super::*;

    /// Needs exchanges of rows: the first pivot vanishes.
    #[test]
    fn solutions_meet_their_equations() {
        let jacobian = [0.0, 2.0, -1.0, 1.0, 1.0, 4.0, -3.0, 5.0, 2.0];
        let shift = Complex::new(0.0, 1.5);
        let b: Vec<_> = (1..4).map(|k| Complex::new(f64::from(k), -0.5)).collect();
        let mut lu = Lu::new(3);
        let matrix = |numbers: [f64; 9]| SystemMatrix::Full(numbers.to_vec());
        assert!(lu.factorise((shift, &[]), 2.0, &matrix(jacobian)));
        // Nine entries; two rows of three numbers and one of two below their pivots.
        assert_eq!(lu.cost(), 2.0 * (SEARCH * 9.0 + 2.0 * 8.0));
        assert_eq!(lu.cost_of_solution(), 2.0 * SOLUTION * 9.0);
        let mut x = b.clone();
        lu.solve(&mut x);
        for (i, b) in b.iter().enumerate() {
            let row = jacobian[3 * i..3 * i + 3].iter().zip(&x);
            let product: Complex<f64> = row.map(|(a, x)| x * -2.0 * *a).sum();
            assert!((shift * x[i] + product - b).norm() < 1e-14);
        }
        let mut real = Lu::new(3);
        assert!(real.factorise((0.0, &[]), 1.0, &matrix(jacobian)));
        let singular = [1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 1.0, 1.0];
        assert!(!real.factorise((0.0, &[]), 1.0, &matrix(singular)));
        assert!(!real.factorise((0.0, &[]), 1.0, &matrix([f64::NAN; 9])));
    }
}
