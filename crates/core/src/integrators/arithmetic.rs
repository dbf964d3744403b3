//! Arithmetic on arrays.

/// Computes y += h k.
pub(crate) fn add_scaled(y: &mut [f64], h: f64, k: &[f64]) {
    for (y, k) in y.iter_mut().zip(k) {
        *y += h * k;
    }
}

/// Computes out = y + h k.
pub(super) fn scaled_sum(out: &mut [f64], y: &[f64], h: f64, k: &[f64]) {
    for ((out, y), k) in out.iter_mut().zip(y).zip(k) {
        *out = y + h * k;
    }
}
