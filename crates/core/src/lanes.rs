//! Numbers in the lanes of a SIMD vector. Each lane is computed alike, so that the bits are the
//! same for any length of the vector.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::ops::{Add, Div, Mul, Sub};

use pulp::Simd;

/// Numbers in a SIMD vector.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<S: Simd> {
    pub simd: S,
    pub value: S::f64s,
}

impl<S: Simd> Lanes<S> {
    /// Reads SIMD vector number `part` of these numbers.
    #[inline(always)]
    pub fn load<const N: usize>(simd: S, numbers: &[f64; N], part: usize) -> Self {
        let value = S::as_simd_f64s(numbers).0[part];
        Self { simd, value }
    }

    /// Writes SIMD vector number `part` of these numbers.
    #[inline(always)]
    pub fn store<const N: usize>(self, numbers: &mut [f64; N], part: usize) {
        S::as_mut_simd_f64s(numbers).0[part] = self.value;
    }

    /// Puts the same number in each lane.
    #[inline(always)]
    pub fn splat(simd: S, x: f64) -> Self {
        let value = simd.splat_f64s(x);
        Self { simd, value }
    }

    #[inline(always)]
    pub fn with(self, value: S::f64s) -> Self {
        Self { value, ..self }
    }

    /// Returns the lanes in which self <= other.
    #[inline(always)]
    pub fn at_most(self, other: Self) -> S::m64s {
        self.simd.less_than_or_equal_f64s(self.value, other.value)
    }

    /// Returns self in the lanes of a mask, and `other` elsewhere.
    #[inline(always)]
    pub fn where_or(self, mask: S::m64s, other: Self) -> Self {
        self.with(self.simd.select_f64s(mask, self.value, other.value))
    }

    /// Returns the smaller number in each lane; none may be NaN.
    #[inline(always)]
    pub fn least(self, other: Self) -> Self {
        self.with(self.simd.min_f64s(self.value, other.value))
    }

    /// Returns the larger number in each lane; none may be NaN.
    #[inline(always)]
    pub fn most(self, other: Self) -> Self {
        self.with(self.simd.max_f64s(self.value, other.value))
    }

    #[inline(always)]
    pub fn root(self) -> Self {
        self.with(self.simd.sqrt_f64s(self.value))
    }
}

impl<S: Simd> Add for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(self.simd.add_f64s(self.value, other.value))
    }
}

impl<S: Simd> Sub for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(self.simd.sub_f64s(self.value, other.value))
    }
}

impl<S: Simd> Mul for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(self.simd.mul_f64s(self.value, other.value))
    }
}

impl<S: Simd> Div for Lanes<S> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        self.with(self.simd.div_f64s(self.value, other.value))
    }
}
