//! Eigenvalues of a matrix by the QR algorithm, in a limited number of iterations.

use nalgebra::{Complex, DMatrix, DVector, Schur};

use crate::random::SplitMix;

/// Most iterations of the QR algorithm for an eigenvalue; two or three are usual.
pub(super) const ITERATIONS: usize = 20;
/// Precisions to which that decides what is zero: rounding alone, and, where that is never reached,
/// what central differences leave of it.
pub(super) const PRECISIONS: [f64; 2] = [f64::EPSILON, 1e-8];

/// Eigenvalues of a matrix; none where the QR algorithm does not find them in a limited number of
/// iterations.
///
/// A rotation of the axes into one another is a fixed point of the algorithm: what a random
/// reflection makes of the matrix is none, and has the same eigenvalues. Where many eigenvalues are
/// zero, rounding keeps entries from becoming small beside their neighbours: larger ones count as
/// zero then.
pub(super) fn eigenvalues(matrix: &DMatrix<f64>) -> Vec<Complex<f64>> {
    let n = matrix.nrows();
    let mut random = SplitMix(1);
    let u = DVector::from_fn(n, |_, _| random.between(-1.0, 1.0)).normalize();
    let reflection = DMatrix::identity(n, n) - 2.0 * &u * u.transpose();
    let reflected = || &reflection * matrix * &reflection;
    let schur = |matrix, precision| Schur::try_new(matrix, precision, ITERATIONS * n);
    schur(matrix.clone(), PRECISIONS[0])
        .or_else(|| schur(reflected(), PRECISIONS[1]))
        .map(|schur| schur.complex_eigenvalues().iter().copied().collect())
        .unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eigenvalues, sorted by their real and imaginary parts.
    fn sorted(matrix: &DMatrix<f64>) -> Vec<[f64; 2]> {
        let mut all: Vec<_> = eigenvalues(matrix).iter().map(|l| [l.re, l.im]).collect();
        all.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        all
    }

    /// Which takes each axis to the next one: steps of the QR algorithm leave it as it is.
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
