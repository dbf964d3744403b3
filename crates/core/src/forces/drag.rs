//! Viscous drag, F = -c v.

pub(crate) fn add(c: f64, v: &[f64], f: &mut [f64]) {
    for (f, v) in f.iter_mut().zip(v) {
        *f -= c * v;
    }
}

/// One axis of the exact flow of x' = v, v' = g - (c/m) v:
/// with a = c h / m, v -> v + h phi (g - (c/m) v), x -> x + h phi v + h2 psi g,
/// phi = (1 - e^-a) / a, psi = (1 - phi) / a.
pub(crate) fn drift(c: f64, g: f64, h: f64, inverse_masses: &[f64], x: &mut [f64], v: &mut [f64]) {
    // Particles of one mass come in runs: the exponential is taken once a run.
    let (mut of, mut phi, mut psi) = (f64::NAN, 0.0, 0.0);
    for ((x, v), &w) in x.iter_mut().zip(v).zip(inverse_masses) {
        if w != of {
            (phi, psi) = phi_psi(c * w * h);
            of = w;
        }
        *x += h * (phi * *v + psi * h * g);
        *v += h * phi * (g - c * w * *v);
    }
}

/// (1 - e^-a) / a and (1 - that) / a, by their series where the quotients would cancel.
fn phi_psi(a: f64) -> (f64, f64) {
    if a.abs() < 1e-2 {
        let phi =
            1.0 - a / 2.0 * (1.0 - a / 3.0 * (1.0 - a / 4.0 * (1.0 - a / 5.0 * (1.0 - a / 6.0))));
        let psi = 0.5 * (1.0 - a / 3.0 * (1.0 - a / 4.0 * (1.0 - a / 5.0 * (1.0 - a / 6.0))));
        (phi, psi)
    } else {
        let phi = -libm::expm1(-a) / a;
        (phi, (1.0 - phi) / a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn series_and_quotients_agree_where_they_meet() {
        let (below, above) = (phi_psi(0.01 - 1e-12), phi_psi(0.01 + 1e-12));
        assert_relative_eq!(below.0, above.0, max_relative = 1e-11);
        assert_relative_eq!(below.1, above.1, max_relative = 1e-11);
    }

    #[test]
    fn the_drift_is_a_flow() {
        let (mut x, mut v) = ([0.3], [2.0]);
        drift(0.5, -9.8, 0.7, &[2.0], &mut x, &mut v);
        let (mut x2, mut v2) = ([0.3], [2.0]);
        for _ in 0..7 {
            drift(0.5, -9.8, 0.1, &[2.0], &mut x2, &mut v2);
        }
        assert_relative_eq!(x[0], x2[0], max_relative = 1e-14);
        assert_relative_eq!(v[0], v2[0], max_relative = 1e-14);
        // v' = g - v: v = g + (v0 - g) e^-t
        assert_relative_eq!(v[0], -9.8 + 11.8 * (-0.7f64).exp(), max_relative = 1e-14);
    }
}
