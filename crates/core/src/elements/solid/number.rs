//! Numbers for which the law of a material is evaluated: SIMD vectors, which hold the numbers of
//! several tetrahedra, and dual numbers, which are numbers with their differentials. The law is
//! written once for all of them.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::ops::{Add, Div, Mul, Sub};

use pulp::Simd;

use crate::fused::mul_adds;
use crate::lanes::Lanes;

/// Number with the four operations.
pub(super) trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Returns a constant.
    fn constant(self, x: f64) -> Self;

    /// Returns self + a b.
    fn plus_product(self, a: Self, b: Self) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn constant(self, x: f64) -> Self {
        x
    }

    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        self + a * b
    }
}

impl<S: Simd> Number for Lanes<S> {
    #[inline(always)]
    fn constant(self, x: f64) -> Self {
        self.with(self.simd.splat_f64s(x))
    }

    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        self.with(mul_adds(self.simd, a.value, b.value, self.value))
    }
}

/// Dual number: a number and its differential.
#[derive(Clone, Copy)]
pub(super) struct Dual<N> {
    pub value: N,
    pub change: N,
}

impl<N: Number> Number for Dual<N> {
    #[inline(always)]
    fn constant(self, x: f64) -> Self {
        Self {
            value: self.value.constant(x),
            change: self.value.constant(0.0),
        }
    }

    #[inline(always)]
    fn plus_product(self, a: Self, b: Self) -> Self {
        let change = self.change.plus_product(a.change, b.value);
        Self {
            value: self.value.plus_product(a.value, b.value),
            change: change.plus_product(a.value, b.change),
        }
    }
}

impl<N: Number> Add for Dual<N> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            change: self.change + other.change,
        }
    }
}

impl<N: Number> Sub for Dual<N> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self {
            value: self.value - other.value,
            change: self.change - other.change,
        }
    }
}

impl<N: Number> Mul for Dual<N> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            change: (self.change * other.value).plus_product(self.value, other.change),
        }
    }
}

impl<N: Number> Div for Dual<N> {
    type Output = Self;

    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self {
            value,
            change: (self.change - value * other.change) / other.value,
        }
    }
}
