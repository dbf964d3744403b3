//! Retries of steps: whether an adaptive method takes a step again, shorter, and by how much.

use super::depths::Depths;
use super::phases::Settled;
use crate::integrators::Adaptive;

/// Largest growth of the excess length of a spring in a step of an adaptive method, over the
/// longest length that a limit of strain allows it: a state between the ends of the step is shown
/// as it is.
const MAX_STRAIN_GROWTH: f64 = 1e-2;

/// Largest distance of a surface's vertex from the straight course on which the guard takes it,
/// over the least thickness, in a step of an adaptive method that sees forces at its end alone.
const MAX_BULGE: f64 = 0.25;

/// Least share of a step that is taken again because a spring became too long.
pub(super) const MIN_RETRY_SHARE: f64 = 0.1;

/// Length (s) below which a step is not shortened for contact or strain.
pub(super) const MIN_RETRY_STEP: f64 = 1e-6;

/// Length (s) below which a step of an adaptive method is not shortened for impulses of surfaces.
const MIN_IMPACT_STEP: f64 = 1e-4;

/// Share of a step of h (s) at which an adaptive method takes it again: to just after a particle
/// touched an obstacle, or a slide ended, or a spring became too long, or surfaces would have met.
/// A slide that went too far by less than the tolerance is left as it is.
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
    // Contact of surfaces is the force's: its error decides, once a step is so short that the
    // safeguard does nothing.
    let held = met.guarded.impulses > 0 && h > MIN_IMPACT_STEP;
    held.then_some((0.5 * met.guarded.first).max(MIN_RETRY_SHARE))
}

/// Share of a step of h (s) at which it is taken again because vertices of surfaces leave their
/// chords by that bulge, over the least thickness.
pub(super) fn share_of_bulge(bulge: f64, h: f64) -> Option<f64> {
    (bulge > MAX_BULGE && h > MIN_RETRY_STEP).then(|| 0.9 * (MAX_BULGE / bulge).sqrt())
}

/// Limits the next step of an adaptive method by the depth, the growth and the bulge of the last
/// one, of h (s): under a constant force all grow with the square of the step. Where depth and
/// growth do not, as where a limit of strain and an obstacle contradict each other, shorter steps
/// do not help: the limit is then at least the shortest step that is retried.
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
    if bulge > 0.0 {
        adaptive.try_at_most(h * 0.9 * (MAX_BULGE / bulge).sqrt());
    }
}
