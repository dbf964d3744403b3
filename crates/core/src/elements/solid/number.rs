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
        Self { value: self.value.constant(x), change: self.value.constant(0.0) }
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
        Self { value: self.value + other.value, change: self.change + other.change }
    }
}

impl<N: Number> Sub for Dual<N> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, change: self.change - other.change }
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
        Self { value, change: (self.change - value * other.change) / other.value }
    }
}

/// Array of the values of an expression for 0, 1 and 2. Unlike a closure, it is always inlined.
macro_rules! three {
    ($k:ident => $value:expr) => {
        [
            {
                let $k = 0;
                $value
            },
            {
                let $k = 1;
                $value
            },
            {
                let $k = 2;
                $value
            },
        ]
    };
}
pub(super) use three;

/// Matrix, row by row.
pub(super) type Matrix<N> = [[N; 3]; 3];

/// Returns a . b.
#[inline(always)]
pub(super) fn dot<N: Number>(a: [N; 3], b: [N; 3]) -> N {
    (a[0] * b[0]).plus_product(a[1], b[1]).plus_product(a[2], b[2])
}

#[inline(always)]
fn cross<N: Number>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Returns column k.
#[inline(always)]
pub(super) fn column<N: Number>(a: &Matrix<N>, k: usize) -> [N; 3] {
    [a[0][k], a[1][k], a[2][k]]
}

/// Returns a b.
#[inline(always)]
pub(super) fn product<N: Number>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    three!(i => three!(j => dot(a[i], column(b, j))))
}

/// Returns a : b.
#[inline(always)]
pub(super) fn contraction<N: Number>(a: &Matrix<N>, b: &Matrix<N>) -> N {
    dot(a[0], b[0]) + dot(a[1], b[1]) + dot(a[2], b[2])
}

/// Returns the symmetric part of aT b.
#[inline(always)]
pub(super) fn symmetric<N: Number>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    let (a, b) = (transposed(a), transposed(b));
    let half = a[0][0].constant(0.5);
    let xy = half * (dot(a[0], b[1]) + dot(a[1], b[0]));
    let xz = half * (dot(a[0], b[2]) + dot(a[2], b[0]));
    let yz = half * (dot(a[1], b[2]) + dot(a[2], b[1]));
    [[dot(a[0], b[0]), xy, xz], [xy, dot(a[1], b[1]), yz], [xz, yz, dot(a[2], b[2])]]
}

#[inline(always)]
fn transposed<N: Number>(a: &Matrix<N>) -> Matrix<N> {
    three!(i => three!(j => a[j][i]))
}

/// Returns the matrix of cofactors, which is the derivative of the determinant.
#[inline(always)]
pub(super) fn cofactors<N: Number>(a: &Matrix<N>) -> Matrix<N> {
    [cross(a[1], a[2]), cross(a[2], a[0]), cross(a[0], a[1])]
}

/// Returns a + b.
#[inline(always)]
pub(super) fn sum<N: Number>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    three!(i => three!(j => a[i][j] + b[i][j]))
}

/// Returns a + s b.
#[inline(always)]
pub(super) fn plus<N: Number>(a: &Matrix<N>, s: N, b: &Matrix<N>) -> Matrix<N> {
    three!(i => three!(j => a[i][j].plus_product(s, b[i][j])))
}

/// Returns s a.
#[inline(always)]
pub(super) fn scaled<N: Number>(s: N, a: &Matrix<N>) -> Matrix<N> {
    three!(i => three!(j => s * a[i][j]))
}
