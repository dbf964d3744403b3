//! Largest steps by linear theory: at which no mode grows, and at which none grows tenfold.

use super::growth::Growth;
use super::mode::Mode;
use crate::error::Error;
use crate::integrators::Method;

/// Shortest time (s) in which, at the step that counts as the limit, no mode may grow more than
/// [`GROWTH`] times.
pub const HORIZON: f64 = 10.0;
/// Least number of steps in which no mode may grow more than [`GROWTH`] times at that step.
pub const STEPS: f64 = 1000.0;
/// Growth beyond which a step counts as unstable.
pub const GROWTH: f64 = 10.0;

/// Growth of a mode in a step, less 1, that may be rounding.
const ROUNDING: f64 = 1e-12;
/// Largest growth, less 1, just above the first growing step, at which growth counts as beginning
/// smoothly.
const MAX_SMOOTH_GROWTH: f64 = 1e-6;
/// Least ratio of both steps of a limit that counts as sharp.
const MIN_SHARP_RATIO: f64 = 0.98;

/// Largest steps of a method by the modes of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Largest step (s) up to which no mode grows at all: 0 if a mode grows at every step, infinite
    /// if none grows at any.
    pub bounded: f64,
    /// Step (s) at which a mode grows [`GROWTH`] times in the time of [`tenfold_time`]; infinite
    /// where none does. Modes grow more slowly between `bounded` and this step.
    pub step: f64,
    /// Index of the mode that sets `step`.
    pub mode: usize,
}

impl Limit {
    /// Returns whether modes grow fast as soon as they grow at all: both steps are nearly the same.
    #[must_use]
    pub fn is_sharp(&self) -> bool {
        self.step.is_infinite() || self.bounded > MIN_SHARP_RATIO * self.step
    }
}

/// Returns the time (s) in which no mode may grow more than [`GROWTH`] times in steps of h (s): the
/// longer of [`HORIZON`] and [`STEPS`] steps.
#[must_use]
pub fn tenfold_time(h: f64) -> f64 {
    HORIZON.max(STEPS * h)
}

/// Finds the largest steps of a method with which no mode grows, and with which none grows tenfold;
/// all shorter steps are as good. Modes that have no restoring force, or grow by themselves, are
/// left out: they fall, buckle or flutter with any method. `None` if no mode is left.
///
/// # Errors
/// The method does not support a mechanical system with drag and damping as in these modes.
pub fn largest_step(method: &Method, modes: &[Mode]) -> Result<Option<Limit>, Error> {
    let mut limit: Option<Limit> = None;
    for (k, mode) in modes.iter().enumerate().filter(|(_, m)| m.returns()) {
        let mut growth = Growth::new(method, *mode)?;
        // Rate of the fastest motion, by stiffness or by damping.
        let rate = mode.frequency().max(mode.drag + mode.damping);
        let so_far = limit.unwrap_or(Limit {
            bounded: f64::INFINITY,
            step: f64::INFINITY,
            mode: k,
        });
        // The search is fine for the first mode. Other modes rarely lower the limit.
        let ratio = if limit.is_none() { 1.05 } else { 1.25 };
        let tenfold = |h: f64| growth.of_step(h).ln() * tenfold_time(h) > h * GROWTH.ln();
        let longest = so_far.step.min(1e4 / rate);
        let found = first(tenfold, 1e-3 / rate, longest, ratio);
        let (step, mode) = found.map_or((so_far.step, so_far.mode), |step| (step, k));
        let bounded = if step.is_finite() {
            let longest = so_far.bounded.min(step);
            beginning(&mut growth, rate, longest, ratio).map_or(longest, |bounded| {
                // Growth at very short steps only is rounding of the damping.
                if bounded < 1e-4 * step { 0.0 } else { bounded }
            })
        } else {
            f64::INFINITY
        };
        growth.check()?;
        limit = Some(Limit {
            bounded,
            step,
            mode,
        });
    }
    Ok(limit)
}

/// Finds the largest h below which `fails` is false, from trials at `h`, at steps that grow by
/// `ratio` up to `longest`, and at `longest`; `None` if none fails.
fn first(mut fails: impl FnMut(f64) -> bool, mut h: f64, longest: f64, ratio: f64) -> Option<f64> {
    let mut below = 0.0;
    while h < longest && !fails(h) {
        below = h;
        h *= ratio;
    }
    let above = h.min(longest);
    (h < longest || fails(longest)).then(|| between(fails, [below, above]))
}

/// Finds the largest h at which `fails` is false, between a step at which it is and one at which it
/// is not.
fn between(mut fails: impl FnMut(f64) -> bool, [mut low, mut high]: [f64; 2]) -> f64 {
    for _ in 0..50 {
        let middle = f64::midpoint(low, high);
        if fails(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
}

/// Finds the step (s) from which on a mode of this rate (1/s) grows: 0 if it grows at every step,
/// `None` if it does not grow up to `longest` (s).
///
/// Growth of an undamped mode by a method of high order begins so smoothly that rounding hides it
/// at short steps. Such a mode grows at every step, unless it decays at a shorter one.
fn beginning(growth: &mut Growth, rate: f64, longest: f64, ratio: f64) -> Option<f64> {
    let mut start = 1e-3 / rate;
    // Lightly damped modes decay at very short steps only.
    while start > 1e-8 / rate && growth.of_step(start) > 1.0 + ROUNDING {
        start *= 0.1;
    }
    let mut decays = false;
    let grows = |h: f64| {
        let excess = growth.of_step(h) - 1.0;
        decays |= excess < -ROUNDING;
        excess > ROUNDING
    };
    let begins = first(grows, start, longest, ratio)?;
    let hidden = !decays && growth.of_step(begins * 1.05) - 1.0 < MAX_SMOOTH_GROWTH;
    Some(if hidden { 0.0 } else { begins })
}
