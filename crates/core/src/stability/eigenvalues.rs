//! Eigenvalues of a matrix by the QR algorithm, in a limited number of iterations, and eigenvectors
//! by inverse iteration.

use nalgebra::{Complex, DMatrix, DVector, Schur};

use crate::random::SplitMix;

/// Largest number of iterations of the QR algorithm per eigenvalue; two or three are usual.
pub(super) const MAX_ITERATIONS: usize = 20;
/// Relative precisions at which the algorithm takes an entry for zero: that of rounding, and, if
/// that fails, the error of central differences.
pub(super) const PRECISIONS: [f64; 2] = [f64::EPSILON, 1e-8];

/// Returns the eigenvalues of a matrix; none if the QR algorithm does not find them in a limited
/// number of iterations.
///
/// A permutation of the axes is a fixed point of the algorithm. Conjugation by a random reflection
/// makes it none, and keeps the eigenvalues. If many eigenvalues are zero, rounding keeps entries
/// from becoming small compared with their neighbours: then larger ones count as zero.
pub(super) fn eigenvalues(matrix: &DMatrix<f64>) -> Vec<Complex<f64>> {
    let n = matrix.nrows();
    let mut random = SplitMix(1);
    let u = DVector::from_fn(n, |_, _| random.between(-1.0, 1.0)).normalize();
    let reflection = DMatrix::identity(n, n) - 2.0 * &u * u.transpose();
    let reflected = || &reflection * matrix * &reflection;
    let schur = |matrix, precision| Schur::try_new(matrix, precision, MAX_ITERATIONS * n);
    schur(matrix.clone(), PRECISIONS[0])
        .or_else(|| schur(reflected(), PRECISIONS[1]))
        .map(|schur| schur.complex_eigenvalues().iter().copied().collect())
        .unwrap_or_default()
}

/// Returns the vector of length 1 that a nearly singular matrix nearly takes to zero, by inverse
/// iteration; `None` if the matrix is exactly singular.
pub(super) fn kernel(matrix: DMatrix<Complex<f64>>) -> Option<DVector<Complex<f64>>> {
    let mut random = SplitMix(3);
    let any = |_, _| Complex::new(random.between(-1.0, 1.0), 0.0);
    let mut vector = DVector::from_fn(matrix.nrows(), any);
    let factors = matrix.lu();
    for _ in 0..3 {
        vector = factors.solve(&vector)?.normalize();
    }
    Some(vector)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the eigenvalues, sorted by their real and imaginary parts.
    fn sorted(matrix: &DMatrix<f64>) -> Vec<[f64; 2]> {
        let mut all: Vec<_> = eigenvalues(matrix).iter().map(|l| [l.re, l.im]).collect();
        all.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        all
    }

    /// The matrix takes each axis to the next one: steps of the QR algorithm leave it unchanged.
    #[test]
    fn a_rotation_of_axes_has_the_roots_of_one() {
        let n = 5;
        let matrix = DMatrix::from_fn(n, n, |i, j| f64::from(u8::from(i == (j + 1) % n)));
        let all = sorted(&matrix);
        assert_eq!(all.len(), n);
        for [re, im] in all {
            let power = Complex::new(re, im).powu(n as u32);
            assert!((power - 1.0).norm() < 1e-10, "{re} {im}");
        }
    }

    #[test]
    fn what_is_not_finite_has_no_eigenvalues() {
        assert!(sorted(&DMatrix::from_element(4, 4, f64::NAN)).is_empty());
    }
}
