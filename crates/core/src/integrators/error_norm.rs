//! Tolerances, and the norm in which the error of a step is measured against them.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::ops::Range;

use crate::error::{Error, positive};
use crate::measure::Measure;
use crate::sums::{OnBlock, add_up, dot, total};
use crate::system::ParticleSystem;
use crate::threads::{Columns, threads};

/// Error that a step is allowed to make.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// Relative to the motion, without unit.
    pub relative: f64,
    /// Of positions (m).
    pub absolute: f64,
}

impl Tolerance {
    /// Creates the tolerance of a system about 1 m in size: the same number relatively, and in
    /// metres.
    ///
    /// # Errors
    /// It is not a finite number above 0.
    pub fn new(relative: f64) -> Result<Self, Error> {
        Self::with_absolute(relative, relative)
    }

    /// Creates a tolerance from a relative one (without unit) and an absolute one (m).
    ///
    /// # Errors
    /// One of them is not a finite number above 0.
    pub fn with_absolute(relative: f64, absolute: f64) -> Result<Self, Error> {
        positive("the tolerance", relative)?;
        positive("the absolute tolerance", absolute)?;
        Ok(Self { relative, absolute })
    }
}

/// Share of the absolute tolerance that is allowed for a quantity that vanishes.
const FLOOR_SHARE: f64 = 1e-3;

/// Numbers whose squares are summed together: few enough that all data they are computed from stay
/// in the cache.
pub(super) const BLOCK: usize = 2048;

/// Norm of the error of a step: the root mean square of the error of each quantity in the state,
/// over the allowed one; of these, the largest.
///
/// Plain numbers have sizes of their own. Each may be wrong by the relative tolerance times the
/// largest size that it has had, and besides by the absolute tolerance or, where the system says
/// its least [size](ParticleSystem::scales), at least by that times the relative tolerance.
///
/// Positions may be wrong by the absolute tolerance, wherever the origin is. Any other quantity may
/// be wrong by the relative tolerance times its own root mean square: velocities, the rotations of
/// bodies as lengths at their radius, and their angular momenta as speeds there. The norm depends
/// neither on units nor on masses. If such a quantity vanishes, an error is allowed that moves
/// nothing by more than a thousandth of the absolute tolerance within the step.
pub(super) struct ErrorNorm<'a> {
    pub system: &'a dyn ParticleSystem,
    pub tolerance: Tolerance,
    /// The largest size of each number so far; empty if no number is plain.
    pub sizes: &'a [f64],
    /// Length of the step (s).
    pub h: f64,
}

/// Sums of squares over the numbers that belong to one quantity.
#[derive(Clone, Copy, Default)]
struct SquareSums {
    count: f64,
    y0: f64,
    y1: f64,
    errors: [f64; 2],
}

/// Number of quantities.
const QUANTITIES: usize = 6;
/// Place of plain numbers among the quantities, whose errors are over the allowed ones already.
const PLAIN: usize = 5;

/// Allowed error of a quantity in a step of h: `fixed + rate / h`.
struct Tolerated {
    fixed: f64,
    rate: f64,
}

impl ErrorNorm<'_> {
    /// Returns the largest ratio of a quantity's error to the allowed one.
    pub fn of(&self, y0: &[f64], y1: &[f64], error: &[f64]) -> f64 {
        let [error, _] = self.of_sums(squares([y0, y1, error]));
        error
    }

    /// Returns the largest ratio for each of two errors, from the sums of squares over a range of
    /// numbers: of y0, of y1 and of both errors, each over its allowed one if these are given.
    pub fn of_sums(
        &self,
        sums: impl FnMut(Range<usize>, Option<&Allowed>) -> [f64; 4],
    ) -> [f64; 2] {
        let mut largest = [0.0; 2];
        for (errors, Tolerated { fixed, rate }) in self.quantities(sums, false) {
            for (largest, error) in largest.iter_mut().zip(errors) {
                let ratio = error / (fixed + rate / self.h);
                // NaN is returned as such.
                if ratio > *largest || ratio.is_nan() {
                    *largest = ratio;
                }
            }
        }
        largest
    }

    /// Returns the time (s) in which a quantity changes by its own size, at the state y with this
    /// derivative of y of order 1 or 2; infinite if nothing changes. It does not depend on h.
    pub fn time_scale(&self, y: &[f64], derivative: &[f64], order: i32) -> f64 {
        let root = |a: f64, order: i32| libm::pow(a, 1.0 / f64::from(order));
        // A plain number that vanishes has no size yet in which a change could be seen.
        let all = self.quantities(squares([y, y, derivative]), true);
        let times = all.map(|([change, _], tolerated)| {
            if change == 0.0 {
                return f64::INFINITY;
            }
            let [fixed, rate] = [tolerated.fixed, tolerated.rate]
                .map(|tolerated| tolerated / (self.tolerance.relative * change));
            root(fixed, order).max(root(rate, order + 1))
        });
        times.fold(f64::INFINITY, |least, time| {
            // NaN is returned as such.
            if time < least || time.is_nan() { time } else { least }
        })
    }

    /// Returns the errors of the quantities in the state, and the allowed ones. Plain numbers
    /// without a size are left out on request.
    fn quantities(
        &self,
        mut sums: impl FnMut(Range<usize>, Option<&Allowed>) -> [f64; 4],
        leaves_out: bool,
    ) -> impl Iterator<Item = ([f64; 2], Tolerated)> {
        let mut all = [SquareSums::default(); QUANTITIES];
        let plain = Allowed {
            tolerance: self.tolerance,
            sizes: self.sizes,
            scales: self.system.scales(),
            leaves_out,
        };
        self.system.measures(&mut |numbers, measure| {
            let length = numbers.len() as f64;
            let allowed = Some(&plain).filter(|_| measure == Measure::Plain);
            let [mut y0, mut y1, errors @ ..] = sums(numbers, allowed);
            let (quantity, count, factor) = match measure {
                Measure::Plain => (PLAIN, length, 1.0),
                Measure::Alike => (0, length, 1.0),
                Measure::Position => (1, length / 3.0, 1.0),
                Measure::Velocity => (2, length / 3.0, 1.0),
                Measure::Rotation { radius } => {
                    // A turn changes a unit quaternion by half its angle.
                    let factor = 4.0 * radius * radius / y0;
                    (y0, y1) = (0.25 * y0, 0.25 * y0);
                    (3, 1.0, factor)
                }
                Measure::Momentum { speed } => (4, 1.0, speed * speed),
            };
            let all = &mut all[quantity];
            all.count += count;
            all.y0 += factor * y0;
            all.y1 += factor * y1;
            for (sum, error) in all.errors.iter_mut().zip(errors) {
                *sum += factor * error;
            }
        });
        let Tolerance { relative, absolute } = self.tolerance;
        let all = all.into_iter().enumerate();
        all.filter(|(_, sums)| sums.count > 0.0).map(move |(quantity, sums)| {
            let mean = |sum: f64| (sum / sums.count).sqrt();
            let own = relative * mean(sums.y0).max(mean(sums.y1));
            let (fixed, rate) = match quantity {
                1 => (absolute, 0.0),
                2 | 4 => (own, FLOOR_SHARE * absolute),
                PLAIN => (1.0, 0.0),
                _ => (own + FLOOR_SHARE * absolute, 0.0),
            };
            (sums.errors.map(mean), Tolerated { fixed, rate })
        })
    }
}

