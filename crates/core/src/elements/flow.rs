//! The exact flow of x' = v, v' = g - (c/m) v: gravity and drag.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use crate::fused::mul_adds;
use crate::vectors::Arch;
use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

/// The flow over a time h, as a linear map. With a = c h / m, phi = (1 - e^-a) / a and psi = (1 -
/// phi) / a it is v -> v + h phi (g - (c/m) v) and x -> x + h phi v + h2 psi g. The coefficients
/// are those of x += `v_to_x` v + `to_x` and v += `v_to_v` v + `to_v`.
#[derive(Clone, Copy)]
pub(crate) struct Flow {
    v_to_x: f64,
    to_x: Vector3<f64>,
    v_to_v: f64,
    to_v: Vector3<f64>,
}

impl Flow {
    /// Creates the flow over a time h (s) of particles under drag c (kg/s) and gravity g (m/s2),
    /// whose inverse mass is `w` (1/kg).
    pub fn new(c: f64, g: Vector3<f64>, w: f64, h: f64) -> Self {
        let (phi, psi) = phi_psi(c * w * h);
        Self { v_to_x: h * phi, to_x: h * h * psi * g, v_to_v: -h * phi * c * w, to_v: h * phi * g }
    }

    /// Returns the positions and velocities along one axis after the flow.
    #[inline(always)]
    pub fn of<S: Simd>(self, simd: S, axis: usize, x: S::f64s, v: S::f64s) -> (S::f64s, S::f64s) {
        let add = |a, from, k, more| {
            simd.add_f64s(a, mul_adds(simd, simd.splat_f64s(k), from, simd.splat_f64s(more)))
        };
        (add(x, v, self.v_to_x, self.to_x[axis]), add(v, v, self.v_to_v, self.to_v[axis]))
    }

    /// Moves particles by the flow.
    pub fn apply(self, x: [&mut [f64]; 3], v: [&mut [f64]; 3]) {
        Arch::new().dispatch(Apply { flow: self, x, v });
    }
}

/// Moves particles of different masses by the flow.
pub(crate) fn flow_each(
    c: f64,
    g: Vector3<f64>,
    inverse_masses: &[f64],
    h: f64,
    mut x: [&mut [f64]; 3],
    mut v: [&mut [f64]; 3],
) {
    // Equal masses come in runs: the exponential is computed once for each run.
    let mut start = 0;
    for run in inverse_masses.chunk_by(|a, b| a == b) {
        let part = start..start + run.len();
        Flow::new(c, g, run[0], h).apply(
            x.each_mut().map(|x| &mut x[part.clone()]),
            v.each_mut().map(|v| &mut v[part.clone()]),
        );
        start += run.len();
    }
}

struct Apply<'a> {
    flow: Flow,
    x: [&'a mut [f64]; 3],
    v: [&'a mut [f64]; 3],
}

impl WithSimd for Apply<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let one = pulp::Scalar::new();
        for (axis, (x, v)) in self.x.into_iter().zip(self.v).enumerate() {
            let (x, x_rest) = S::as_mut_simd_f64s(x);
            let (v, v_rest) = S::as_mut_simd_f64s(v);
            for (x, v) in x.iter_mut().zip(v) {
                (*x, *v) = self.flow.of(simd, axis, *x, *v);
            }
            for (x, v) in x_rest.iter_mut().zip(v_rest) {
                (*x, *v) = self.flow.of(one, axis, *x, *v);
            }
        }
    }
}

/// Returns phi = (1 - e^-a) / a and psi = (1 - phi) / a, by their series where the differences
/// would cancel.
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
        let g = Vector3::new(-9.8, 0.0, 1.0);
        let flow = |times: u32| {
            let (mut x, mut v) = ([[0.3]; 3], [[2.0]; 3]);
            for _ in 0..times {
                let h = 0.7 / f64::from(times);
                let (x, v) = (x.each_mut(), v.each_mut());
                flow_each(0.5, g, &[2.0], h, x.map(|x| &mut x[..]), v.map(|v| &mut v[..]));
            }
            (x[0], v[0])
        };
        let ((x, v), (x2, v2)) = (flow(1), flow(7));
        assert_relative_eq!(x[0], x2[0], max_relative = 1e-14);
        assert_relative_eq!(v[0], v2[0], max_relative = 1e-14);
        // v' = g - v: v = g + (v0 - g) e^-t
        assert_relative_eq!(v[0], -9.8 + 11.8 * (-0.7f64).exp(), max_relative = 1e-14);
    }
}
