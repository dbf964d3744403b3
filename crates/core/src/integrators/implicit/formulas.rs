//! The numerical differentiation formulas: their coefficients, errors, and stable regions.

use nalgebra::Complex;

use super::differences::MAX_ORDER;

/// Largest number of iterations for roots, and change at which they end.
const MAX_ITERATIONS: usize = 100;
const ROOT_TOLERANCE: f64 = 1e-13;

/// Coefficient kappa of each order: it reduces the error, at about the same stability.
pub(super) const KAPPA: [f64; MAX_ORDER + 1] = [0.0, -0.185, -1.0 / 9.0, -0.0823, -0.0415, 0.0];

/// Returns the sum g of the reciprocals of the numbers up to an order.
pub(super) fn harmonic(order: usize) -> f64 {
    (1..=order).map(|j| 1.0 / j as f64).sum()
}

/// Returns the factor of `D_(k+1)` in the error of a step of order k.
pub(super) fn error_factor(order: usize) -> f64 {
    KAPPA[order] * harmonic(order) + 1.0 / (order + 1) as f64
}

/// Returns the growth per step of a solution of y' = l y with z = h l = re + i im, in equal steps
/// of the order with the largest growth.
///
/// A solution `y_n = r^n` has backward differences `w^j y_n` with w = 1 - 1/r, so w is a root of
/// `sum(w^j / j, j = 1..k) - kappa_k g_k w^(k+1) = z`.
#[must_use]
pub fn bdf_growth(re: f64, im: f64) -> f64 {
    let of_order = |order: usize| {
        let mut polynomial = vec![Complex::new(-re, -im)];
        polynomial.extend((1..=order).map(|j| Complex::from(1.0 / j as f64)));
        polynomial.push(Complex::from(-KAPPA[order] * harmonic(order)));
        let rates = roots(&polynomial).into_iter();
        rates.map(|w| 1.0 / (1.0 - w).norm()).fold(0.0, f64::max)
    };
    (1..=MAX_ORDER).map(of_order).fold(0.0, f64::max)
}

/// Finds the roots of a polynomial, given by its coefficients from the constant on: all of them at
/// the same time (Durand and Kerner).
fn roots(coefficients: &[Complex<f64>]) -> Vec<Complex<f64>> {
    let zero = |c: &Complex<f64>| c.norm() > 0.0;
    let degree = coefficients.iter().rposition(zero).unwrap_or(0);
    let leading = coefficients[degree];
    let value = |x: Complex<f64>| {
        let terms = coefficients[..degree].iter().rev();
        terms.fold(Complex::from(1.0), |sum, c| sum * x + c / leading)
    };
    // Start values that are neither real nor roots of unity.
    let mut roots: Vec<_> = (0..degree)
        .map(|k| Complex::new(0.4, 0.9).powu(k as u32))
        .collect();
    for _ in 0..MAX_ITERATIONS {
        let mut largest: f64 = 0.0;
        for k in 0..degree {
            let others = (0..degree).filter(|j| *j != k).map(|j| roots[k] - roots[j]);
            let change = value(roots[k]) / others.product::<Complex<f64>>();
            roots[k] -= change;
            largest = largest.max(change.norm());
        }
        if largest < ROOT_TOLERANCE {
            break;
        }
    }
    roots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_those_of_which_it_is_the_product() {
        let given =
            [(1.0, 2.0), (-3.0, 0.5), (0.25, 0.0), (0.0, -1.0)].map(|(a, b)| Complex::new(a, b));
        let mut product = vec![Complex::from(2.0)];
        for root in given {
            product.insert(0, Complex::from(0.0));
            for k in 0..product.len() - 1 {
                let next = product[k + 1];
                product[k] -= root * next;
            }
        }
        product.push(Complex::from(0.0));
        let found = roots(&product);
        assert_eq!(found.len(), given.len());
        for root in given {
            let nearest = found.iter().map(|other| (other - root).norm());
            assert!(
                nearest.fold(f64::INFINITY, f64::min) < 1e-10,
                "{root} {found:?}"
            );
        }
    }

    /// Order 5 is stable within 51 degrees of the negative real axis (Shampine, Reichelt, table 2).
    #[test]
    fn what_decays_within_the_known_angle_is_stable() {
        let grows = |degrees: f64| {
            let turned = std::f64::consts::PI - degrees.to_radians();
            let growth = |k: i32| {
                let z = Complex::from_polar(f64::powi(1.2, k), turned);
                bdf_growth(z.re, z.im)
            };
            (-20..20).any(|k| growth(k) > 1.0 + 1e-9)
        };
        assert!(!grows(0.0) && !grows(51.0) && grows(53.0));
    }
}
