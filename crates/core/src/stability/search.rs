//! Search for the largest step that holds, by bisection over runs.

use super::{HORIZON, STEPS};
use crate::error::Error;

/// Longest step that is tried where no limit is expected (s).
const LONGEST: f64 = 1.0;
/// Longest step that is tried where a limit is expected, as a multiple of that limit.
const BEYOND: f64 = 32.0;
/// Most work of a run, in steps times that of an evaluation: some seconds.
pub(super) const MOST: f64 = 2e8;
/// Number of checks during a run that holds.
const LOOKS: u64 = 200;

/// Nature of a limit that was observed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// Runs hold at all shorter steps, however long they are, and fail soon at longer ones.
    Sharp,
    /// Some longer runs fail at shorter steps too, or some runs hold at longer steps.
    Blurred,
    /// No run failed: the step is the longest that was tried.
    Open,
}

/// Largest step with which runs were seen to hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Largest step that held (s).
    pub step: f64,
    /// Nature of the limit.
    pub edge: Edge,
    /// Number of runs that the search took.
    pub runs: u32,
}

/// Number of steps of h (s) in a run: those that fill [`HORIZON`], and [`STEPS`] at least, or a
/// twentieth of these where no limit is expected.
pub(super) fn steps(h: f64, expected: f64) -> u64 {
    let least = if expected.is_finite() { 1.0 } else { 0.05 };
    (HORIZON / h).ceil().max(least * STEPS) as u64
}

/// Calls `look` with numbers of steps to take and to check, `steps` in all, and then 8 more, one by
/// one. Returns false as soon as `look` does.
pub(super) fn step_and_look(steps: u64, mut look: impl FnMut(u64) -> bool) -> bool {
    let mut left = steps;
    while left > 0 {
        let count = (steps / LOOKS).clamp(1, left);
        if !look(count) {
            return false;
        }
        left -= count;
    }
    (0..8).all(|_| look(1))
}

/// Largest step (s) for which `holds` returns true, by bisection of its logarithm from the expected
/// limit (s), infinity if there is none, to a relative precision. `None` if runs would take too
/// long; `work` is that of an evaluation.
///
/// With `near`, the step next to the limit is tried before the others: two runs are enough where
/// the limit is as expected, if steps shorter than one that holds hold too.
///
/// The limit is open or sharp: whoever calls this finds out whether it is blurred.
pub(super) fn bisect(
    expected: f64,
    work: f64,
    precision: f64,
    near: bool,
    holds: impl Fn(f64) -> Result<bool, Error>,
) -> Result<Option<Observation>, Error> {
    let mut runs = 0;
    let mut holds = |h: f64| {
        runs += 1;
        holds(h)
    };
    let shortest = (HORIZON * work / MOST).max(1e-6);
    let limited = expected.is_finite();
    let longest = if limited { BEYOND * expected } else { LONGEST };
    let guess = expected.min(longest);
    if guess < shortest {
        return Ok(None);
    }
    let (mut low, mut high);
    if holds(guess)? {
        (low, high) = (guess, (guess * 1.05).min(longest));
        if near && guess < longest && !holds(next(low, high, precision))? {
            high = low;
        }
        while low < high && holds(high)? {
            (low, high) = (high, (high * 1.4).min(longest));
        }
        if low == longest {
            let (step, edge) = (longest, Edge::Open);
            return Ok(Some(Observation { step, edge, runs }));
        }
    } else {
        (low, high) = (guess / 1.05, guess);
        let close = next(high, low, precision);
        if near && holds(close)? {
            low = close;
        } else {
            while !holds(low)? {
                (low, high) = (low / 1.4, low);
                if low < shortest {
                    return Ok(None);
                }
            }
        }
    }
    while high / low > 1.0 + precision {
        let middle = (low * high).sqrt();
        if holds(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    let (step, edge) = (low, Edge::Sharp);
    Ok(Some(Observation { step, edge, runs }))
}

/// Step next to one end of an interval that is bisected to a relative precision.
fn next(end: f64, other: f64, precision: f64) -> f64 {
    let mut step = other;
    while (step / end).max(end / step) > 1.0 + precision {
        step = (end * step).sqrt();
    }
    step
}