/// Number of numbers up to which a small scratch serves, which takes less time to clear.
const FEW: usize = 64;

/// Allowed errors of plain numbers.
pub(super) struct Allowed<'a> {
    tolerance: Tolerance,
    sizes: &'a [f64],
    scales: &'a [f64],
    /// Whether numbers without a size are left out.
    leaves_out: bool,
}

impl Allowed<'_> {
    /// Returns the sum of the squares of errors, each over its allowed one, in a step from y0 to
    /// y1. Overwrites the errors.
    #[inline(always)]
    fn sum(&self, numbers: Range<usize>, [y0, y1]: [&[f64]; 2], errors: &mut [f64]) -> f64 {
        let Tolerance { relative, absolute } = self.tolerance;
        let ends = y0.iter().zip(y1);
        for ((k, error), (y0, y1)) in numbers.zip(&mut *errors).zip(ends) {
            let before = self.sizes.get(k).copied();
            let size = before.unwrap_or_default().max(y0.abs().max(y1.abs()));
            let allowed = match self.scales.get(k) {
                Some(scale) => relative * size.max(*scale),
                None => relative * size + absolute,
            };
            *error = *error * *error / (allowed * allowed);
            if self.leaves_out && before == Some(0.0) {
                *error = 0.0;
            }
        }
        total(errors)
    }
}

/// Returns the sum of the squares of errors in a step from y0 to y1, each over its allowed one if
/// it has one. `write` writes them to a scratch.
#[inline(always)]
pub(super) fn sum_of_squares(
    allowed: Option<&Allowed>,
    numbers: Range<usize>,
    ends: [&[f64]; 2],
    write: impl FnOnce(&mut [f64]),
) -> f64 {
    let length = numbers.len();
    let (mut few, mut many);
    let errors = if length <= FEW {
        few = [0.0; FEW];
        &mut few[..length]
    } else {
        many = [0.0; BLOCK];
        &mut many[..length]
    };
    write(errors);
    match allowed {
        Some(allowed) => allowed.sum(numbers, ends, errors),
        None => dot(errors, errors),
    }
}

/// Returns a function that sums squares over ranges of numbers of three states: of both ends of a
/// step, and of its errors.
fn squares(states: [&[f64]; 3]) -> impl FnMut(Range<usize>, Option<&Allowed>) -> [f64; 4] {
    let bands = threads(states[0].len() / 6);
    move |numbers, allowed| {
        let squares = Squares { states, allowed };
        add_up(bands, numbers, BLOCK, [], &squares)
    }
}

/// Sums of squares.
struct Squares<'a> {
    states: [&'a [f64]; 3],
    allowed: Option<&'a Allowed<'a>>,
}

impl OnBlock<0, 4> for Squares<'_> {
    #[inline(always)]
    fn run(&self, numbers: Range<usize>, []: Columns<0>) -> [f64; 4] {
        let [y0, y1, error] = self.states.map(|a| &a[numbers.clone()]);
        let errors = match self.allowed {
            None => dot(error, error),
            allowed => sum_of_squares(allowed, numbers, [y0, y1], |out| out.copy_from_slice(error)),
        };
        [dot(y0, y0), dot(y1, y1), errors, 0.0]
    }
}
