//! Newton's method: numbers of iterations, and products of vectors.

/// Largest number of iterations of Newton's method.
pub(super) const MAX_ITERATIONS: u32 = 30;

/// Number of iterations of Newton's method.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Newton {
    /// One iteration, with compressed springs clamped.
    Once,
    /// Iterations until the state no longer changes.
    Full,
    /// The same for the middle of a step, at whose end constraints are met.
    Mirrored,
}

/// Returns the Euclidean norm.
pub(super) fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

/// Returns the scalar product.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
