//! Viscous drag, F = -c v.

pub(crate) fn add(c: f64, v: &[f64], f: &mut [f64]) {
    for (f, v) in f.iter_mut().zip(v) {
        *f -= c * v;
    }
}
