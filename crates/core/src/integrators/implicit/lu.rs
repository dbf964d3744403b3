//! LU factorisation of dense matrices with partial pivoting, of real or complex numbers.

use nalgebra::ComplexField;

/// Cost of the search for pivots, for each entry of the matrix, in products within rows, which are
/// computed in vectors. Measured, as [`SOLUTION`] was, on matrices of 30 and 150 rows.
const SEARCH: f64 = 16.0;
/// Cost of a solution, for each entry of the matrix, in the same unit.
const SOLUTION: f64 = 8.0;

/// Factors L and U of a matrix, in place of it, with room for them.
pub(super) struct Lu<T> {
    order: usize,
    /// Factors, row by row.
    matrix: Vec<T>,
    /// Row that each row was exchanged with, in turn.
    pivots: Vec<usize>,
    /// Cost of the last factorisation, in real multiplications within rows.
    cost: f64,
}

impl<T: ComplexField<RealField = f64> + Copy> Lu<T> {
    /// Creates room for the factors of a matrix of this order.
    pub fn new(order: usize) -> Self {
        Self {
            order,
            matrix: vec![T::zero(); order * order],
            pivots: vec![0; order],
            cost: 0.0,
        }
    }

    /// Returns the cost of the last factorisation, in real multiplications within rows.
    pub fn cost(&self) -> f64 {
        self.cost
    }

    /// Returns the cost of a solution in the same unit.
    pub fn cost_of_solution(&self) -> f64 {
        SOLUTION * parts::<T>() * (self.order * self.order) as f64
    }

    /// Factorises `shift` 1 - `scale` J, where J is a real matrix, row by row, by Gaussian
    /// elimination. Returns false if it is singular or not finite.
    pub fn factorise(&mut self, shift: T, scale: f64, jacobian: &[f64]) -> bool {
        let (n, matrix) = (self.order, &mut self.matrix);
        let mut products = 0;
        for (k, (entry, slope)) in matrix.iter_mut().zip(jacobian).enumerate() {
            let unit = if k % (n + 1) == 0 { shift } else { T::zero() };
            *entry = unit - T::from_real(scale * slope);
        }
        for k in 0..n {
            let size = |i: usize, matrix: &[T]| matrix[i * n + k].norm1();
            let pivot = (k..n)
                .max_by(|&i, &j| size(i, matrix).total_cmp(&size(j, matrix)))
                .unwrap_or(k);
            if !(size(pivot, matrix) > 0.0 && size(pivot, matrix).is_finite()) {
                return false;
            }
            self.pivots[k] = pivot;
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
        let parts = parts::<T>();
        self.cost = parts * (SEARCH * (n * n) as f64 + parts * products as f64);
        true
    }

    /// Replaces a right-hand side by its solution.
    pub fn solve(&self, b: &mut [T]) {
        let (n, matrix) = (self.order, &self.matrix);
        for (k, pivot) in self.pivots.iter().enumerate() {
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
        assert!(lu.factorise(shift, 2.0, &jacobian));
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
        assert!(real.factorise(0.0, 1.0, &jacobian));
        assert!(!real.factorise(0.0, 1.0, &[1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 1.0, 1.0]));
        assert!(!real.factorise(0.0, 1.0, &[f64::NAN; 9]));
    }
}
