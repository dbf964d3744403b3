//! The limits of methods on a scene.

use a3_core::Method;
use a3_core::stability::{Limit, Mode, Observation, fastest};

/// Largest stable and largest accurate steps of methods on a scene.
#[derive(Clone, Debug)]
pub struct Stability {
    /// Limits of each method, in the order of the methods.
    pub limits: Vec<MethodLimits>,
    /// Time (s) until which errors mean something: accurate runs are compared with the true motion
    /// until then.
    pub predictable: f64,
    /// Modes at the start, fastest first.
    pub at_start: Vec<Mode>,
    /// Modes at rest, if the scene comes to rest.
    pub at_rest: Option<Vec<Mode>>,
    /// Natural frequency (rad/s) of the feedback that reduces errors of constraints, which is no
    /// motion; `None` without constraints.
    pub feedback: Option<f64>,
    /// Whether all was measured; false if the monitor stopped it.
    pub complete: bool,
    /// Name of the scene.
    pub(super) name: String,
    /// Description of the scene in titles.
    pub(super) title: String,
}

impl Stability {
    /// Returns the fastest motion of these modes.
    pub(super) fn fastest<'a>(&self, modes: &'a [Mode]) -> Option<&'a Mode> {
        fastest(modes, self.feedback)
    }
}

/// Limits of a method: of the fixed step, also for an adaptive one.
#[derive(Clone, Copy, Debug)]
pub struct MethodLimits {
    /// Method.
    pub method: &'static Method,
    /// Limit by the modes at rest, if the scene comes to rest.
    pub rest: Option<Limit>,
    /// Step at which a disturbance at rest grew tenfold in runs.
    pub seen_at_rest: Option<Observation>,
    /// Step up to which runs from the start stay bounded.
    pub bounded: Option<Observation>,
    /// Largest step of an accurate run (s).
    pub accurate: Option<f64>,
    /// Whether the work limit made runs shorter or fewer than usual.
    pub is_short: bool,
}
