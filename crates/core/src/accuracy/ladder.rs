//! Steps or tolerances at which a method is measured, from the coarsest that makes sense.

use super::frames::Frames;
use crate::control::Control;
use crate::error::Error;
use crate::integrators::Method;
use crate::stability::{Mode, largest_step};

/// Ratio of a step to the next shorter one, as far as whole numbers of steps allow.
pub(super) const RUNG_RATIO: f64 = 1.5;
/// Longest step over the method's stability limit: one or two steps beyond the limit show where it
/// is.
const MAX_LIMIT_RATIO: f64 = 1.4;
/// Least number of steps of a run.
pub(super) const MIN_STEPS: u64 = 4;
/// Least multiple of the smallest whole number of steps of 1/n s to which numbers of steps are
/// rounded.
const MIN_ROUNDED_UNITS: f64 = 3.0;
/// Exponents of the largest and the smallest tolerance of adaptive methods, in half powers of ten:
/// from 10^-1 to 10^-12, or to 10^-8 for implicit methods, whose orders are low.
const TOLERANCES: (i32, [i32; 2]) = (-2, [-24, -16]);

/// Lists steps that divide the time of all frames, from just beyond the method's stability limit on
/// the scene's `modes` down, or, for an adaptive method, tolerances from 0.1 down.
///
/// The coarsest comes first. The list of steps ends where a run would take more than `most` steps.
///
/// # Errors
/// Never fails for a method in [`METHODS`](crate::integrators::METHODS).
pub fn ladder(
    modes: &[Mode],
    method: &'static Method,
    frames: &Frames,
    most: u64,
) -> Result<Vec<Control>, Error> {
    if method.is_adaptive() {
        let least = TOLERANCES.1[usize::from(method.is_implicit())];
        return Ok((least..=TOLERANCES.0)
            .rev()
            .map(|half| {
                let digits = if half % 2 == 0 { 1.0 } else { 3.0 };
                let power = (f64::from(half) / 2.0).floor() as i32;
                Control::Tolerance(digits / 10f64.powi(-power))
            })
            .collect());
    }
    // Where every step is unstable, any is as good as another.
    let limit = largest_step(method, modes)?.filter(|limit| limit.step > 0.0);
    let limit = limit.map_or(f64::INFINITY, |limit| limit.step);
    let until = frames.until;
    let mut count = round(
        (until / (MAX_LIMIT_RATIO * limit))
            .ceil()
            .max(MIN_STEPS as f64),
        until,
    );
    let mut steps = vec![];
    while count <= most {
        steps.push(Control::Step(until / count as f64));
        count = round((count as f64 * RUNG_RATIO).floor(), until).max(count + 1);
    }
    Ok(steps)
}

/// Returns a number of steps near `count` with which steps are 1/n s long, in a time (s) with few
/// decimals; `count` itself if it is too small to be rounded.
fn round(count: f64, until: f64) -> u64 {
    let is_whole = |steps: &f64| *steps > 0.5 && (steps - steps.round()).abs() < 1e-9;
    let unit = (1..=20).map(|n| f64::from(n) * until).find(is_whole);
    match unit.map(f64::round) {
        Some(unit) if count >= MIN_ROUNDED_UNITS * unit => ((count / unit).round() * unit) as u64,
        _ => count as u64,
    }
}

/// Returns the next longer step of a ladder; `None` beyond the longest, and for tolerances.
#[must_use]
pub fn coarser(control: Control, frames: &Frames) -> Option<Control> {
    let count = (frames.until / control.step()?).round();
    let fewer = round(
        (count / RUNG_RATIO).floor().max(MIN_STEPS as f64),
        frames.until,
    );
    ((fewer as f64) < count).then(|| Control::Step(frames.until / fewer as f64))
}
