//! Tolerances, and the norm in which the error of a step is measured against them.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::ops::Range;

use crate::error::{Error, positive};
use crate::measure::Measure;
use crate::sums::{OnBlock, add_up, dot};
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
struct Sums {
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
    /// numbers: of y0, of y1 and of both errors.
    pub fn of_sums(&self, sums: impl FnMut(Range<usize>) -> [f64; 4]) -> [f64; 2] {
        let mut largest = [0.0; 2];
        for (errors, Tolerated { fixed, rate }) in self.quantities(sums) {
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
        let mut all = squares([y, y, derivative]);
        // A plain number that vanishes has no size yet in which a change could be seen.
        let sums = |numbers: Range<usize>| match self.sizes.get(numbers.start) {
            Some(0.0) => [0.0; 4],
            _ => all(numbers),
        };
        let times = self.quantities(sums).map(|([change, _], tolerated)| {
            if change == 0.0 {
                return f64::INFINITY;
            }
            let [fixed, rate] = [tolerated.fixed, tolerated.rate]
                .map(|tolerated| tolerated / (self.tolerance.relative * change));
            root(fixed, order).max(root(rate, order + 1))
        });
        times.fold(f64::INFINITY, |least, time| {
            // NaN is returned as such.
            if time < least || time.is_nan() {
                time
            } else {
                least
            }
        })
    }

    /// Returns the errors of the quantities in the state, and the allowed ones.
    fn quantities(
        &self,
        mut sums: impl FnMut(Range<usize>) -> [f64; 4],
    ) -> impl Iterator<Item = ([f64; 2], Tolerated)> {
        let mut all = [Sums::default(); QUANTITIES];
        self.system.measures(&mut |numbers, measure| {
            if measure == Measure::Plain {
                return self.add_plain(numbers, &mut sums, &mut all[PLAIN]);
            }
            let length = numbers.len() as f64;
            let [mut y0, mut y1, errors @ ..] = sums(numbers);
            let (quantity, count, factor) = match measure {
                Measure::Plain | Measure::Alike => (0, length, 1.0),
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
        all.filter(|(_, sums)| sums.count > 0.0)
            .map(move |(quantity, sums)| {
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

impl ErrorNorm<'_> {
    /// Adds the squares of the errors of plain numbers, each over its allowed error.
    fn add_plain(
        &self,
        numbers: Range<usize>,
        sums: &mut impl FnMut(Range<usize>) -> [f64; 4],
        all: &mut Sums,
    ) {
        let (Tolerance { relative, absolute }, scales) = (self.tolerance, self.system.scales());
        for k in numbers {
            let [y0, y1, errors @ ..] = sums(k..k + 1);
            let before = self.sizes.get(k).copied().unwrap_or_default();
            let size = before.max(y0.max(y1).sqrt());
            let allowed = match scales.get(k) {
                Some(scale) => relative * size.max(*scale),
                None => relative * size + absolute,
            };
            all.count += 1.0;
            for (sum, error) in all.errors.iter_mut().zip(errors) {
                *sum += error / (allowed * allowed);
            }
        }
    }
}

/// Returns a function that sums squares over ranges of numbers of three states.
fn squares(states: [&[f64]; 3]) -> impl FnMut(Range<usize>) -> [f64; 4] {
    let bands = threads(states[0].len() / 6);
    move |numbers| match numbers.len() {
        1 => {
            let [y0, y1, error] = states.map(|a| a[numbers.start] * a[numbers.start]);
            [y0, y1, error, 0.0]
        }
        _ => add_up(bands, numbers, BLOCK, [], &Squares(states)),
    }
}

/// Sums of squares.
struct Squares<'a>([&'a [f64]; 3]);

impl OnBlock<0, 4> for Squares<'_> {
    #[inline(always)]
    fn run(&self, numbers: Range<usize>, []: Columns<0>) -> [f64; 4] {
        let [y0, y1, error] = self.0.map(|a| {
            let own = &a[numbers.clone()];
            dot(own, own)
        });
        [y0, y1, error, 0.0]
    }
}
