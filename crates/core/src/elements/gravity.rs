//! F = m g.

use nalgebra::Vector3;

/// Along one axis.
pub(crate) fn add(g: f64, masses: &[f64], f: &mut [f64]) {
    if g != 0.0 {
        for (f, m) in f.iter_mut().zip(masses) {
            *f += m * g;
        }
    }
}

/// -m g . x (J)
pub(crate) fn energy(g: Vector3<f64>, masses: &[f64], x: &[f64]) -> f64 {
    x.chunks_exact(masses.len())
        .zip(&g)
        .map(|(x, g)| -g * x.iter().zip(masses).map(|(x, m)| m * x).sum::<f64>())
        .sum()
}
