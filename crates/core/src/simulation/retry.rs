//! Retries of steps: whether an adaptive method takes a step again, and how much shorter.

use super::depths::Depths;
use super::phases::Settled;
use crate::integrators::Adaptive;

/// Largest growth of a spring's excess length in a step of an adaptive method, over the greatest
/// length that the limit of strain allows: states between the ends of the step are shown as they
/// are.
const MAX_STRAIN_GROWTH: f64 = 1e-2;

/// Largest distance of a vertex from the chord along which the collision safeguard moves it, over
/// the least thickness, in a step of an adaptive method whose forces are evaluated at its end
/// alone.
const MAX_BULGE: f64 = 0.25;

/// Least share of a step with which it is taken again, except up to just after a touch.
pub(super) const MIN_RETRY_SHARE: f64 = 0.1;

/// Length (s) below which a step is not shortened for contact or strain.
pub(super) const MIN_RETRY_STEP: f64 = 1e-6;

/// Length (s) below which a step of an adaptive method is not shortened because of safeguard
/// impulses.
const MIN_IMPULSE_STEP: f64 = 1e-4;

/// Returns the share of a step of h (s) with which an adaptive method takes it again, if it has to:
/// up to just after a particle touched an obstacle, a slide ended, a spring became too long,
/// friction on a turning obstacle was too inaccurate, or surfaces would have met. A slide that went
/// too far by less than the tolerance is accepted.
pub(super) fn share_of_retry(settled: &Settled, h: f64, depths: Depths) -> Option<f64> {
    let Settled { met, grown, .. } = settled;
    if h <= MIN_RETRY_STEP {
        return None;
    }
    if met.depth > depths.deepest {
        return Some(met.touched + (1.0 - met.touched) * 0.5 * depths.deepest / met.depth);
    }
    if met.stop.way > depths.shallow {
        return Some(met.stop.share.max(MIN_RETRY_SHARE));
    }
    if *grown > MAX_STRAIN_GROWTH {
        return Some((0.5 * MAX_STRAIN_GROWTH / grown).max(MIN_RETRY_SHARE));
    }
    if met.guarded.missed > depths.shallow {
        return Some(share_of_missed(met.guarded.missed, depths).max(MIN_RETRY_SHARE));
    }
    // Contact of surfaces is the task of the repulsion force: its error controls the step, once the
    // step is so short that the safeguard does nothing.
    let held = met.guarded.impulses > 0 && h > MIN_IMPULSE_STEP;
    held.then_some((0.5 * met.guarded.first).max(MIN_RETRY_SHARE))
}

/// Returns the share of a step with which the error of friction on turning obstacles, which is
/// proportional to its cube, is within the tolerance.
fn share_of_missed(missed: f64, depths: Depths) -> f64 {
    0.9 * libm::cbrt(depths.shallow / missed)
}

/// Returns the share of a step of h (s) with which it is taken again because vertices of surfaces
/// leave their chords by `bulge` thicknesses.
pub(super) fn share_of_bulge(bulge: f64, h: f64) -> Option<f64> {
    (bulge > MAX_BULGE && h > MIN_RETRY_STEP).then(|| 0.9 * (MAX_BULGE / bulge).sqrt())
}

/// Limits the next step of an adaptive method by the depth, the strain growth and the bulge of the
/// last one, of h (s): under a constant force all are proportional to the square of the step. Where
/// depth and growth are not, for instance where a limit of strain and an obstacle contradict each
/// other, shorter steps do not help; therefore the limit is at least the shortest step that is
/// retried.
pub(super) fn limit_next(
    adaptive: &mut Adaptive,
    settled: &Settled,
    bulge: f64,
    h: f64,
    depths: Depths,
) {
    let Settled { met, grown, .. } = settled;
    let mut limit = |allowed: f64| {
        let next = h * 0.9 * allowed.sqrt();
        let least = if next < h { MIN_RETRY_STEP } else { 0.0 };
        adaptive.try_at_most(next.max(least));
    };
    if met.depth > 0.0 {
        limit(depths.deepest / met.depth);
    }
    if *grown > 0.0 {
        limit(MAX_STRAIN_GROWTH / grown);
    }
    if met.guarded.missed > 0.0 {
        let share = share_of_missed(met.guarded.missed, depths);
        adaptive.try_at_most((h * share).max(MIN_RETRY_STEP));
    }
    if bulge > 0.0 {
        adaptive.try_at_most(h * 0.9 * (MAX_BULGE / bulge).sqrt());
    }
}
