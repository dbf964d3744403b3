//! The limits of methods on a scene.

use a3_core::Method;
use a3_core::stability::{Limit, Mode, Motion, Observation, RestState};

/// Measurements of a scene.
pub struct Found {
    pub rows: Vec<MethodLimits>,
    pub motion: Motion,
    pub hanging: Option<RestState>,
    /// Modes at the start.
    pub at_start: Vec<Mode>,
}

/// The limits of a method.
#[derive(Clone, Copy)]
pub struct MethodLimits {
    pub method: &'static Method,
    /// The limit by the modes at rest, if the scene comes to rest.
    pub rest: Option<Limit>,
    /// The step at which a disturbance at rest was seen to grow tenfold.
    pub seen_at_rest: Option<Observation>,
    /// The limit of runs from the start.
    pub bounded: Option<Observation>,
    /// The largest step of an accurate run (s).
    pub accurate: Option<f64>,
    /// Whether runs were shorter or fewer than they should be, for the time that they take.
    pub is_short: bool,
}
