//! 1 / sqrt(a), which takes most of the time of springs.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use crate::fused::negate_mul_adds;
use pulp::Simd;

/// Returns 1 / sqrt(a) to the last digit or two: halving the exponent gives a guess, which four
/// steps of Newton's method improve. Finite at 0. Takes half the time of the processor's square
/// root and division, which do not overlap.
#[inline(always)]
pub(super) fn inverse_root<S: Simd>(simd: S, a: S::f64s) -> S::f64s {
    let mut y = [a];
    for bits in pulp::bytemuck::cast_slice_mut::<S::f64s, u64>(&mut y) {
        *bits = 0x5fe6_eb50_c7b5_37a9_u64.wrapping_sub(*bits >> 1);
    }
    let [mut y] = y;
    let half = simd.mul_f64s(a, simd.splat_f64s(0.5));
    let once_and_half = simd.splat_f64s(1.5);
    for _ in 0..4 {
        // In this order nothing overflows at 0.
        let part = simd.mul_f64s(half, y);
        y = simd.mul_f64s(y, negate_mul_adds(simd, part, y, once_and_half));
    }
    y
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix;

    #[test]
    fn inverse_roots_are_right_to_the_last_digits() {
        let mut random = SplitMix(7);
        for _ in 0..10_000 {
            let a = 10f64.powf(random.between(-300.0, 300.0));
            let error = inverse_root(pulp::Scalar::new(), a) * a.sqrt() - 1.0;
            assert!(error.abs() < 5e-16, "{a}: {error:e}");
        }
        assert!(inverse_root(pulp::Scalar::new(), 0.0).is_finite());
    }
}
