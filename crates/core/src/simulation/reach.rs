//! Reach of a step: how far it may go, and how far it went.

use crate::scene::{Model, StepLimits};

/// Part of a run that a step takes it on by: a length and the time at its end (s).
#[derive(Clone, Copy)]
pub(super) struct Part {
    pub h: f64,
    pub end: f64,
    /// Whether it ends at an event, after which the motion is no longer smooth.
    pub is_cut: bool,
}

impl Part {
    /// Part of h (s) from time t (s), which ends at an event.
    pub fn of(t: f64, h: f64) -> Self {
        Self {
            h,
            end: t + h,
            is_cut: true,
        }
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
        Self {
            longest: f64::INFINITY,
            until: None,
        }
    }
}

impl Reach {
    /// Limits of a step of a model from time t (s) that locates events: what prescribed motions do
    /// is known. One of an adaptive method is limited by these too, and a fixed one ends at
    /// `target` (s) at the latest.
    pub fn of_step(
        model: &Model,
        limits: StepLimits,
        is_adaptive: bool,
        t: f64,
        target: Option<f64>,
    ) -> Self {
        let mut reach = Self::default();
        if let Some(network) = model.network() {
            let until = network.next_known_time(t);
            if until.is_finite() {
                reach = Self::up_to(t, until);
            }
            if is_adaptive {
                let longest = network.quarter_period(t, t + reach.longest.min(f64::MAX));
                reach.limit(longest);
            }
        }
        if is_adaptive {
            reach.limit(limits.max_step.unwrap_or(f64::INFINITY));
        }
        if let Some(target) = target.filter(|target| *target <= reach.until.unwrap_or(f64::MAX)) {
            reach = Self {
                longest: target - t,
                until: Some(target),
            };
        }
        reach
    }

    /// Limits of a step from t up to a time `until` (s) at which a motion changes: no evaluation is
    /// at or after that.
    fn up_to(t: f64, until: f64) -> Self {
        // The last digits of a short step are lost in the time.
        let (mut longest, digit) = (until - t, 0.25 * (until - until.next_down()));
        while t + longest >= until && longest > 0.0 {
            longest = longest.next_down().min(longest - digit);
        }
        Self {
            longest,
            until: Some(until),
        }
    }

    /// Limits the length (s). A step of a shorter one does not end at the time.
    fn limit(&mut self, longest: f64) {
        if longest < self.longest {
            *self = Self {
                longest,
                until: None,
            };
        }
    }

    /// The step from t that takes h (s).
    pub fn part(&self, t: f64, h: f64) -> Part {
        let until = self.until.filter(|_| h == self.longest);
        Part {
            h,
            end: until.unwrap_or(t + h),
            is_cut: until.is_some(),
        }
    }
}
