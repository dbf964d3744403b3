//! Where springs and ropes become too long within a piece of a step.

use crate::contact::{Course, earliest};

/// Shortest interval in the search for a spring that is too long, as a share of the piece.
const MIN_INTERVAL: f64 = 1e-4;

/// Number of intervals of a piece at whose ends the lengths of ropes are looked at.
const INTERVALS: u32 = 8;

/// Number of bisections of such an interval.
const BISECTIONS: u32 = 45;

/// Finds the share of a piece at which a vector is first longer than `longest` (m).
pub(super) fn first_longer(apart: &Course, longest: f64) -> Option<f64> {
    let [speed, _] = apart.bounds();
    earliest([0.0, 1.0], MIN_INTERVAL, |[a, b]| {
        let middle = apart.position(0.5 * (a + b));
        middle.norm() + speed * 0.5 * (b - a) >= longest
    })
}

/// Finds the share of a piece at which a vector becomes longer than `longest` (m), unless that
/// lasts for less than one of the intervals of the piece. A rope that has just rebounded begins at
/// its length.
pub(super) fn first_beyond(apart: &Course, longest: f64) -> Option<f64> {
    let is_longer = |share: f64| apart.position(share).norm() > longest;
    let end = |k: u32| f64::from(k) / f64::from(INTERVALS);
    let k = (1..=INTERVALS).find(|k| is_longer(end(*k)))?;
    let (mut low, mut high) = (end(k - 1), end(k));
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        *(if is_longer(middle) {
            &mut high
        } else {
            &mut low
        }) = middle;
    }
    Some(high)
}
