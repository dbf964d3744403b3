//! The sine of many numbers at a time, with the same bits on every processor: plain code that the
//! compiler turns into vectors. With n pi the multiple of pi that is nearest to a, and
//! r = a - n pi, sin a = (-1)^n sin r. Products with the two parts of pi are fused, and sin r, with
//! r at most pi / 2, is its Taylor series up to r^21; the next term is below 2e-18. The results
//! differ from those of `libm` in the last digit or two at most.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::f64::consts::{FRAC_1_PI, PI};

use crate::fused::mul_add;

/// Largest argument (rad) for which two parts of pi are enough; beyond it, `libm` is called.
const MAX_ARGUMENT: f64 = 1e6;

/// pi less the double that is nearest to it.
const REST_OF_PI: f64 = 1.224_646_799_147_353_2e-16;

/// Number whose last bit has the value 1, so that a sum with it is rounded to a whole number.
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// Coefficients of the series divided by r^3, from the last one on: 1 / 21!, - 1 / 19! and so on.
const SERIES: [f64; 10] = [
    1.0 / 51_090_942_171_709_440_000.0,
    -1.0 / 121_645_100_408_832_000.0,
    1.0 / 355_687_428_096_000.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 39_916_800.0,
    1.0 / 362_880.0,
    -1.0 / 5040.0,
    1.0 / 120.0,
    -1.0 / 6.0,
];

/// Returns the sine of a (rad).
pub(crate) fn sine(a: f64) -> f64 {
    let mut one = [a];
    sines(&mut one);
    one[0]
}

/// Replaces numbers (rad) by their sines.
#[inline(always)]
pub(crate) fn sines(all: &mut [f64]) {
    let is_far = all.iter().fold(false, |far, a| far | (a.abs() > MAX_ARGUMENT));
    if is_far {
        for a in all {
            *a = if a.abs() > MAX_ARGUMENT { libm::sin(*a) } else { of_near(*a) };
        }
    } else {
        for a in all {
            *a = of_near(*a);
        }
    }
}

/// Returns the sine of a number of at most [`MAX_ARGUMENT`].
#[inline(always)]
fn of_near(a: f64) -> f64 {
    let whole = mul_add(a, FRAC_1_PI, WHOLE);
    let n = whole - WHOLE;
    let r = mul_add(-n, REST_OF_PI, mul_add(-n, PI, a));
    let square = r * r;
    let mut sum = SERIES[0];
    for c in &SERIES[1..] {
        sum = mul_add(sum, square, *c);
    }
    let of_r = mul_add(r * square, sum, r);
    // An odd n, whose last bit is 1, changes the sign.
    f64::from_bits(of_r.to_bits() ^ (whole.to_bits() << 63))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix;

    #[test]
    fn sines_are_right_to_the_last_digits() {
        let mut random = SplitMix(7);
        for most in [1e-9, 1.0, 100.0, MAX_ARGUMENT, 1e12] {
            for _ in 0..10_000 {
                let a = random.between(-most, most);
                let apart = (sine(a) - libm::sin(a)).abs();
                assert!(apart <= 2.3e-16 * a.abs().min(1.0), "{a}: {apart:e}");
            }
        }
        assert!(sine(f64::INFINITY).is_nan() && sine(f64::NAN).is_nan());
        // A large argument changes no bit of the others.
        let mut all = [0.5, 1e7, -2.0];
        sines(&mut all);
        assert_eq!(all, [0.5, 1e7, -2.0].map(sine));
    }
}
