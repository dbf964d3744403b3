//! Frames: times at which runs are compared.

use crate::scene::Model;
use crate::simulation::Simulation;

/// Number of frames of a system of one's own, whose time may have any unit.
const OWN: u64 = 240;

/// Function that is called between frames and returns whether to continue.
pub type GoOn<'a> = &'a dyn Fn() -> bool;

/// Times at which runs are compared: the ends of `count` equal parts of the time from 0 to `until`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frames {
    /// Time of the last frame (s).
    pub until: f64,
    /// Number of frames.
    pub count: u64,
}

impl Frames {
    /// Creates frames up to `until` (s): at least 60 in each second, and at least 60 in all.
    #[must_use]
    pub fn new(until: f64) -> Self {
        Self { until, count: 60 * until.ceil().max(1.0) as u64 }
    }

    /// Creates frames for runs of a model up to `until` (s): those of [`new`](Self::new) for a
    /// network, and 240 for a system of one's own, whose time may have any unit.
    #[must_use]
    pub fn of(model: &Model, until: f64) -> Self {
        match model.network() {
            Some(_) => Self::new(until),
            None => Self { until, count: OWN },
        }
    }

    /// Returns the interval between frames (s).
    #[must_use]
    pub fn spacing(&self) -> f64 {
        self.until / self.count as f64
    }

    /// Returns the time of frame k (s).
    #[must_use]
    pub fn time(&self, k: u64) -> f64 {
        if k == self.count { self.until } else { k as f64 * self.spacing() }
    }

    /// Returns the number of steps of h (s) that reach the last frame; the last step may be
    /// shorter.
    #[must_use]
    pub fn steps(&self, h: f64) -> u64 {
        (self.until / h - Simulation::STEP_END_TOLERANCE).ceil().max(1.0) as u64
    }
}
