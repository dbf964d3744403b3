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

/// One axis of the free fall: x += h v + h2 g / 2, v += h g.
pub(crate) fn drift(g: f64, h: f64, x: &mut [f64], v: &mut [f64]) {
    for (x, v) in x.iter_mut().zip(v) {
        *x += h * (*v + 0.5 * h * g);
        *v += h * g;
    }
}
