//! Numbers in which the law of a material is evaluated: one, or those of eight tetrahedra, with
//! their differentials or without. The law is written once for all of them.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::array::from_fn;
use std::ops::{Add, Div, Mul, Sub};

/// Number of tetrahedra that are evaluated at once.
pub(super) const LANES: usize = 8;

/// Number with the four operations.
pub(super) trait Number:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Constant.
    fn of(x: f64) -> Self;
}

impl Number for f64 {
    #[inline(always)]
    fn of(x: f64) -> Self {
        x
    }
}

/// Numbers of as many tetrahedra as are evaluated at once.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(64))]
pub(super) struct Lanes(pub [f64; LANES]);

impl Number for Lanes {
    #[inline(always)]
    fn of(x: f64) -> Self {
        Self([x; LANES])
    }
}

/// Number and its differential.
#[derive(Clone, Copy, Debug)]
pub(super) struct Dual<N> {
    pub value: N,
    pub change: N,
}

impl From<Lanes> for Dual<Lanes> {
    #[inline(always)]
    fn from(value: Lanes) -> Self {
        Self {
            value,
            change: Lanes::of(0.0),
        }
    }
}

impl<N: Number> Number for Dual<N> {
    #[inline(always)]
    fn of(x: f64) -> Self {
        Self {
            value: N::of(x),
            change: N::of(0.0),
        }
    }
}

macro_rules! operators {
    ($($name:ident::$operator:ident(|$a:ident, $b:ident, $result:ident| $change:expr);)*) => {
        $(impl $name for Lanes {
            type Output = Self;

            #[inline(always)]
            fn $operator(self, other: Self) -> Self {
                Self(from_fn(|k| self.0[k].$operator(other.0[k])))
            }
        }

        impl<N: Number> $name for Dual<N> {
            type Output = Self;

            #[inline(always)]
            fn $operator(self, other: Self) -> Self {
                let $result = self.value.$operator(other.value);
                let ($a, $b) = (self, other);
                Self { value: $result, change: $change }
            }
        })*
    };
}

operators! {
    Add::add(|a, b, _sum| a.change + b.change);
    Sub::sub(|a, b, _difference| a.change - b.change);
    Mul::mul(|a, b, _product| a.change * b.value + a.value * b.change);
    Div::div(|a, b, quotient| (a.change - quotient * b.change) / b.value);
}
