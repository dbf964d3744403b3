//! Fused multiply-add, a b + c rounded once, for numbers and for SIMD vectors. WebAssembly has the
//! instruction only with relaxed SIMD, which every processor of today fuses. Without it, a page
//! rounds twice, because the exact function would make a step ten times as long.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined is not compiled for the processor's vectors"
)]

use pulp::Simd;

/// Returns a b + c.
#[inline(always)]
pub(crate) fn mul_add(a: f64, b: f64, c: f64) -> f64 {
    #[cfg(all(target_arch = "wasm32", target_feature = "relaxed-simd"))]
    {
        use core::arch::wasm32::{f64x2_extract_lane, f64x2_relaxed_madd, f64x2_splat};
        let sum = f64x2_relaxed_madd(f64x2_splat(a), f64x2_splat(b), f64x2_splat(c));
        f64x2_extract_lane::<0>(sum)
    }
    #[cfg(all(target_arch = "wasm32", not(target_feature = "relaxed-simd")))]
    {
        a * b + c
    }
    #[cfg(not(target_arch = "wasm32"))]
    {
        a.mul_add(b, c)
    }
}

/// Returns a b + c in each lane.
#[inline(always)]
pub(crate) fn mul_adds<S: Simd>(simd: S, a: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s {
    if !cfg!(target_arch = "wasm32") {
        simd.mul_add_f64s(a, b, c)
    } else if S::F64_LANES == 1 {
        // The last numbers of a row are rounded like the others.
        let [a, b, c] = [a, b, c].map(|lane| simd.reduce_sum_f64s(lane));
        simd.splat_f64s(mul_add(a, b, c))
    } else {
        simd.mul_add_e_f64s(a, b, c)
    }
}

/// Returns c - a b in each lane.
#[inline(always)]
pub(crate) fn negate_mul_adds<S: Simd>(simd: S, a: S::f64s, b: S::f64s, c: S::f64s) -> S::f64s {
    if cfg!(target_arch = "wasm32") {
        mul_adds(simd, simd.neg_f64s(a), b, c)
    } else {
        simd.negate_mul_add_f64s(a, b, c)
    }
}
