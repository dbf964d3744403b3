//! Reach of a step: how far it may go, how far it has gone, and whether an adaptive method takes
//! it again, and how much shorter.

use super::depths::Depths;
use super::phases::Settled;
use crate::integrators::Adaptive;
use crate::network::{Network, jump_near, next_break, next_known_time, quarter_period};
use crate::scene::{Model, StepLimits};

/// Share of a step by which its end may miss a requested time: 1/60 s written as 0.01666667 is
/// accurate enough for sixty frames a second.
pub(super) const STEP_END_TOLERANCE: f64 = 1e-6;

/// Part of a run that one step covers: its length (s), and the time at its end (s).
#[derive(Clone, Copy)]
pub(super) struct StepPart {
    pub h: f64,
    pub end: f64,
    /// Whether it ends at an event, after which the motion is no longer smooth.
    pub ends_at_event: bool,
}

impl StepPart {
    /// Creates a part of h (s) from time t (s), which ends at an event.
    pub fn of(t: f64, h: f64) -> Self {
        Self { h, end: t + h, ends_at_event: true }
    }
}

/// Returns the first time after t (s) at which a fixed step ends early: where a pin lets go or,
/// after more than `none` (s), jumps, or f does.
pub(super) fn next_change(model: &Model, t: f64, none: f64) -> f64 {
    match model.network() {
        Some(network) => next_break(network, t, none),
        None => model.system().next_jump(t + none),
    }
}

/// Returns the time (s) from which a step is taken that begins at t (s): after a jump of f that it
/// is before by at most `none` (s), a rounding error.
pub(super) fn begin_of(model: &Model, t: f64, none: f64) -> f64 {
    match model.network() {
        Some(_) => t,
        None => Some(model.system().next_jump(t)).filter(|jump| *jump <= t + none).unwrap_or(t),
    }
}

/// Limits of a step: its longest length, and the time (s) at which one of that length ends.
#[derive(Clone, Copy)]
pub(super) struct Reach {
    pub longest: f64,
    until: Option<f64>,
}

impl Default for Reach {
    fn default() -> Self {
        Self { longest: f64::INFINITY, until: None }
    }
}

impl Reach {
    /// Returns the limits of a step of a model from time t (s) by a method that locates events.
    /// Prescribed motions begin and end at known times. An adaptive step has further limits; a
    /// fixed step ends at `target` (s), or earlier by more than `none` (s).
    pub fn of_step(
        model: &Model,
        limits: StepLimits,
        is_adaptive: bool,
        t: f64,
        (target, none): (Option<f64>, f64),
    ) -> Self {
        let network = model.network();
        let until = match network {
            Some(network) => next_known_time(network, t),
            None => model.system().next_jump(t),
        };
        let mut reach = Self::up_to(t, until);
        if let Some(network) = network.filter(|_| is_adaptive) {
            let longest = quarter_period(network, t, t + reach.longest.min(f64::MAX));
            reach.limit(longest);
        }
        if is_adaptive {
            reach.limit(limits.max_step.unwrap_or(f64::INFINITY));
        }
        reach.or_before_in(model, t, (target, none))
    }

    /// Returns the same limits if they end where the velocity of a pin jumps that constraints hold,
    /// or within `none` (s) of it, but with all evaluations before that.
    pub fn before_jump(self, network: &Network, t: f64, none: f64) -> Self {
        let jump = self.until.and_then(|end| Some((end, jump_near(network, end, none)?)));
        match jump {
            Some((end, jump)) => Self { until: Some(end), ..Self::up_to(t, jump.min(end)) },
            None => self,
        }
    }

    /// Returns the limits of a part of a fixed step of a model from time t (s) by a method that
    /// locates no events. The part ends where the next pin lets go or, after more than `none` (s),
    /// jumps, where f jumps, or at `target` (s).
    pub fn of_part(model: &Model, t: f64, none: f64, target: Option<f64>) -> Self {
        let reach = Self::up_to(t, next_change(model, t, none));
        reach.or_before_in(model, t, (target, none))
    }

    /// Returns what [`or_before`](Self::or_before) does. Where f of a model without pins jumps at
    /// `target` itself, all evaluations are before that.
    fn or_before_in(self, model: &Model, t: f64, (target, none): (Option<f64>, f64)) -> Self {
        if model.network().is_none() && self.until.is_some() && self.until == target {
            return self;
        }
        self.or_before(t, target, none)
    }

    /// Returns these limits, or those of a step that ends at `target` (s), if that is not later, or
    /// later by at most `none` (s): no part of a step is as short as a rounding error.
    pub fn or_before(self, t: f64, target: Option<f64>, none: f64) -> Self {
        let (Some(target), until) = (target, self.until.unwrap_or(f64::MAX)) else {
            return self;
        };
        if target <= until {
            return Self { longest: target - t, until: Some(target) };
        }
        let until = if target <= until + none { target } else { until };
        Self { until: Some(until), ..self }
    }

    /// Returns the limits of a step from t up to a time `until` (s) at which a motion changes. All
    /// evaluations are before that time. There is no limit if it is infinite.
    pub fn up_to(t: f64, until: f64) -> Self {
        if until.is_infinite() {
            return Self::default();
        }
        // Adding a short step to the time rounds it.
        let (mut longest, digit) = (until - t, 0.25 * (until - until.next_down()));
        while t + longest >= until && longest > 0.0 {
            longest = longest.next_down().min(longest - digit);
        }
        Self { longest, until: Some(until) }
    }

    /// Limits the length (s). A shorter step does not end at the known time.
    fn limit(&mut self, longest: f64) {
        if longest < self.longest {
            *self = Self { longest, until: None };
        }
    }

    /// Returns the part that a step of h (s) from t covers.
    pub fn part(&self, t: f64, h: f64) -> StepPart {
        let until = self.until.filter(|_| h == self.longest);
        StepPart { h, end: until.unwrap_or(t + h), ends_at_event: until.is_some() }
    }
}

/// Largest growth of a spring's excess length in a step of an adaptive method, over the greatest
/// length that the limit of strain allows: states between the ends of the step are shown as they
/// are.
const MAX_STRAIN_GROWTH: f64 = 1e-2;

/// Largest distance of a vertex from the chord along which the collision safeguard moves it, over
/// the least thickness, in a step of an adaptive method: of a rigid body or, where forces are
/// evaluated at the end of the step alone, of any surface.
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
/// contact on an obstacle that is curved or turns was too inaccurate, or surfaces would have met. A
/// slide that went too far by less than the tolerance is accepted.
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
    if met.missed > depths.shallow {
        return Some(share_of_missed(met.missed, depths).max(MIN_RETRY_SHARE));
    }
    // Contact of surfaces is the task of the repulsion force: its error controls the step, once the
    // step is so short that the safeguard does nothing.
    let held = met.guarded.impulses > 0 && h > MIN_IMPULSE_STEP;
    held.then_some((0.5 * met.guarded.first).max(MIN_RETRY_SHARE))
}

/// Returns the share of a step with which the error of contact on obstacles that are curved or
/// turn, which is proportional to its cube, is within the tolerance.
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
    if met.missed > 0.0 {
        let share = share_of_missed(met.missed, depths);
        adaptive.try_at_most((h * share).max(MIN_RETRY_STEP));
    }
    if bulge > 0.0 {
        adaptive.try_at_most(h * 0.9 * (MAX_BULGE / bulge).sqrt());
    }
}
